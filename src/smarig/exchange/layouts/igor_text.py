"""Igor text (``.itx``) as the lines of a table: waves are columns, and commands that scale them state their units.

``WAVES/D  t  R`` names the columns of the numbers between BEGIN and END. A command ``X SetScale d 0,0,"ohm", R`` after
END states the unit of the values of a wave. Every line keeps its number in the file.
"""

import re
from collections.abc import Sequence

_FIRST_LINE = "IGOR"
_WAVES = re.compile(r"\s*WAVES(?:/[A-Z]+(?:=\([^)]*\)|=\S+)?)*\s+(.+)", re.IGNORECASE)
_WAVE = re.compile(r"'([^']+)'|([^\s,;']+)")
_OF_VALUES = re.compile(r'SetScale\s*d\s+[^,"]*,[^,"]*,\s*"([^"]*)"\s*,([^;"]*)', re.IGNORECASE)


def is_igor_text(lines: Sequence[str]) -> bool:
    """Whether these are the first lines of Igor text."""
    return bool(lines) and lines[0].strip() == _FIRST_LINE


def igor_rows(lines: Sequence[str]) -> list[str]:
    r"""The lines of Igor text as names, units and numbers; commands and marks are blank lines.

    >>> text = ["IGOR", "WAVES/D\tT\tR", "BEGIN", "\t1\t2", "END", 'X SetScale d 0,0,"ohm", R']
    >>> igor_rows(text)
    ['', 'T\tR', '[]\t[ohm]', '1\t2', '', '']
    """
    units = _units(lines)
    rows, names, inside = [""] * len(lines), list[str](), False
    for k, line in enumerate(lines):
        word = line.strip().upper()
        if inside and word != "END":
            rows[k] = line.strip()
        elif match := _WAVES.fullmatch(line):
            names = _names(match[1])
            rows[k] = "\t".join(names)
        elif word == "BEGIN":
            rows[k] = "\t".join(f"[{units.get(name, '')}]" for name in names)
        inside = word == "BEGIN" or (inside and word != "END")
    return rows


def _units(lines: Sequence[str]) -> dict[str, str]:
    """The units of the values of waves by name."""
    commands = [line for line in lines if line.lstrip().upper().startswith("X ")]
    stated = [match for line in commands for match in _OF_VALUES.finditer(line)]
    return {name: match[1].strip() for match in stated for name in _names(match[2])}


def _names(text: str) -> list[str]:
    """The names of waves in a list; one with other signs than letters is in quotes."""
    return [match[1] or match[2] for match in _WAVE.finditer(text)]
