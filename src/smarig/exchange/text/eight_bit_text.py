"""Text of one byte or two a sign, which states no encoding: Latin-1, that of Windows, or Shift-JIS.

Latin-1 has control signs from 0x80 to 0x9F, which occur in no text. Where such bytes stand, the text is Shift-JIS if
they begin its letters (two bytes above 0x7F) and every byte fits, else that of Windows, in which they are quotation
marks and dashes beside blanks and ASCII letters.
"""

import re

_CONTROL = re.compile(r"[\x80-\x9f]")
_TWO_HIGH = re.compile(rb"[\x81-\x9f][\x80-\xfc]")
_LETTERS = re.compile(r"[\u0370-\u03ff\u3040-\u30ff\u4e00-\u9fff]")  # Greek, kana, kanji


def eight_bit_text(data: bytes) -> tuple[str, str]:
    """The text of bytes that are no UTF-8, and the name of its encoding.

    >>> eight_bit_text(b"T,\\x83\\xcam"), eight_bit_text(b"T,\\xb5m"), eight_bit_text(b"5 \\x96 6 \\xb5m")
    (('T,μm', 'Shift-JIS'), ('T,µm', 'Latin-1'), ('5 – 6 µm', 'Windows-1252'))
    """
    latin = data.decode("latin-1")
    if not _CONTROL.search(latin):
        return latin, "Latin-1"
    windows, japanese = _decoded(data, "cp1252"), _decoded(data, "cp932")
    if japanese is not None and (windows is None or _has_letters(data)):
        return japanese, "Shift-JIS"
    return (latin, "Latin-1") if windows is None else (windows, "Windows-1252")


def _has_letters(data: bytes) -> bool:
    """Whether two bytes above ASCII are a letter of Shift-JIS."""
    return any(_LETTERS.match(_decoded(pair, "cp932") or "") for pair in set(_TWO_HIGH.findall(data)))


def _decoded(data: bytes, encoding: str) -> str | None:
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        return None
