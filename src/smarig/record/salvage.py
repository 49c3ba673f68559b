"""Takes from a damaged run file what its pages still hold, and writes it to a new one.

With the hashes of its blocks it is known which samples are missing and which may hold a wrong value. Without them (a
run that was never closed, or of an older smarig) only gaps between ticks are known.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from smarig.core import RUN, DataError, swapped_file
from smarig.record import schema
from smarig.record.new_run_file import new_run_file
from smarig.record.opened_run import recovered_file
from smarig.record.page_scan import PageScan
from smarig.record.run_end import store_end
from smarig.record.salvaged_rows import placed, readable_keys
from smarig.record.stopped_by import StoppedBy
from smarig.record.table_hashes import damaged_rows, is_hashed
from smarig.record.tick_ranges import Ticks, missing_and_unverified, ticks_json, ticks_text

_NEVER_CLOSED = "the run was never closed"
_UNKNOWN = "not known, because the description of the run is damaged"


@dataclass(frozen=True)
class Salvaged:
    """What a damaged run file still holds. ``missing`` and ``unverified`` are ranges of ticks."""

    source: Path
    meta: dict[str, Any]
    lost_keys: tuple[str, ...]
    samples: list[tuple] = field(repr=False)
    steps: list[tuple] = field(repr=False)
    events: list[tuple] = field(repr=False)
    damaged_tables: tuple[str, ...] = ()
    unreadable_pages: int = 0  # that the disk does not give
    missing: tuple[Ticks, ...] = ()
    unverified: tuple[Ticks, ...] = ()
    cut_off: tuple[int, int] | None = None  # bytes that the file has, and those that its header states

    @property
    def cause(self) -> str:
        """Why the run ended, as far as it is known."""
        end = self.meta.get("end")
        if isinstance(end, dict):
            return str(end.get("cause") or _UNKNOWN)
        return _UNKNOWN if "run" in self.damaged_tables else _NEVER_CLOSED

    @property
    def stopped_by(self) -> StoppedBy | None:
        """Who asked for the end, as far as it is known."""
        end = self.meta.get("end")
        return StoppedBy.of(end.get("stopped_by")) if isinstance(end, dict) else None

    @property
    def cut_text(self) -> str:
        """How much of the file is missing at its end; "" if nothing."""
        if self.cut_off is None:
            return ""
        held, stated = self.cut_off
        return f"the file was cut off after {100 * held / stated:.0f} % ({held:,} of {stated:,} bytes)"

    @property
    def _no_gap_text(self) -> str:
        """Without hashes, nothing tells what came after the last sample."""
        if is_hashed(self.meta) and "sample" not in self.damaged_tables:
            return "no sample is missing"
        return (
            "no tick is missing between its samples, and whether samples followed the last one is not known"
        )

    def amount(self) -> str:
        """How much it is."""
        return f"{len(self.samples)} samples, {len(self.steps)} steps and {len(self.events)} events"

    def to_json(self) -> dict[str, Any]:
        """The same as ``smarig check RUN -o FILE --json`` reports it."""
        return {
            "samples": len(self.samples),
            "steps": len(self.steps),
            "events": len(self.events),
            "lost_keys": list(self.lost_keys),
        }

    def sentence(self) -> str:
        """What is missing and what may be wrong."""
        parts = [
            *([self.cut_text] if self.cut_text else []),
            f"ticks {ticks_text(self.missing)} are missing" if self.missing else self._no_gap_text,
            *([f"in ticks {ticks_text(self.unverified)} a value may be wrong"] if self.unverified else []),
            *([f"the disk does not give {self.unreadable_pages} pages"] if self.unreadable_pages else []),
            *([f"the keys {', '.join(self.lost_keys)} are lost"] if self.lost_keys else []),
            *(f"the table '{table}' is not complete" for table in self.damaged_tables if table != "sample"),
        ]
        return f"Salvaged from {self.source.name}: {'; '.join(parts)}."


def salvage(file: Path) -> Salvaged:
    """What the pages of a run file hold. Raises DataError if that is nothing, and OSError."""
    rows: dict[str, dict[Any, tuple]] = {table: {} for table in schema.READ}
    with recovered_file(file) as recovered:
        scan = PageScan(recovered)
        for row in scan.rows():
            table, key, cells = placed(row)
            if table:
                rows[table].setdefault(key, cells)
    meta, lost = readable_keys(rows["run"].values())
    if "schema_version" not in meta and not rows["sample"]:
        raise DataError(
            swapped_file(file, RUN)
            or f"Nothing can be saved from {file}: none of its pages holds a sample or the description of a run."
        )
    tables = {table: [row for _, row in sorted(found.items())] for table, found in rows.items()}
    missing, unverified = missing_and_unverified(tables["sample"], meta)
    return Salvaged(
        file,
        meta,
        tuple(lost),
        tables["sample"],
        tables["step"],
        tables["event"],
        _damaged_tables(meta, tables),
        scan.unreadable,
        tuple(missing),
        tuple(unverified),
        _cut_off(file),
    )


def _cut_off(file: Path) -> tuple[int, int] | None:
    """The bytes of a database file, and those that its header states, if it is shorter (SQLite file format, 1.3)."""
    try:
        with file.open("rb") as opened:
            header = opened.read(32)
    except OSError:  # a disk that does not give the first page
        return None
    if len(header) < 32 or not header.startswith(b"SQLite format 3\0"):
        return None
    page_bytes = int.from_bytes(header[16:18], "big")
    stated = int.from_bytes(header[28:32], "big") * (65536 if page_bytes == 1 else page_bytes)
    held = file.stat().st_size
    return (held, stated) if held < stated else None


def _damaged_tables(meta: dict[str, Any], tables: dict[str, list[tuple]]) -> tuple[str, ...]:
    """Tables of which something is lost or wrong, as far as it is known."""
    differ = {damaged.table for damaged in damaged_rows(meta, tables)}
    return tuple(sorted(differ | ({"run"} if "schema_version" not in meta else set())))


def write_salvaged(found: Salvaged, out: Path, *, force: bool) -> None:
    """Write it to a new run file, marked in its description and by an event."""
    damage = {
        "missing_ticks": ticks_json(found.missing),
        "unverified_ticks": ticks_json(found.unverified),
    }
    damage_found = {"from": found.source.name, **damage, "lost_keys": list(found.lost_keys)}
    meta = {**found.meta, "schema_version": schema.VERSION, "salvaged": damage_found}
    t_s = found.samples[-1][1] if found.samples else 0.0
    damaged = found.missing or found.damaged_tables or found.lost_keys or found.unreadable_pages
    level = "warning" if damaged else "info"
    event = (t_s or 0.0, level, "salvaged", found.sentence(), json.dumps(damage))
    with new_run_file(out, meta, force=force) as db, db:
        db.executemany(schema.INSERT_SAMPLE, found.samples)
        db.executemany(schema.INSERT_STEP, found.steps)
        db.executemany(schema.INSERT_EVENT, [*found.events, event])
        store_end(db, found.cause, stopped_by=found.stopped_by)
