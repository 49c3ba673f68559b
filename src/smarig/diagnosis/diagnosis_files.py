"""The files of a diagnosis: diagnosis.json, and the extended model if there is one."""

import json
from pathlib import Path
from typing import Any

from smarig.core import StorageError, UsageError, atomic_file, check_replaceable
from smarig.core import file_content as file_kind
from smarig.diagnosis.comparison.commanded.commanded_diagnosis import CommandedDiagnosis
from smarig.diagnosis.comparison.measured.measured_diagnosis import MeasuredDiagnosis
from smarig.diagnosis.comparison.thermal.thermal_diagnosis import ThermalDiagnosis

DIAGNOSIS_FILES = DIAGNOSIS_JSON, DIAGNOSIS_MODEL, DIAGNOSIS_PAGE = (
    "diagnosis.json",
    "extended.model.json",
    "report.html",
)


def prepare_folder(out: Path, *, force: bool) -> None:
    """Make the folder before the computation; UsageError if a file would be replaced."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StorageError(f"Folder {out} cannot be created: {error.strerror or error}.") from None
    for name, kind in zip(DIAGNOSIS_FILES, (file_kind.JSON, file_kind.MODEL, file_kind.PAGE)):
        if (out / name).exists() and not force:
            raise UsageError(f"{out / name} exists. Give another folder, or --force to replace it.")
        check_replaceable(out / name, kind)


def write_diagnosis(
    result: CommandedDiagnosis | MeasuredDiagnosis, out: Path, *, force: bool = False
) -> dict[str, Any]:
    """Write the diagnosis; returns the paths, by key of the command line's JSON object."""
    paths: dict[str, Any] = {"out": str(out)}
    if result.extended:
        paths["model"] = str(result.model.save(out / DIAGNOSIS_MODEL, force=force))
    with atomic_file(out / DIAGNOSIS_JSON, force=force) as part:
        part.write_text(json.dumps(result.to_json() | paths, indent=2, ensure_ascii=False), encoding="utf-8")
    return paths


def write_transient(result: ThermalDiagnosis, out: Path, *, force: bool = False) -> dict[str, Any]:
    """Write the diagnosis of a thermal record; returns the paths, by key of the command line's JSON object."""
    paths = {"out": str(out)}
    with atomic_file(out / DIAGNOSIS_JSON, force=force) as part:
        part.write_text(json.dumps(result.to_json() | paths, indent=2, ensure_ascii=False), encoding="utf-8")
    return paths
