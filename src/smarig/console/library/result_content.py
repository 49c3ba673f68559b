"""What the library keeps of models, of pages that smarig wrote, and of diagnoses without a page."""

import json
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from smarig.console.library.library_entry import DIAGNOSIS, MODEL, Content, FigureRow, shown_place
from smarig.console.library.run_content import content_identity
from smarig.core import DataError
from smarig.replay import Model, load_model
from smarig.report import SEVERITY_LEVELS, found_page, model_name, model_summary

ERROR = "error_times_noise"
_LARGEST_JSON = 64_000_000  # bytes


def model_content(file: Path, folder: Path) -> Content:
    """The content of a model file. Raises DataError for any other file."""
    model = load_model(file)
    summary = model_summary(model)
    wires = {run.wire for run in model.provenance}
    return Content(
        identity=content_identity(file.read_bytes()),
        kind=MODEL,
        name=model_name(file, folder),
        began=_epoch(model.created),
        wire=wires.pop() if len(wires) == 1 else "",
        rig=model.rig,
        label=summary.label,
        sentence=summary.sentence,
        details={
            "unit": model.unit,
            "input_unit": model.input.unit,
            "runs": [Path(run.run).name for run in model.provenance],
            "warnings": list(model.warnings),
        },
        figures=_model_error(model),
        u=tuple(summary.u.tolist()),
        y=tuple(summary.y.tolist()),
    )


def page_content(file: Path, place: bytes) -> Content | None:
    """The content of a page with a summary; None for any other file. Its identity is its place: pages are rewritten."""
    found = found_page(file)
    if found is None:
        return None
    summary = found.summary
    return Content(
        identity=place_identity(place),
        kind=summary.kind,
        name=found.title,
        began=file.stat().st_mtime,
        label=summary.label,
        verdict=summary.level,
        sentence=summary.sentence,
        details={"unit": summary.units[1], "input_unit": summary.units[0]},
        u=tuple(summary.u.tolist()),
        y=tuple(summary.y.tolist()),
    )


def diagnosis_content(file: Path, place: bytes) -> Content | None:
    """The content of a diagnosis.json; None for JSON of another origin. Raises DataError for a damaged file."""
    about = _json_table(file)
    word = about.get("verdict")
    if not isinstance(word, str) or word not in SEVERITY_LEVELS or "error" not in about:
        return None
    names = [name for name in about.get("set") or () if isinstance(name, str)]
    noise = (
        (about.get("adequacy") or {}).get("times_noise") if isinstance(about.get("adequacy"), dict) else None
    )
    return Content(
        identity=content_identity(file.read_bytes()),
        kind=DIAGNOSIS,
        name=shown_place(place.rpartition(b"/")[0]) or file.name,
        began=file.stat().st_mtime,
        verdict=SEVERITY_LEVELS[word],
        sentence=": ".join([word.replace("_", " "), *([", ".join(names)] if names else [])]),
        figures=_error(noise),
    )


def place_identity(place: bytes) -> str:
    """The identity of a file that is known by its place alone."""
    return content_identity(b"place " + place)


def _json_table(file: Path) -> dict[str, Any]:
    if file.stat().st_size > _LARGEST_JSON:
        raise DataError(f"{file} is larger than {_LARGEST_JSON // 10**6} MB, too large for a diagnosis.")
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise DataError(f"{file} is not JSON: {error!s:.200}.") from None
    return found if isinstance(found, dict) else {}


def _model_error(model: Model) -> dict[str, FigureRow]:
    """The error on the data that the model was fitted to, in noise floors."""
    rms, noise = model.fit.get("rms"), model.noise_floor.value
    return _error(rms / noise) if isinstance(rms, int | float) and noise else {}


def _error(times_noise: Any) -> dict[str, FigureRow]:
    known = isinstance(times_noise, int | float) and np.isfinite(times_noise)
    return {ERROR: (float(times_noise), None, None, "")} if known else {}


def _epoch(text: str) -> float | None:
    try:
        return datetime.fromisoformat(text).timestamp()
    except (ValueError, OverflowError, OSError):
        return None
