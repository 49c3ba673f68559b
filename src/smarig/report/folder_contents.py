"""What a folder holds besides runs: pages that smarig wrote, and models, each with a summary for the index."""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.core import SmarigError, spaced
from smarig.identification import ErrorLevel, error_verdict
from smarig.replay import Model, load_model
from smarig.report.components.numbers import number
from smarig.report.components.page_summary import FoundPage, PageSummary, found_page
from smarig.report.components.run_description import display_unit
from smarig.report.models.identification_plot_data import hysteresis_description
from smarig.report.models.model_loops import model_loops

MODEL_ENDING = "model.json"
_POINTS_PER_BRANCH = 20
_LEVELS = {ErrorLevel.GOOD: "good", ErrorLevel.POOR: "bad"}


@dataclass(frozen=True)
class FolderContents:
    """Pages and models of a folder and its subfolders, and a sentence for each model that could not be read."""

    pages: tuple[FoundPage, ...]
    models: tuple[FoundPage, ...]
    unreadable: tuple[str, ...]


def folder_contents(folder: Path, left_out: Collection[Path]) -> FolderContents:
    """The pages with a summary, except those ``left_out`` (of runs, and the index), and the models."""
    pages = [
        page
        for file in sorted(folder.rglob("*.html"))
        if file not in left_out and file.is_file() and (page := found_page(file)) is not None
    ]
    models, unreadable = [], []
    for file in sorted(folder.rglob(f"*{MODEL_ENDING}")):
        if file.name != MODEL_ENDING and not file.name.endswith(f".{MODEL_ENDING}"):
            continue
        try:
            models.append(FoundPage(file, file.name.removesuffix(".json"), _model_summary(load_model(file))))
        except SmarigError as error:
            unreadable.append(str(error))
    return FolderContents(tuple(pages), tuple(models), tuple(unreadable))


def _model_summary(model: Model) -> PageSummary:
    u, y = model_loops(model, _POINTS_PER_BRANCH)
    known = np.isfinite(u) & np.isfinite(y)
    units = display_unit(model.input.unit), display_unit(model.unit)
    level, words = _fit(model)
    text = ". ".join([hysteresis_description(model.hysteresis), *words]) + "."
    label = "TWIN" if model.twin else ""
    return PageSummary("model", text[:1].upper() + text[1:], level, u[known], y[known], units, label)


def _fit(model: Model) -> tuple[str, list[str]]:
    """The level and the words of the fit's error on its own data; none if it is not stated."""
    rms, extent = model.fit.get("rms"), _extent(model)
    if not isinstance(rms, float):
        return "", []
    verdict = error_verdict(rms, model.noise_floor.value, rms / extent if extent else 0.0)
    words = [f"Error on its own data {number(rms)}{spaced(display_unit(model.unit))} rms, {verdict.text}"]
    return _LEVELS.get(verdict.level, "warning"), words


def _extent(model: Model) -> float:
    ends = np.asarray(model.predict([model.hysteresis.lower, model.hysteresis.upper]), dtype=float)
    return float(np.ptp(ends)) if np.isfinite(ends).all() else 0.0
