"""What a run file holds, and whether it is whole. The file is only read."""

import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from smarig.core import DataError, capitalised, printable
from smarig.record.any_run import MAY_FLOW
from smarig.record.opened_run import opened_for_reading
from smarig.record.recording_lock import is_recording
from smarig.record.run import MOST_ROWS, Run, existing_file, load_run
from smarig.record.salvage import Salvaged, salvage
from smarig.record.salvaged_rows import readable_keys
from smarig.record.schema import READ, VERSION
from smarig.record.stopped_by import StoppedBy
from smarig.record.table_hashes import is_hashed
from smarig.record.tick_ranges import Ticks, ticks_json, ticks_text

_MOST_PROBLEMS = 10
HashState = Literal["right", "wrong", "none", "not_compared"]


@dataclass(frozen=True)
class RunCheck:
    """What a run file holds. ``salvaged`` is what its pages hold, if the file cannot be loaded."""

    path: Path
    samples: int
    first_s: float | None
    last_s: float | None
    steps: int
    events: int
    closed: bool | None  # None: not known
    cause: str
    hashes: HashState
    damaged_tables: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    salvaged: Salvaged | None = field(default=None, repr=False)
    stopped_by: StoppedBy | None = None
    remarks: tuple[str, ...] = ()

    @property
    def whole(self) -> bool:
        """Whether nothing is damaged. A run that was never closed may be whole."""
        return not self.problems

    @property
    def missing(self) -> tuple[Ticks, ...]:
        """Ranges of ticks that are missing."""
        return self.salvaged.missing if self.salvaged else ()

    @property
    def unverified(self) -> tuple[Ticks, ...]:
        """Ranges of ticks whose samples may hold a wrong value."""
        return self.salvaged.unverified if self.salvaged else ()

    def to_json(self) -> dict[str, Any]:
        """The check as ``smarig check RUN --json`` reports it."""
        return {
            "run": str(self.path),
            "whole": self.whole,
            "samples": self.samples,
            "first_s": self.first_s,
            "last_s": self.last_s,
            "steps": self.steps,
            "events": self.events,
            "closed": self.closed,
            "cause": self.cause,
            "stopped_by": self.stopped_by
            and {"kind": self.stopped_by.kind, "account": self.stopped_by.account},
            "hashes": self.hashes,
            "damaged_tables": list(self.damaged_tables),
            "missing_ticks": ticks_json(self.missing),
            "unverified_ticks": ticks_json(self.unverified),
            "problems": list(self.problems),
        }

    def sentences(self) -> list[str]:
        """The check in plain sentences."""
        span = "" if self.first_s is None else f" from {self.first_s:.1f} s to {self.last_s:.1f} s"
        closed = {
            True: f"It was closed; cause: {self.cause.rstrip('.')}.{self._requester}",
            False: "It is still being recorded."
            if is_recording(self.path)
            else "It was never closed: it was interrupted, and smarig resume continues it.",
            None: "Whether it was closed is not known, because its description is damaged.",
        }[self.closed]
        found = [
            f"{self.path} holds {self.samples} samples{span}, {self.steps} steps and {self.events} events.",
            closed,
            self._hash_sentence(),
            *self.remarks,
            *(f"Damage: {problem}." for problem in self.problems),
        ]
        if self.salvaged and self.salvaged.cut_text:
            found.append(f"{capitalised(self.salvaged.cut_text)}.")
        if self.missing:
            found.append(f"Missing samples: ticks {ticks_text(self.missing)}.")
        if self.unverified:
            found.append(f"A value may be wrong in ticks {ticks_text(self.unverified)}.")
        return [*found, "The file is whole." if self.whole else "The file is damaged."]

    @property
    def _requester(self) -> str:
        return f" Its end was requested by {self.stopped_by.text}." if self.stopped_by else ""

    def _hash_sentence(self) -> str:
        tables = " and ".join(f"'{table}'" for table in self.damaged_tables)
        if self.hashes == "not_compared":
            return "What its tables hold was not compared with their hashes."
        if self.hashes == "none":
            lost = f" Something is missing in {tables}." if tables else ""
            return (
                f"It has no hashes, which are stored when a run is closed: changed values go unnoticed.{lost}"
            )
        if self.hashes == "right":
            return "What its tables hold is what was stored when the run was closed."
        return f"What it holds in {tables} is not what was stored when the run was closed."


def check_run(path: str | Path) -> RunCheck:
    """Read all of a run file. Raises UsageError if there is none, and DataError if it holds nothing of a run."""
    file = existing_file(path)
    problems = _integrity(file)
    if not problems and (crowded := _of_crowded(file)):
        return crowded
    try:
        run = load_run(file)
    except DataError as error:
        found = salvage(file)
        if found.meta.get("schema_version", VERSION) != VERSION:
            raise
        return _of_damaged(file, found, problems, str(error))
    return _of_run(run, problems)


def _integrity(file: Path) -> list[str]:
    """What SQLite finds wrong in the structure of the file."""
    try:
        with opened_for_reading(file) as db:
            found = [str(row[0]) for row in db.execute(f"PRAGMA integrity_check({_MOST_PROBLEMS})")]
    except (sqlite3.Error, ValueError, DataError) as error:
        return [f"SQLite cannot read it: {printable(str(error), 300).rstrip('.')}"]
    return [f"SQLite: {' '.join(text.split())}" for text in found if text != "ok"]


def _of_crowded(file: Path) -> RunCheck | None:
    """The check of a file of sound structure with more rows than a run is read with: counted, not read. None for all
    others. Nothing is salvaged, which would take minutes: the rows are all there."""
    try:
        with opened_for_reading(file) as db:
            rows = {name: db.execute(f'SELECT count(*) FROM "{name}"').fetchone()[0] for name in READ}
            crowded = [name for name, most in MOST_ROWS.items() if rows[name] > most]
            if not crowded:
                return None
            first_s, last_s = db.execute(
                "SELECT (SELECT t_s FROM sample ORDER BY tick LIMIT 1), "
                "(SELECT t_s FROM sample ORDER BY tick DESC LIMIT 1)"
            ).fetchone()
            end = db.execute("SELECT value FROM run WHERE key = 'end'").fetchone()
    except (sqlite3.Error, ValueError, DataError):
        return None
    known = readable_keys([("end", end[0])])[0].get("end") if end else None
    return RunCheck(
        file,
        rows["sample"],
        first_s,
        last_s,
        rows["step"],
        rows["event"],
        end is not None,
        str(known.get("cause", "")) if isinstance(known, dict) else "",
        "not_compared",
        problems=tuple(
            f"table '{name}' has {rows[name]:,} rows; a run is read with at most {MOST_ROWS[name]:,}"
            for name in crowded
        ),
    )


def _remarks_on(run: Run) -> Iterator[str]:
    """What a whole file does not tell by itself."""
    for event in run.events:
        if event.kind == "salvaged":
            yield f"It was saved from a damaged file. {event.text}"
    if run.may_flow:
        yield MAY_FLOW
    if not run.complete and not run.path.with_name(f"{run.path.name}-wal").exists():
        yield (
            f"{run.path.name}-wal is not beside it. If it was left behind when the file was copied, its last samples, "
            "or all, are missing here: copy both."
        )


def _of_run(run: Run, problems: list[str]) -> RunCheck:
    times_s = run["t_s"]
    known = times_s[times_s == times_s]
    return RunCheck(
        run.path,
        len(run),
        float(known[0]) if known.size else None,
        float(known[-1]) if known.size else None,
        len(run.steps),
        len(run.events),
        run.complete,
        run.cause,
        "right" if is_hashed(run.meta) else "none",
        problems=tuple(problems),
        remarks=tuple(_remarks_on(run)),
        stopped_by=run.stopped_by,
    )


def _of_damaged(file: Path, found: Salvaged, problems: list[str], error: str) -> RunCheck:
    times_s = [row[1] for row in found.samples if row[1] is not None]
    return RunCheck(
        file,
        len(found.samples),
        times_s[0] if times_s else None,
        times_s[-1] if times_s else None,
        len(found.steps),
        len(found.events),
        True if "end" in found.meta else None if "run" in found.damaged_tables else False,
        found.cause,
        "none" if not is_hashed(found.meta) else "wrong" if found.damaged_tables else "right",
        found.damaged_tables,
        tuple(problems) or (error.split(" `smarig check")[0].rstrip("."),),
        found,
        stopped_by=found.stopped_by,
    )
