"""The markup of labels (HTML, as Plotly reads it) as the text of Matplotlib."""

import html
import re

from smarig.core import printable

_SUB, _SUP = re.compile(r"(\w*)<sub>(.*?)</sub>"), re.compile(r"(\w*)<sup>(.*?)</sup>")
_TAG = re.compile(r"</?[a-z]+>")


def plain_text(text: object) -> str:
    """The label with indices and powers as mathematical text, line breaks as such, and without other tags.

    Characters that no font has are shown by their numbers: Matplotlib would print them in a warning.

    >>> plain_text("A<sub>s</sub> (K)<br>heating"), plain_text("a &amp; b $")
    ('$\\\\mathregular{A_{s}}$ (K)\\nheating', 'a & b \\\\$')
    >>> plain_text("mm\\x1b[2J\\t")
    'mm\\\\x1b[2J '
    """
    words = printable(str(text)).replace("\t", " ").replace("$", r"\$").replace("<br>", "\n")
    words = _SUB.sub(r"$\\mathregular{\1_{\2}}$", words)
    words = _SUP.sub(r"$\\mathregular{\1^{\2}}$", words)
    return html.unescape(_TAG.sub("", words))
