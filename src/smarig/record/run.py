"""A run as data: columns with units, steps and events, read from a finished or unfinished run file."""

import contextlib
import sqlite3
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from smarig.core import (
    RUN,
    Array,
    DataError,
    NotebookDisplay,
    Severity,
    UsageError,
    check_file,
    printable,
    severity_of,
    swapped_file,
)
from smarig.record.any_run import BLOCK_ROWS, AnyRun
from smarig.record.metadata import (
    MAX_ENTRIES,
    MAX_LINE_LENGTH,
    check_amount,
    check_metadata,
    decode_json,
)
from smarig.record.opened_run import opened_for_reading
from smarig.record.sample_columns import LARGEST, count_unmeasurable, read_columns
from smarig.record.schema import READ, SAMPLE_COLUMNS, VERSION
from smarig.record.table_hashes import block_hash, damaged_tables, hashes_of, is_hashed
from smarig.record.tracked_reference import REFERENCE, reference_column

CONTINUED = "continued"  # ``initial`` of a run that starts in the final state of the one before
OWN_ZERO = "own"  # ``encoder_zero`` of an imported run whose zero is unrelated to that of other runs
# ``encoder_zero`` of a run that counts from the zero of its sensor begins with it; the sensor's identity follows
ABSOLUTE_ZERO = "absolute: "
FORC_PROTOCOL = "first_order_reversal_curves"  # protocol of runs imported from FORC files
_UNMEASURABLE = (
    f"{{count}} sample(s) or step(s) hold a number over {LARGEST:g}, which nothing measured can be. "
    "It counts as missing."
)
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


@dataclass(frozen=True, repr=False)
class Run(AnyRun, NotebookDisplay):
    """A recorded run. ``run["current_A"]`` is a column (n,), NaN where absent; ``run.info`` is its description.

    Columns: tick, t_s, step, current_command_A, current_A, voltage_V, temperature_degC, input, counts,
    position, ambient_degC, quality; of a tracked run, also reference. ``info`` names the quantities and units of
    ``input`` and ``position``.
    ``meta`` is the description as stored, for code that copies or lists all of it.
    """

    # frozen; ``AnyRun`` cannot say that its attributes are read-only
    path: Path  # pyrefly: ignore [bad-override]
    meta: dict[str, Any]  # pyrefly: ignore [bad-override]
    columns: dict[str, Array] = field(repr=False)
    steps: tuple[Step, ...] = field(repr=False)  # pyrefly: ignore [bad-override]
    events: tuple[Event, ...] = field(repr=False)  # pyrefly: ignore [bad-override]

    def __getitem__(self, name: str) -> Array:
        if name == REFERENCE and (mark := self._tracking) is not None:
            return reference_column(self.columns["t_s"], mark)
        check_column(name, self.columns)
        return self.columns[name]

    @property
    def _tracking(self) -> dict[str, Any] | None:
        """What the mark of a closed loop says of its reference; None if nothing was tracked."""
        return next((e.data for e in self.events if e.kind == "mark" and REFERENCE in e.data), None)

    def __len__(self) -> int:
        return self["tick"].size

    def blocks(self, names: Sequence[str], rows: int = BLOCK_ROWS) -> Iterator[dict[str, Array]]:
        """The named columns in blocks of that many rows, in order."""
        for a in range(0, len(self), rows):
            yield {name: self[name][a : a + rows] for name in names}

    def extremes(self, name: str) -> tuple[float, float] | None:
        """The smallest and the largest value of a channel; None if it was not measured."""
        known = self[name][np.isfinite(self[name])]
        return (float(known.min()), float(known.max())) if known.size else None

    def marked(self, *marks: int) -> tuple[int, ...]:
        """The number of samples with each of these quality marks."""
        quality = np.nan_to_num(self["quality"]).astype(int)
        return tuple(int(np.count_nonzero(quality & mark)) for mark in marks)

    @property
    def span_s(self) -> float:
        """Time from the first to the last sample that has one; 0 if none has."""
        known = self["t_s"][np.isfinite(self["t_s"])]
        return float(known[-1] - known[0]) if known.size else 0.0

    def to_pandas(self) -> Any:
        """The samples as a ``pandas.DataFrame`` over time; see ``record.data_frames.frame_of``."""
        from smarig.record.data_frames import frame_of

        return frame_of(self)

    def to_xarray(self) -> Any:
        """The samples as an ``xarray.Dataset`` over time, with units."""
        from smarig.record.data_frames import dataset_of

        return dataset_of(self)

    def with_meta(self, **entries: Any) -> "Run":
        """The run with other entries of its description."""
        return replace(self, meta={**self.meta, **entries})

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


def load_run(path: str | Path) -> Run:
    """Read a run file, finished, running or interrupted. Raises DataError if it is not one."""
    file = existing_file(path)
    with reading(file), opened_for_reading(file) as db:
        return _read(file, db)


def existing_file(path: str | Path) -> Path:
    """The path; UsageError if there is no regular file."""
    file = Path(path)
    check_file(file, "run file")
    return file


@contextlib.contextmanager
def reading(file: Path) -> Iterator[None]:
    """Report what goes wrong while a run file is read as a DataError that names the file."""
    try:
        yield
    except (sqlite3.Error, ValueError, TypeError, IndexError, OverflowError) as error:
        raise DataError(
            swapped_file(file, RUN)
            or f"{file} is not a run file, or is damaged: {printable(str(error), 300)}. {salvage_hint(file)}"
        ) from None


def _read(file: Path, db: sqlite3.Connection) -> Run:
    meta, steps, events = read_description(file, db)
    hashes: list[str] = []
    hashed = is_hashed(meta)
    columns = read_columns(db, seen=(lambda block: hashes.append(block_hash(block))) if hashed else len)
    if hashed:
        refuse_damage(file, meta, {"sample": hashes})
    if count := count_unmeasurable(db):
        meta = meta | {"warnings": [*meta.get("warnings", ()), _UNMEASURABLE.format(count=count)]}
    return Run(file, meta, columns, steps, events)


def read_description(
    file: Path, db: sqlite3.Connection
) -> tuple[dict[str, Any], tuple[Step, ...], tuple[Event, ...]]:
    """All that a run file holds but its samples: description, steps, events. Raises DataError if it was changed."""
    rows = {table: _rows(db, READ[table], most) for table, most in MOST_ROWS.items()}
    meta = {k: _meta_value(k, v) for k, v in rows["run"]}
    _check_version(file, meta)
    check_metadata(meta)
    check_amount([row[-1] for row in rows["event"]])
    refuse_damage(file, meta, hashes_of(rows))
    return meta, tuple(_step(*row) for row in rows["step"]), tuple(_event(*row) for row in rows["event"])


def refuse_damage(file: Path, meta: dict[str, Any], hashes: dict[str, list[str]]) -> None:
    """Raise DataError if the hashes of these tables are not those that were stored at closing."""
    tables = damaged_tables(meta, hashes)
    if tables:
        raise DataError(
            f"Run file {file} is damaged: what it holds in {' and '.join(map(repr, tables))} is not what was "
            f"stored when the run was closed. {salvage_hint(file)}"
        )


def salvage_hint(file: Path) -> str:
    """What to do with a damaged run file."""
    return f"`smarig check {file}` shows what can be saved."


def _rows(db: sqlite3.Connection, query: str, most: int) -> list[tuple]:
    rows = db.execute(query).fetchmany(most + 1)
    if len(rows) > most:
        raise ValueError(f"its description, steps or events have more than {most} rows")
    return rows


def check_column(name: str, columns: Container[str] = SAMPLE_COLUMNS) -> None:
    """Raise UsageError unless a run has a column of that name."""
    if name not in columns:
        raise UsageError(f"A run has no column '{name}'. Its columns are: {', '.join(SAMPLE_COLUMNS)}.")


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
    return float(value) if value is not None and abs(float(value)) <= LARGEST else None


def _step(index, attempt, void, branch, target, t_start_s, t_end_s, verdict, position, n) -> Step:
    return Step(
        index=int(index),
        attempt=int(attempt),
        void=bool(void),
        branch=_line(branch),
        target=_number(target),
        t_start_s=_number(t_start_s) or 0.0,
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


Runs = Run | str | Path | Sequence[Run | str | Path]


def loaded_runs(runs: Runs) -> list[Run]:
    """Runs or their paths, one or several, as runs. Raises UsageError for others, and what ``load_run`` raises."""
    several = [runs] if isinstance(runs, Run | str | Path) or not isinstance(runs, Iterable) else list(runs)
    if not all(isinstance(run, Run | str | Path) for run in several):
        raise UsageError("Give runs, as load_run returns them, or the paths of their files.")
    return [run if isinstance(run, Run) else load_run(run) for run in several]
