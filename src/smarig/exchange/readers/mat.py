"""Reads MATLAB 5 files with a mapping file that names their variables."""

import hashlib
from dataclasses import replace
from pathlib import Path

from smarig.core import UsageError, file_bytes
from smarig.exchange.binary.mat_file import file_set, read_mat_table
from smarig.exchange.mappings.mapping import load_mapping
from smarig.exchange.runs.mapped_csv import mapped_draft
from smarig.exchange.runs.reader_result import RunDraft
from smarig.exchange.runs.rig_constants import RigConstants
from smarig.exchange.runs.with_heating_model import with_heating_model


def mat(path: Path, *, rig: str | None = None, mapping: str | None = None) -> RunDraft:
    """MATLAB 5 variables (save -v6, -v7), named and described by a mapping file with a [mat] table."""
    if mapping is None:
        raise UsageError(f"{path} does not describe its variables. Name them with a mapping file (--map).")
    described = load_mapping(mapping)
    if described.mat is None:
        raise UsageError(
            f"Mapping {described.name} has no [mat] table, so it describes text. Use --format csv."
        )
    draft = mapped_draft(path, read_mat_table(path, described, described.mat), described)
    others = [file for file in file_set(path, described.mat.files) if file != path]
    if others:
        sums = {file.name: hashlib.sha256(file_bytes(file)).hexdigest() for file in others}
        draft = replace(draft, meta=draft.meta | {"companions": sums})
    return with_heating_model(draft, RigConstants.named(rig)) if rig else draft
