"""Reads MicroMag-style text files of first-order reversal curves: header, curves, calibration points.

It reads series 0015 (``key = value``) and 0016 (``key value``). A truncated or contradictory file is read as it is,
with a finding.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, number_from_text, shown, spaced
from smarig.exchange.checks.value_bounds import check_size
from smarig.exchange.layouts.table_lines import check_lines
from smarig.exchange.tables.text_table import read_text
from smarig.exchange.units.unit_systems import UNIT_SYSTEMS
from smarig.exchange.units.units import spelled
from smarig.exchange.units.written_units import known_unit

_NUMBER = (
    r"[+-]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][+-]?\d++)?"  # nothing is tried in two ways: no line takes long
)
_BETWEEN = r"(?:\s*+[,;]\s*+|\s++)"
_DATA = re.compile(rf"\s*+({_NUMBER}){_BETWEEN}({_NUMBER})(?:{_BETWEEN}({_NUMBER}))*+\s*+", re.ASCII)
MAX_LINE = 10_000  # characters
_KEY = re.compile(r"\s*(\S.*?)\s*(?:[:=]\s+|[:=]$|\s{2,})(.*\S)?\s*")
_LISTED_UNITS = re.compile(
    r"[^()]*\(\s*([^,;()]+?)\s*[,;]\s*([^,;()]+?)\s*\)"
)  # of field and moment: SI (T, A m^2)
_COLUMN_UNITS = re.compile(r"\s*\(([^()]+)\)[\s,;]*\(([^()]+)\)[\s,;]*(?:\([^()]+\)[\s,;]*)*")
_DATE = re.compile(r"\s*\d+[/.-]\d+[/.-]\d+")
_LOOP = re.compile(r".*\bhysteresis loop\W*", re.IGNORECASE)
_NEAR = 0.05  # of HCal: distance within which a point is a calibration point


@dataclass(frozen=True)
class ForcFile:
    """Curves and calibration points in measured order.

    ``field`` and ``moment`` (n,) are in the file's units. ``curve`` (n,) counts curves from 0, and is −1 at
    calibration points. ``line`` (n,) are the lines in the file, ``header`` all keys, ``warnings`` one sentence
    each.
    """

    field: Array
    moment: Array
    curve: NDArray[np.int64]
    line: NDArray[np.int64]
    units: tuple[str, str]
    header: dict[str, str]
    warnings: tuple[str, ...]

    @property
    def curves(self) -> int:
        """Number of curves."""
        return int(self.curve.max(initial=-1)) + 1

    @property
    def saturated_first(self) -> bool:
        """Whether the sample was saturated before the first point, at a field (HSat) that no point exceeds."""
        h_sat = _number(self.header, "HSat")
        return h_sat is not None and h_sat >= float(self.field.max())

    @property
    def calibration(self) -> NDArray[np.bool_]:
        """Mask (n,) of the calibration points."""
        return self.curve < 0


def read_forc(path: Path) -> ForcFile:
    """Read a MicroMag-style file; DataError if it is not one, contains no curve, or does not state its units."""
    text, notes = read_text(path)
    lines = text.splitlines()
    check_lines(path, lines, MAX_LINE)
    _check_no_loop(path, lines)
    header, blocks, where = _parse(path, lines)
    units = _column_units(lines[: where[0]]) or _header_units(path, header)
    h_cal = _number(header, "HCal", "Field (HCal)", "Calibration field")
    calibration = [_is_calibration(blocks, k, h_cal) for k in range(len(blocks))]
    if all(calibration):
        raise DataError(f"{path} holds no reversal curve, only {len(blocks)} calibration points.")
    numbers = np.cumsum([not c for c in calibration]) - 1
    curve = np.concatenate(
        [np.full(len(b), -1 if c else n) for b, c, n in zip(blocks, calibration, numbers, strict=True)]
    )
    field, moment = np.concatenate(blocks).T
    for name, values in (("field", field), ("moment", moment)):
        check_size(path, name, values, np.array(where))
    forc = ForcFile(
        field=field, moment=moment, curve=curve, line=np.array(where), units=units, header=header, warnings=()
    )
    warnings = (*notes, *_header_findings(forc, lines), *_data_findings(forc))
    return ForcFile(
        field=field, moment=moment, curve=curve, line=forc.line, units=units, header=header, warnings=warnings
    )


def _check_no_loop(path: Path, lines: list[str]) -> None:
    """Raise DataError for a file whose title, above the first blank line, calls it a hysteresis loop."""
    end = next((k for k, line in enumerate(lines) if not line.strip()), len(lines))
    if any(_LOOP.fullmatch(line) and "?" not in line for line in lines[:end]):
        raise DataError(
            f"{path} holds a hysteresis loop, and no reversal curves. Model it with `smarig study {path.name}`; to "
            "import it, use --format csv with the mapping that this drafts (--map)."
        )


def _parse(path: Path, lines: list[str]) -> tuple[dict[str, str], list[Array], list[int]]:
    header: dict[str, str] = {}
    blocks: list[list[tuple[float, float]]] = [[]]
    where: list[int] = []
    for k, line in enumerate(lines):
        data = _DATA.fullmatch(line)
        if data:
            blocks[-1].append((float(data[1]), float(data[2])))
            where.append(k + 1)
        elif not line.strip():
            blocks.append([])
        elif not where:
            _header_line(header, k, line)
        elif not _is_footer(line):
            raise DataError(
                f"{path}, line {k + 1}: {shown(line.strip(), 40)} is not a field and a moment. Check the file."
            )
    found = [np.array(block) for block in blocks if block]
    if not found:
        raise DataError(f"{path} holds no line 'field, moment'. Is it a file of first-order reversal curves?")
    return header, found, where


def _header_line(header: dict[str, str], index: int, line: str) -> None:
    match = _KEY.fullmatch(line)
    if _DATE.match(line):
        header["Date"] = line.strip()
    elif match:
        header[match[1].strip()] = (match[2] or "").strip()
    elif line.strip():
        header[f"line {index + 1}"] = line.strip()


def _is_footer(line: str) -> bool:
    return "data file ends" in line.lower()


def _column_units(head: list[str]) -> tuple[str, str] | None:
    """The units of field and moment from the line that states them per column, as in "(T)   (A m^2)"."""
    found = [match for line in head if (match := _COLUMN_UNITS.fullmatch(line))]
    return (spelled(found[-1][1]), spelled(found[-1][2])) if found else None


def _header_units(path: Path, header: dict[str, str]) -> tuple[str, str]:
    """The units that the header's system of units stands for."""
    unit_name = next((v for k, v in header.items() if k.lower().startswith("units of measure")), None)
    known = "Hybrid SI, SiMuNaughtH, SI or cgs"
    if unit_name is None:
        raise DataError(
            f"{path}: the header has no 'Units of measure'. Expected {known}, or a line of units such as (T) (A m^2)."
        )
    if (listed := _LISTED_UNITS.fullmatch(unit_name)) and all(known_unit(unit) for unit in listed.groups()):
        return known_unit(listed[1]), known_unit(listed[2])
    if unit_name.lower() not in UNIT_SYSTEMS:
        raise DataError(
            f"{path}: units of measure {shown(unit_name)} are unknown. Expected {known}, or a line of units such as "
            "(T) (A m^2)."
        )
    return UNIT_SYSTEMS[unit_name.lower()]


def _number(header: dict[str, str], *names: str) -> float | None:
    for name in names:
        try:
            return number_from_text(header[name])
        except (KeyError, ValueError):
            continue
    return None


def _is_calibration(blocks: list[Array], k: int, h_cal: float | None) -> bool:
    """Whether a block is a lone point at HCal, or, without HCal in the header, a lone point above all fields of the
    next block.
    """
    if len(blocks[k]) != 1:
        return False
    if h_cal is not None:
        return abs(blocks[k][0, 0] - h_cal) < _NEAR * abs(h_cal)
    return k + 1 < len(blocks) and blocks[k][0, 0] > blocks[k + 1][:, 0].max()


def _header_findings(forc: ForcFile, lines: list[str]) -> list[str]:
    """Findings where the file contradicts its header."""
    out = []
    if not any(_is_footer(line) for line in lines[-5:]):
        out.append("The closing line is missing: the file was cut off.")
    declared_points = _number(forc.header, "NData", "Number of data")
    if declared_points is not None and declared_points != forc.field.size:
        out.append(
            f"The header declares {declared_points:.0f} points (NData), but the file holds {forc.field.size}."
        )
    curves = _number(forc.header, "NCrv", "Number of curves", "Number of FORCs")
    if curves is not None and curves != forc.curves:
        out.append(f"The header declares {curves:.0f} curves (NCrv), but the file holds {forc.curves}.")
    return out


def _data_findings(forc: ForcFile) -> list[str]:
    out = []
    back = (np.diff(forc.field) <= 0) & (np.diff(forc.curve) == 0) & (forc.curve[1:] >= 0)
    if back.any():
        line = forc.line[1:][back][0]
        out.append(
            f"The field does not rise within a curve in {int(back.sum())} place(s), first in line {line}."
        )
    first = np.flatnonzero(np.diff(forc.curve, prepend=-1) * (forc.curve >= 0))
    rising = np.flatnonzero(np.diff(forc.field[first]) >= 0)
    if rising.size:
        line = forc.line[first[rising[0] + 1]]
        out.append(f"Reversal fields do not descend in {rising.size} place(s), first in line {line}.")
    limit = _number(forc.header, "Moment range")
    if limit is not None and (np.abs(forc.moment) >= limit).any():
        out.append(
            f"{int((np.abs(forc.moment) >= limit).sum())} moments reach the end of the instrument's range, {limit:g}."
        )
    return out + _calibration_findings(forc)


def _calibration_findings(forc: ForcFile) -> list[str]:
    at = forc.calibration
    if not at.any():
        return ["There are no calibration points, so drift cannot be estimated."]
    out = []
    if at.sum() != forc.curves:
        out.append(f"There are {int(at.sum())} calibration points for {forc.curves} curves.")
    m = forc.moment[at]
    out.append(
        f"The moment at the {m.size} calibration points goes from {m[0]:.5g} to {m[-1]:.5g}{spaced(forc.units[1])} "
        f"(spread {100 * np.ptp(m) / abs(m.mean()):.2f} %)."
    )
    h_cal, h_sat = _number(forc.header, "HCal"), _number(forc.header, "HSat")
    if h_cal is not None and abs(np.median(forc.field[at]) / h_cal - 1) > 5e-4:
        out.append(
            f"Calibration points lie at {np.median(forc.field[at]):.5g}{spaced(forc.units[0])}, "
            f"but the header states {h_cal:.5g}."
        )
    if h_cal is not None and h_sat is not None and h_sat > h_cal:
        out.append(
            f"The sample was saturated at {h_sat:g}{spaced(forc.units[0])} before each calibration point. "
            f"The file does not contain these points."
        )
    return out
