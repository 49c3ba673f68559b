"""All findings on the data of one file: channels and columns."""

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, Quality, shown
from smarig.exchange.checks.channel_faults import channel_findings, clipped
from smarig.record import ImportFinding, remarks

_NUMBERED = re.compile(r" \(\d+\)$")  # added to a name that stands in the header more than once


def record_findings(
    columns: Mapping[str, Array], units: Mapping[str, str], line: NDArray[np.int64]
) -> list[ImportFinding]:
    """Findings on every measured channel named in ``units``, and on command against measured current."""
    out: list[ImportFinding] = []
    for name, unit in units.items():
        if name in columns and name not in ("input", "current_command_A"):
            out += channel_findings(name, unit, columns[name], line, rests=name == "position")
    both = [columns.get(name) for name in ("current_A", "current_command_A")]
    if both[0] is not None and both[1] is not None:
        out += remarks(*_command_error(both[0], both[1]))
    return out


def _is_one_clock(a: str, b: str, x: Array) -> bool:
    """Whether two columns of one name in the file rise: the clocks of tables side by side."""
    same = _NUMBERED.sub("", a) == _NUMBERED.sub("", b)
    return same and bool((np.diff(x[np.isfinite(x)]) > 0).all())


def duplicate_columns(columns: Mapping[str, Array]) -> list[str]:
    """Findings on columns that hold the same numbers, possibly with another zero."""
    names = [n for n, x in columns.items() if np.isfinite(x).any() and np.nanmax(x) > np.nanmin(x)]
    out = []
    for k, a in enumerate(names):
        for b in names[k + 1 :]:
            apart = columns[b] - columns[a]
            known = apart[np.isfinite(apart)]
            if known.size < 3 or np.ptp(known) > 1e-9 * np.ptp(columns[a][np.isfinite(columns[a])]):
                continue
            if _is_one_clock(a, b, columns[a]):
                continue
            if np.abs(known).max() == 0:
                out.append(f"Columns {shown(a)} and {shown(b)} are identical; one is a copy of the other.")
            else:
                out.append(
                    f"Column {shown(b)} is column {shown(a)} {known[0]:+.4g}: the same data with another zero."
                )
    return out


def repeated_rows(columns: Mapping[str, Array], line: NDArray[np.int64]) -> list[ImportFinding]:
    """A finding on neighbouring rows that are equal in every column."""
    same = np.all([x[1:] == x[:-1] for x in columns.values()], axis=0)
    if not same.any():
        return []
    text = (
        f"{int(same.sum())} rows repeat the row before in every column (first: line {line[1:][same][0]}). "
        f"They were written twice or not measured again."
    )
    return [ImportFinding(text, "repeated rows")]


def saturation_marks(columns: Mapping[str, Array], channels: Mapping[str, str]) -> Array:
    """Quality marks (n,): SATURATED if one of the measured channels is clipped."""
    mask = np.zeros(next(iter(columns.values())).size, dtype=bool)
    for name in channels:
        if name in columns and name not in ("input", "current_command_A", "position"):
            mask |= clipped(columns[name])
    return mask * float(Quality.SATURATED)


def _command_error(measured: Array, command: Array) -> list[str]:
    off = measured - command
    span = float(np.nanmax(command) - np.nanmin(command))
    typical = float(np.nanmedian(np.abs(off)))
    if typical <= 0.003 * span:
        return []
    return [
        f"The measured current differs from its command by {1000 * typical:.2g} mA typically and "
        f"{1000 * np.nanmax(np.abs(off)):.2g} mA at most."
    ]
