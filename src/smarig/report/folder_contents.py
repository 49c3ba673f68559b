"""What a folder holds besides runs: pages that smarig wrote, and models; and which of its runs is compared with others.

Of several folders the run of one protocol that all of them hold is compared. A folder of ``characterise`` begins with
an initialisation, which hardly heats the wire: it shows nothing of the loops.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.core import SmarigError, leads_out, natural_order, spaced
from smarig.record import load_run
from smarig.replay import Model, load_model
from smarig.report.components.numbers import number
from smarig.report.components.page_summary import FoundPage, PageSummary, found_page
from smarig.report.components.run_description import display_unit
from smarig.report.models.identification_plot_data import hysteresis_description, model_loops

MODEL_ENDING = "model.json"
_POINTS_PER_BRANCH = 20


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
        for file in natural_order(folder.rglob("*.html"))
        if file not in left_out
        and _is_text(file)
        and file.is_file()
        and not leads_out(file, folder)
        and (page := found_page(file)) is not None
    ]
    models, unreadable = [], []
    for file in natural_order(folder.rglob(f"*{MODEL_ENDING}")):
        if not _is_text(file) or leads_out(file, folder):
            continue
        if file.name != MODEL_ENDING and not file.name.endswith(f".{MODEL_ENDING}"):
            continue
        try:
            models.append(FoundPage(file, model_name(file, folder), model_summary(load_model(file))))
        except SmarigError as error:
            unreadable.append(str(error))
    return FolderContents(tuple(pages), tuple(models), tuple(unreadable))


def _is_text(file: Path) -> bool:
    """Whether a page can hold the name: names on disk may be no UTF-8."""
    try:
        str(file).encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def model_summary(model: Model) -> PageSummary:
    """The summary of a model: its kind, the error on its own data, and its loops."""
    u, y = model_loops(model, _POINTS_PER_BRANCH)
    known = np.isfinite(u) & np.isfinite(y)
    units = display_unit(model.input.unit), display_unit(model.unit)
    text = ". ".join([hysteresis_description(model.hysteresis), *_fit(model)]) + "."
    label = "TWIN" if model.twin else ""
    return PageSummary("model", text[:1].upper() + text[1:], "", u[known], y[known], units, label)


def _fit(model: Model) -> list[str]:
    """The words of the fit's error on its own data; none if it is not stated. It is no verdict on the wire."""
    rms = model.fit.get("rms")
    if not isinstance(rms, float):
        return []
    return [f"Error on the data it was fitted to: {number(rms)}{spaced(display_unit(model.unit))} rms"]


def model_name(file: Path, folder: Path) -> str:
    """The name of a model: of its file, or of its folder where the file is called model.json."""
    name = file.name.removesuffix(".json").removesuffix(".model")
    return f"{file.parent.name}/{name}" if name in ("model", "extended") and file.parent != folder else name


_BEST_FIRST = (
    "first_order_descending",
    "first_order_ascending",
    "validation",
)  # by what they show of the loops
_SHOWS_NO_LOOP = "initialise"


def runs_of_folders(folders: Sequence[Sequence[Path]]) -> tuple[list[Path], str]:
    """The files to compare, and the protocol that they share.

    Without one that each folder holds, all files that show loops, or simply all, and "".
    """
    protocols = [{file: load_run(file).info.protocol or "" for file in files} for files in folders]
    common = set.intersection(*({*one.values()} for one in protocols)) - {_SHOWS_NO_LOOP, ""}
    if not common:
        every = [(file, protocol) for one in protocols for file, protocol in one.items()]
        return [file for file, protocol in every if protocol != _SHOWS_NO_LOOP] or [f for f, _ in every], ""
    shared = next((p for p in _BEST_FIRST if p in common), min(common))
    return [next(file for file, protocol in one.items() if protocol == shared) for one in protocols], shared
