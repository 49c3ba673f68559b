"""Reads a NumPy archive (.npz) with a mapping file."""

from pathlib import Path

from smarig.core import UsageError
from smarig.exchange.binary.npz_file import read_npz
from smarig.exchange.mappings.mapping import load_mapping
from smarig.exchange.runs.mapped_csv import mapped_draft
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.exchange.runs.with_heating_model import with_heating_model


def npz(path: Path, *, rig: str | None = None, mapping: str | None = None) -> RunDraft:
    """A NumPy archive (.npz), described by a mapping file with a [npz] table."""
    if mapping is None:
        raise UsageError(
            f"{path} needs a mapping file (--map) that names its columns; `smarig study` drafts one."
        )
    described = load_mapping(mapping)
    if described.npz is None:
        raise UsageError(f"Mapping {described.name} has no [npz] table. Use --format {described.format}.")
    draft = mapped_draft(path, read_npz(path, described), described)
    return with_heating_model(draft, RigConstants.named(rig)) if rig else draft
