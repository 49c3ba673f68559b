"""A run as data: columns with units, steps and events, read from a finished or unfinished run file."""

import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import (
    DataError,
    NotebookDisplay,
    Severity,
    UsageError,
    highest_severity,
    printable,
    severity_of,
)
from smarig.record.metadata import (
    MAX_ENTRIES,
    MAX_LINE_LENGTH,
    check_amount,
    check_metadata,
    decode_json,
)
from smarig.record.opened_run import opened_for_reading
from smarig.record.run_info import RunInfo
from smarig.record.schema import READ, SAMPLE_COLUMNS, VERSION
from smarig.record.table_hashes import damaged_rows

CONTINUED = "continued"  # ``initial`` of a run that starts in the final state of the one before
OWN_ZERO = "own"  # ``encoder_zero`` of an imported run whose zero is unrelated to that of other runs
FORC_PROTOCOL = "first_order_reversal_curves"  # protocol of runs imported from FORC files
_NO_ROWS = slice(0, 0)
_LARGEST_STEP = 2**53  # larger integers are not exact in a column of floats
_SAME_TIME_S = 1e-6  # rounding of a clock
MAX_ROWS = 200_000  # of steps, and of events; a protocol has at most 100 000 steps
MOST_ROWS = {"run": MAX_ENTRIES, "step": MAX_ROWS, "event": MAX_ROWS}


@dataclass(frozen=True, slots=True)
class Step:
    """One step; ``position`` is the mean over its settle window of n samples."""

    index: int
    attempt: int
    void: bool
    branch: str
    target: float | None
    t_start_s: float
    t_end_s: float | None
    verdict: str
    position: float | None
    n: int

    @property
    def end_s(self) -> float:
        """Time of its end, or of its start if no end was recorded."""
        return self.t_start_s if self.t_end_s is None else self.t_end_s

    @property
    def duration_s(self) -> float:
        """Time from start to end; 0 if no end was recorded."""
        return self.end_s - self.t_start_s


@dataclass(frozen=True, slots=True)
class Event:
    """An event: level (info, warning, error), kind, one sentence."""

    t_s: float
    level: str
    kind: str
    text: str
    data: dict[str, Any]

    @property
    def severity(self) -> Severity:
        """None, minor, major or invalid."""
        return severity_of(self.kind, self.level, self.data)


@dataclass(frozen=True)
class Run(NotebookDisplay):
    """A recorded run. ``run["current_A"]`` is a column (n,), NaN where absent; ``run.info`` is its description.

    Columns: tick, t_s, step, current_command_A, current_A, voltage_V, temperature_degC, input, counts,
    position, ambient_degC, quality. ``info`` names the quantities and units of ``input`` and ``position``.
    ``meta`` is the description as stored, for code that copies or lists all of it.
    """

    path: Path
    meta: dict[str, Any]
    columns: dict[str, NDArray[np.float64]] = field(repr=False)
    steps: tuple[Step, ...] = field(repr=False)
    events: tuple[Event, ...] = field(repr=False)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name not in self.columns:
            raise UsageError(f"A run has no column '{name}'. Its columns are: {', '.join(SAMPLE_COLUMNS)}.")
        return self.columns[name]

    def __len__(self) -> int:
        return self["tick"].size

    @cached_property
    def info(self) -> RunInfo:
        """The description, typed."""
        return RunInfo.of(self.meta)

    @property
    def name(self) -> str:
        """The name of the file without the endings of run files: "qv.first3" for qv.first3.run.sqlite."""
        return self.path.name.removesuffix(".sqlite").removesuffix(".run")

    def with_meta(self, **entries: Any) -> "Run":
        """The run with other entries of its description."""
        return replace(self, meta={**self.meta, **entries})

    @property
    def complete(self) -> bool:
        """Whether the run was closed (kill -9 and power cuts leave it open)."""
        return self.info.has("end")

    @property
    def cause(self) -> str:
        """Why the run ended: 'done', what interrupted it, or that it was never closed."""
        end = self.info.end
        return "incomplete: the run was never closed" if end is None or end.cause is None else end.cause

    @property
    def severity(self) -> Severity:
        """The highest severity of its events."""
        return highest_severity(e.severity for e in self.events)

    @property
    def twin(self) -> bool:
        """Whether the run was made on a twin."""
        return self.info.source == "twin"

    @property
    def unit(self) -> str:
        """Unit of position."""
        return self.info.output.unit

    @property
    def input_unit(self) -> str:
        """Unit of the hysteresis input."""
        return self.info.input.unit

    @cached_property
    def settled(self) -> tuple[Step, ...]:
        """Valid steps with a target and a position, in order: the points (T_i, p_i) of §5.2.1."""
        return tuple(s for s in self.steps if not s.void and s.target is not None and s.position is not None)

    def points(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Settled inputs and outputs, each (k,); those of every sample if there are no steps."""
        if self.settled:
            return (
                np.array([s.target for s in self.settled], dtype=float),
                np.array([s.position for s in self.settled], dtype=float),
            )
        known = np.isfinite(self["input"]) & np.isfinite(self["position"])
        return self["input"][known], self["position"][known]

    @cached_property
    def step_rows(self) -> dict[int, slice]:
        """Rows of the samples of each step number; the last segment if a number occurs in several."""
        number = self["step"]
        if not number.size:
            return {}
        edges = np.flatnonzero(np.diff(np.nan_to_num(number, nan=-1.0)) != 0) + 1
        begins, ends = np.concatenate([[0], edges]), np.concatenate([edges, [number.size]])
        return {
            int(number[a]): slice(int(a), int(b))
            for a, b in zip(begins, ends)
            if abs(number[a]) < _LARGEST_STEP
        }

    def rows(self, step: Step) -> slice:
        """Rows of a step's samples; empty if no sample has its number."""
        return self.step_rows.get(step.index, _NO_ROWS)

    def window(self, step: Step) -> slice:
        """Rows of the settle window of a step: its last n samples, or all if it has fewer."""
        rows = self.rows(step)
        return slice(max(rows.stop - max(step.n, 0), rows.start), rows.stop)

    def rows_by_clock(self, steps: Sequence[Step]) -> list[slice]:
        """Rows of the samples after each step's start, up to its end; works without step numbers too."""
        starts_s, ends_s = [s.t_start_s for s in steps], [s.end_s for s in steps]
        begin, end = (np.searchsorted(self["t_s"], np.add(t_s, _SAME_TIME_S)) for t_s in (starts_s, ends_s))
        return [slice(int(a), int(b)) for a, b in zip(begin, end)]

    def has(self, name: str) -> bool:
        """Whether a channel was measured."""
        return bool(np.isfinite(self[name]).any())

    def __repr__(self) -> str:
        kind = "twin" if self.twin else self.info.text_of("source", "?")
        hours = (self["t_s"][-1] - self["t_s"][0]) / 3600 if len(self) and self.has("t_s") else 0.0
        return (
            f"Run({self.info.text_of('protocol', '?')} on {self.info.text_of('rig', '?')} ({kind}), "
            f"{len(self)} samples, {hours:.2f} h, {len(self.steps)} steps, {self.cause})"
        )


def load_run(path: str | Path) -> Run:
    """Read a run file, finished, running or interrupted. Raises DataError if it is not one."""
    file = Path(path)
    if not file.is_file():
        raise UsageError(f"There is no run file {file}.")
    try:
        with opened_for_reading(file) as db:
            return _read(file, db)
    except (sqlite3.Error, ValueError, TypeError, IndexError, OverflowError) as error:
        raise DataError(
            f"{file} is not a run file, or is damaged: {printable(str(error), 300)}. {salvage_hint(file)}"
        ) from None


def _read(file: Path, db: sqlite3.Connection) -> Run:
    rows = {table: _rows(db, query, MOST_ROWS.get(table)) for table, query in READ.items()}
    meta = {k: _meta_value(k, v) for k, v in rows["run"]}
    _check_version(file, meta)
    check_metadata(meta)
    check_amount([row[-1] for row in rows["event"]])
    data = np.array(rows["sample"], dtype=float).reshape(len(rows["sample"]), len(SAMPLE_COLUMNS))
    columns = {name: data[:, k] for k, name in enumerate(SAMPLE_COLUMNS)}
    run = Run(
        file,
        meta,
        columns,
        tuple(_step(*row) for row in rows["step"]),
        tuple(_event(*row) for row in rows["event"]),
    )
    _check_hashes(run, rows)
    return run


def _check_hashes(run: Run, rows: dict[str, list[tuple]]) -> None:
    tables = sorted({damaged.table for damaged in damaged_rows(run.meta, rows)})
    if tables:
        raise DataError(
            f"Run file {run.path} is damaged: what it holds in {' and '.join(map(repr, tables))} is not what was "
            f"stored when the run was closed. {salvage_hint(run.path)}"
        )


def salvage_hint(file: Path) -> str:
    """What to do with a damaged run file."""
    return f"`smarig check {file}` shows what can be saved."


def _rows(db: sqlite3.Connection, query: str, most: int | None) -> list[tuple]:
    if most is None:
        return db.execute(query).fetchall()
    rows = db.execute(query).fetchmany(most + 1)
    if len(rows) > most:
        raise ValueError(f"its description, steps or events have more than {most} rows")
    return rows


def _meta_value(key: Any, value: Any) -> Any:
    if not isinstance(key, str):
        raise TypeError("a key of its description is not a string")
    try:
        return decode_json(value)
    except (ValueError, TypeError) as error:
        raise ValueError(f"its key {key!r} cannot be read: {error}") from None


def _event(t_s, level, kind, text, data) -> Event:
    decoded_data = decode_json(data or "{}")
    if not isinstance(decoded_data, dict):
        raise TypeError("the data of an event are not a table")
    return Event(float(t_s or 0.0), _line(level), _line(kind), _line(text), decoded_data)


def _line(value: Any) -> str:
    text = str(value or "")
    if len(text) > MAX_LINE_LENGTH:
        raise ValueError(f"a text of its steps or events has more than {MAX_LINE_LENGTH} characters")
    return text


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _step(index, attempt, void, branch, target, t_start_s, t_end_s, verdict, position, n) -> Step:
    return Step(
        index=int(index),
        attempt=int(attempt),
        void=bool(void),
        branch=_line(branch),
        target=_number(target),
        t_start_s=float(t_start_s or 0.0),
        t_end_s=_number(t_end_s),
        verdict=_line(verdict),
        position=_number(position),
        n=int(n or 0),
    )


def _check_version(file: Path, meta: dict[str, Any]) -> None:
    version = meta.get("schema_version")
    if version != VERSION:
        raise DataError(
            f"{file} has run schema version {str(version)[:20]}; this smarig reads version {VERSION}."
        )
