"""Repairs of an imported file: rows that its findings call faulty are masked or dropped, and the record keeps which."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.exchange.checks.channel_faults import lone_spikes
from smarig.exchange.checks.dropped_readings import drops
from smarig.exchange.runs.reader_result import RunDraft
from smarig.record import FindingKind, remarks

Mask = NDArray[np.bool_]
MASKED, DROPPED = "masked", "dropped"


@dataclass(frozen=True)
class Repair:
    """Rows (of the file's table, from 0) that were ``masked`` in ``channels``, or dropped as a whole.

    ``finding`` is the kind of the findings that no longer apply, ``of`` the channel where there may be several.
    """

    finding: FindingKind
    treatment: str
    rows: tuple[int, ...]
    channels: tuple[str, ...] = ()
    of: str = ""

    @property
    def kind(self) -> str:
        """What is repaired, the key of the run's ``repairs``."""
        return f"{self.finding}{self.of}"

    def to_json(self) -> dict[str, Any]:
        """Plain values, as the run keeps them; neighbouring rows as [first, last]."""
        return {
            "treatment": self.treatment,
            "count": len(self.rows),
            "rows": _ranges(self.rows),
            "channels": list(self.channels),
        }

    @property
    def text(self) -> str:
        """One sentence."""
        where = f" in {', '.join(self.channels)}" if self.channels else ""
        return f"Repaired: {len(self.rows)} rows {self.treatment}{where} ({self.kind})."


def repaired(draft: RunDraft) -> tuple[RunDraft, tuple[Repair, ...]]:
    """The draft without drop-outs, single-row spikes and repeated rows; drafts of settled steps are as they were."""
    if draft.steps or "input" not in draft.columns:
        return draft, ()
    columns = {name: x.copy() for name, x in draft.columns.items()}
    found = [_masked(columns, "drop-outs", _driving(columns), drops(columns["input"]))]
    for name in ("input", "position"):
        if name in columns:
            channels = _driving(columns) if name == "input" else [name]
            found.append(_masked(columns, "spikes", channels, lone_spikes(columns[name]), f" of {name}"))
    again = _repeated(columns)
    if again.any():
        found.append(Repair("repeated rows", DROPPED, _rows(again)))
        columns = {name: x[~again] for name, x in columns.items()}
    done = tuple(r for r in found if r.rows)
    meta = draft.meta | ({"repairs": {r.kind: r.to_json() for r in done}} if done else {})
    mended = {r.finding for r in done}
    left = [f.without_kind if f.kind in mended else f for f in draft.findings]
    findings = (*left, *remarks(*(r.text for r in done)))
    return replace(draft, columns=columns, meta=meta, findings=findings), done


def _driving(columns: Mapping[str, Array]) -> list[str]:
    """The input and the channel that it is a copy of."""
    u = columns["input"]
    copies = [n for n, x in columns.items() if n != "input" and np.array_equal(x, u, equal_nan=True)]
    return ["input", *copies]


def _masked(
    columns: dict[str, Array], finding: FindingKind, channels: list[str], rows: Mask, of: str = ""
) -> Repair:
    for name in channels:
        columns[name][rows] = np.nan
    return Repair(finding, MASKED, _rows(rows), tuple(channels), of)


def _repeated(columns: Mapping[str, Array]) -> Mask:
    """Rows that repeat the row before in every channel; with a clock, equal rows may be rest."""
    t = columns.get("t_s")
    n = columns["input"].size
    same = np.zeros(n, dtype=bool)
    clock = t is not None and bool(np.isfinite(t).all())
    names = [c for c in columns if clock or c != "t_s"]
    pairs = [(columns[c][1:], columns[c][:-1]) for c in names]
    same[1:] = np.all([(a == b) | (np.isnan(a) & np.isnan(b)) for a, b in pairs], axis=0)
    return same & np.isfinite(columns["input"])


def _rows(mask: Mask) -> tuple[int, ...]:
    return tuple(np.flatnonzero(mask).tolist())


def _ranges(rows: tuple[int, ...]) -> list[list[int]]:
    """Neighbouring rows as [first, last].

    >>> _ranges((3, 4, 5, 9))
    [[3, 5], [9, 9]]
    """
    found: list[list[int]] = []
    for row in rows:
        if found and row == found[-1][1] + 1:
            found[-1][1] = row
        else:
            found.append([row, row])
    return found
