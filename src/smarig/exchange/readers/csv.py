"""Reads text tables: smarig's own columns, or any table with a mapping file."""

from pathlib import Path

from smarig.core import UsageError
from smarig.exchange.mappings.mapping import load_mapping
from smarig.exchange.runs.mapped_csv import read_mapped_csv
from smarig.exchange.runs.own_csv import read_own_csv
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.exchange.runs.with_heating_model import with_heating_model


def csv(path: Path, *, rig: str | None = None, mapping: str | None = None) -> RunDraft:
    """Text table with a header row, or anything a mapping file describes."""
    if mapping is None:
        return read_own_csv(path, RigConstants.named(rig) if rig else None)
    described = load_mapping(mapping)
    if described.format != "csv":
        kind = "MATLAB files" if described.format == "mat" else f"files of the format {described.format}"
        raise UsageError(f"Mapping {described.name} describes {kind}. Use --format {described.format}.")
    draft = read_mapped_csv(path, described)
    return with_heating_model(draft, RigConstants.named(rig)) if rig else draft
