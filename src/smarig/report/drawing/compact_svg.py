"""Shortens the SVG that Matplotlib writes to what a page needs: about a quarter of its length."""

import re

from smarig.report.drawing.short_paths import short_marks, short_paths

_TAG = re.compile(r"<[^>]+>")
_GROUP = re.compile(r"(<g>|<g [^>]*>|</g>)")
_ID, _REFERENCE = re.compile(r' id="([^"]*)"'), re.compile(r"#([\w.-]+)")
_IN_TAGS = (
    (re.compile(r"(\d+\.\d)\d+"), r"\1"),  # a tenth of a pixel is enough
    (re.compile(r"\.0(?=\D)"), ""),
    (re.compile(r"font: ([\d.]+)px [^;\"]*"), r"font-size:\1px"),  # the page has the font
    (re.compile(r"font-family: ?[^;\"]*;? ?"), ""),
    (re.compile(r' transform="rotate\(-?0 [^"]*"'), ""),
    (re.compile(r"\s+"), " "),
    (re.compile(r"(?<=[a-z]): "), ":"),
    (re.compile(r"; (?=[a-z])"), ";"),
    (re.compile(r"(?<=\d) (?=[LMQCz])"), ""),
)
_IMAGE = "data:image"


def compact_svg(text: str) -> str:
    """The ``svg`` element of a file: coordinates to a tenth of a pixel, without prologue, comments and unused ids.

    Texts and images stay as they are.
    """
    element = re.sub(r"<!--.*?-->", "", text[text.index("<svg") :], flags=re.DOTALL)
    element = re.sub(r"<metadata>.*?</metadata>", "", element, flags=re.DOTALL)
    used = set(_REFERENCE.findall(element))
    element = _ID.sub(lambda found: found[0] if found[1] in used else "", element)
    element = re.sub(r"/>\s+<", "/><", _TAG.sub(lambda found: _short(found[0]), element))
    element = short_marks(short_paths(_without_plain_groups(element)))
    return element.replace("<svg ", '<svg aria-hidden="true" ', 1)


def _short(tag: str) -> str:
    if _IMAGE in tag:
        return tag
    for pattern, instead in _IN_TAGS:
        tag = pattern.sub(instead, tag)
    return tag


def _without_plain_groups(text: str) -> str:
    """The text without groups that have no attributes."""
    kept, is_plain = [], []
    for piece in _GROUP.split(text):
        if piece.startswith("<g"):
            is_plain.append(piece == "<g>")
            piece = "" if is_plain[-1] else piece
        elif piece == "</g>" and is_plain.pop():
            piece = ""
        if piece.strip():
            kept.append(piece.strip())
    return "".join(kept)
