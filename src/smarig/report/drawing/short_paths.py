"""Writes the paths and marks of a drawing shorter: relative coordinates, and the style of equal marks once."""

import re

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
