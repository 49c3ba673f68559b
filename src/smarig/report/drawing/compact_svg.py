"""Shortens the SVG that Matplotlib writes to what a page needs: about a quarter of its length.

Paths get relative coordinates, and the style of equal marks is written once.
"""

import re

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


_PATH = re.compile(r' d="([^"]*)"')
_PART = re.compile(r"([A-Za-z])([^A-Za-z]*)")
_MARKS = re.compile(r'(?:<use [^>]* style="([^"]*)"/>)(?:<use [^>]* style="\1"/>)+')


def short_paths(svg: str) -> str:
    """The drawing with relative lines. Coordinates must be written to a tenth of a pixel; curves stay as they are."""
    return _PATH.sub(lambda found: f' d="{_relative(found[1])}"', svg)


def short_marks(svg: str) -> str:
    """The drawing with the style of marks that follow each other in a group around them."""
    return _MARKS.sub(_grouped, svg)


def _grouped(run: re.Match[str]) -> str:
    style = f' style="{run[1]}"'
    return f"<g{style}>{run[0].replace(style, '')}</g>"


def _relative(path: str) -> str:
    """The same path: ``M 1 2L 1.5 1`` becomes ``M1 2l.5-1``."""
    parts = _PART.findall(path)
    if any(command not in "MLz" for command, _ in parts) or not parts:
        return path
    written, last = "", ""
    x = y = 0
    start = (0, 0)
    for command, numbers in parts:
        if command == "z":
            written, last, (x, y) = written + "z", "", start
            continue
        to_x, to_y = (round(10 * float(number)) for number in numbers.split())
        letter = "" if command == "L" and last == "L" else "m" if command == "M" else "l"
        written += _joined(letter, to_x - x, to_y - y)
        x, y, last = to_x, to_y, command
        start = (x, y) if command == "M" else start
    return "M" + written[1:]


def _joined(letter: str, dx: int, dy: int) -> str:
    """A step of tenths; a sign separates as well as a space does."""
    first, second = _number(dx), _number(dy)
    before = "" if letter or first.startswith("-") else " "
    return f"{letter}{before}{first}{'' if second.startswith('-') else ' '}{second}"


def _number(tenths: int) -> str:
    """
    >>> [_number(t) for t in (0, 3, -3, 40, -125)]
    ['0', '.3', '-.3', '4', '-12.5']
    """
    whole, part = divmod(abs(tenths), 10)
    digits = (f"{whole}" if whole or not part else "") + (f".{part}" if part else "")
    return f"-{digits}" if tenths < 0 else digits
