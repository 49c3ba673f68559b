"""Imports a data file as a run: reads it, adds the description of an imported run, and writes it completely or not
at all.
"""

import hashlib
import platform
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from smarig.core import DataError, StorageError, UsageError, catalogue_entry, check_file, in_unit, opened_file
from smarig.exchange.checks.value_bounds import LONGEST_S
from smarig.exchange.mappings.mapping import mapping_text
from smarig.exchange.refused_files import check_data_file
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.repair import Repair, repaired
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.exchange.unchanged_file import unchanged
from smarig.measurement import CONTINUES_AT
from smarig.record import CONTINUED, ImportFinding, Run, load_run, write_run

LARGEST_BYTES = 2 * 10**9


@dataclass(frozen=True)
class ImportReport:
    """The result of an import: the run, its samples and steps, and the findings on the file."""

    run: Path
    rows: int
    steps: int
    findings: tuple[ImportFinding, ...]
    repairs: tuple[Repair, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """The findings, one or two sentences each."""
        return tuple(f.text for f in self.findings)


def import_file(
    path: str | Path,
    *,
    format: str,
    out: str | Path,
    rig: str | None = None,
    mapping: str | None = None,
    t0: float | None = None,
    wire: str | None = None,
    continues: str | Path | None = None,
    repair: bool = False,
    force: bool = False,
) -> ImportReport:
    """Read ``path`` in ``format`` (csv, forc, …) and write the run ``out``.

    ``rig`` and ``mapping`` are names or paths. ``t0`` is the time in seconds of the file's zero on a clock shared
    with other runs. ``wire`` is the identity of the wire. ``continues`` is the imported part of the same record before
    this one: the run then starts in its final state. ``repair``: rows that the findings call faulty are masked or
    dropped, and the run keeps which. Raises UsageError, ConfigError, DataError or
    StorageError. An existing file ``out`` is replaced only with ``force``.
    """
    source, target = Path(path), Path(out)
    check_file(source)
    if source.stat().st_size > LARGEST_BYTES:
        raise DataError(f"{source} is larger than {LARGEST_BYTES // 10**9} GB. Split it.")
    if t0 is not None and not abs(t0) <= LONGEST_S:
        raise UsageError(f"--t0 is {t0:g}. Give a time in seconds.")
    read = catalogue_entry("smarig.exchange.readers", format)
    check_data_file(source)
    if target.exists() and not force:
        raise UsageError(f"{target} exists; give another name or --force to replace it.")
    before = load_run(continues) if continues is not None else None
    with unchanged([source]):
        draft = read(source, rig=rig, mapping=mapping)
        described = _describe(source, format, rig, mapping, wire)
    draft, repairs = repaired(draft) if repair else (draft, ())
    if t0 is not None:
        draft = _shifted(draft, source, t0)
    known = [f.to_json() for f in draft.findings if f.kind]
    meta = (
        described | draft.meta | {"warnings": list(draft.warnings)} | ({"findings": known} if known else {})
    )
    if draft.began_s is not None:
        meta["imported"] = described["imported"] | {CONTINUES_AT: {"began_s": draft.began_s}}
    if t0 is not None:
        meta["t0_s"] = t0
    if before is not None:
        meta = _continued(meta, source, before)
    try:
        write_run(target, meta, draft.sql_columns(), list(draft.steps), force=force)
    except OSError as error:
        raise StorageError(f"Run file {target} cannot be written: {error.strerror or error}.") from None
    return ImportReport(target, len(draft), len(draft.steps), draft.findings, repairs)


def _shifted(draft: RunDraft, source: Path, t0: float) -> RunDraft:
    if "t_s" not in draft.columns or not (draft.columns["t_s"] == draft.columns["t_s"]).all():
        raise UsageError(f"{source} has no time, so --t0 has no meaning. Leave it out.")
    columns = {**draft.columns, "t_s": draft.columns["t_s"] + t0}
    steps = tuple((*s[:5], s[5] + t0, s[6] + t0, *s[7:]) for s in draft.steps)
    began_s = None if draft.began_s is None else draft.began_s + t0
    return replace(draft, columns=columns, steps=steps, began_s=began_s)


def _continued(meta: dict[str, Any], source: Path, before: Run) -> dict[str, Any]:
    """The description of a run that continues another: its wire, its final state, and which data it continues."""
    data = before.info.imported
    if data is None or data.sha256 is None:
        raise UsageError(
            f"{before.path} is not an imported run. --continues needs the imported part before {source}."
        )
    if data.sha256 == meta["imported"]["sha256"]:
        raise UsageError(f"{before.path} was imported from the data of {source}. Give the part before it.")
    units = [meta.get(key, {}).get("unit", "") for key in ("input", "output")]
    if units != [before.input_unit, before.unit]:
        raise DataError(
            f"{source} has its input {in_unit(units[0])} and its output {in_unit(units[1])}, but "
            f"{before.path} has them "
            f"{in_unit(before.input_unit)} and {in_unit(before.unit)}. Parts of one record need the same units."
        )
    wire = meta["wire"] or before.info.wire
    if before.info.wire and wire != before.info.wire:
        raise UsageError(f"{before.path} is of wire '{before.info.wire}', not of '{wire}'. Name one wire.")
    part = {"continues": before.path.name, "continues_sha256": data.sha256}
    return meta | {"wire": wire, "initial": CONTINUED, "imported": meta["imported"] | part}


def _describe(
    source: Path, format: str, rig: str | None, mapping: str | None, wire: str | None
) -> dict[str, Any]:
    facts = RigConstants.named(rig) if rig else None
    return {
        "source": "import",
        "rig": facts.file.name if facts else None,
        "wire": wire or (facts.file.wire if facts else None),
        "actuator": facts.actuator.name if facts else None,
        "start_epoch": None,
        "notes": "",
        "config": mapping_text(mapping) if mapping else "",
        "imported": {
            "file": source.name,
            "format": format,
            "mapping": mapping,
            "sha256": _sha256(source),
        },
        "versions": {"smarig": version("smarig"), "python": platform.python_version()},
    }


def _sha256(source: Path) -> str:
    with opened_file(source) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
