"""``smarig report``: pages of runs, folders, comparisons of runs, and comparisons of models."""

import os
from dataclasses import dataclass
from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import ANY_PATH, FILE, FOLDER, own_effects
from smarig.core import UsageError, check_writable, pattern_order

EPILOG = """\b
Examples:
  smarig report validation.run.sqlite -o validation.html
  smarig report out/one_wire/runs
  smarig report monday.run.sqlite tuesday.run.sqlite -o two_days.html
  smarig report out/monday out/tuesday -o two_days.html
  smarig report --model exponential.model.json --model positive.model.json validation.run.sqlite
  smarig report --model wire.model.json held.run.sqlite
  smarig report validation.run.sqlite --figures figures
  smarig report validation.run.sqlite --model wire.model.json --summary
  smarig report out/one_wire --summary
  smarig report first_order_descending.run.sqlite --forc -o density.html
  smarig report magnet.run.sqlite --smoothing 4
"""


@click.command("report", short_help="Write offline HTML pages of runs.", epilog=EPILOG)
@click.argument("runs", nargs=-1, required=True, type=ANY_PATH, metavar="RUN|DIR...")
@click.option(
    "--model",
    "models",
    multiple=True,
    type=FILE,
    help="Verify this model on the runs. Several models are compared.",
)
@click.option("-o", "--out", type=FILE, help="The HTML file; default: in the folder of the (first) run.")
@click.option(
    "--figures",
    type=FOLDER,
    metavar="DIR",
    help="Also save the figures of the page, or of all pages of a folder, in DIR, as SVG and PDF.",
)
@click.option(
    "--summary",
    is_flag=True,
    help="One sheet to print: of a run, of a --model verified on a run, of a folder of 'smarig characterise', "
    "or of several runs or folders compared.",
)
@click.option(
    "--forc",
    is_flag=True,
    help="The FORC diagram of a run with first-order curves; usual for reversal curves.",
)
@click.option(
    "--smoothing",
    type=float,
    metavar="SF",
    help="Smoothing factor of the FORC diagram, in grid steps; default: the one that predicts whole curves best.",
)
@click.option("--force", is_flag=True, help="Replace existing pages and figures.")
@own_effects
@json_option
def command(
    runs: tuple[Path, ...],
    models: tuple[Path, ...],
    out: Path | None,
    figures: Path | None,
    forc: bool,
    smoothing: float | None,
    summary: bool,
    force: bool,
) -> None:
    """Write offline HTML pages: of one run (finished, interrupted or imported), of every run in a folder
    with a searchable index, of several runs compared (of several folders: their runs of one protocol), or of
    models compared on the same runs. With one model, the page of a closed loop includes the certificate of
    that model."""
    diagram = forc or smoothing is not None
    if diagram and (len(runs) != 1 or models or runs[0].is_dir()):
        raise UsageError("A FORC diagram is made of one run, without a model. Name one run file.")
    if summary and diagram:
        raise UsageError(
            f"--summary and {'--forc' if forc else '--smoothing'} write different pages. Give one of them."
        )
    folder = runs[0] if len(runs) == 1 and runs[0].is_dir() and not models else None
    if summary and (len(models) > 1 or (models and (len(runs) != 1 or runs[0].is_dir()))):
        raise UsageError(
            "--summary is of one run, with at most one --model, of the folder of a characterisation, or of several "
            "runs or folders compared."
        )
    place = _Target(out, force, figures is not None)
    if out is not None:
        check_writable(out, force=force)  # before anything is computed
    if figures is None:
        _pages(runs, models, place, diagram, smoothing, summary)
        return
    from smarig.cli.folder_figures import save_folder_figures
    from smarig.report import figures_saved_in

    if folder is not None and not summary:
        _folder(folder, out, force)
        save_folder_figures(folder, figures, force)
    else:
        with figures_saved_in(figures, force):
            _pages(runs, models, place, diagram, smoothing, summary)
    show_message(f"Figures: {figures}")


@dataclass(frozen=True)
class _Target:
    """Where a page goes (None: its usual place), whether it replaces another, and whether only figures are wanted."""

    out: Path | None
    force: bool
    for_figures: bool

    def write(self, html: str, file: Path) -> None:
        """Write the page; one that is there already stays as it is if only its figures were asked for."""
        from smarig.report import is_smarig_page, write_page

        if self.for_figures and self.out is None and not self.force and is_smarig_page(file):
            show_message(f"{file} exists and is left as it is; --force replaces it.")
            return
        write_page(html, file, force=self.force)


def _pages(
    runs: tuple[Path, ...],
    models: tuple[Path, ...],
    place: "_Target",
    diagram: bool,
    smoothing: float | None,
    summary: bool,
) -> None:
    from smarig.report import run_files

    if summary and len(runs) == 1:
        _summary(runs[0], models[0] if models else None, place)
        return
    if diagram:
        _forc(runs[0], place, smoothing)
        return
    if len(runs) == 1 and runs[0].is_dir() and not models:
        _folder(runs[0], place.out, place.force)
        return
    given, models = pattern_order(runs), tuple(pattern_order(models))
    listed = [run_files(path) if path.is_dir() else [path] for path in given]
    found = [file for files in listed for file in files]
    if not models and len(given) > 1 and all(path.is_dir() for path in given) and all(listed):
        found = _same_protocol(listed)
    if len(models) == len(found) == 1 and _is_loop(found[0]):
        _run(found[0], place, models[0])
    elif models:
        _models(models, found, place)
    elif len(found) == 1:
        _run(found[0], place)
    else:
        _compared(found, place, summary=summary)


def _same_protocol(listed: list[list[Path]]) -> list[Path]:
    """Of each folder the run of one protocol, so that days are compared by the same inputs."""
    from smarig.report import runs_of_folders

    found, protocol = runs_of_folders(listed)
    if protocol and len(found) < sum(map(len, listed)):
        show_message(f"Compared: the runs of {protocol}. To compare others, name the run files.")
    return found


def _folder(folder: Path, out: Path | None, force: bool) -> None:
    from smarig.report import INDEX_FILE, report_folder

    if out is not None:
        raise UsageError(
            f"-o names one page, but a folder gets a page for each run and {INDEX_FILE}. Leave -o out."
        )
    made = report_folder(folder, force=force)
    for sentence in made.unreadable:
        show_message(f"Not read: {sentence}")
    pages = [{"report": str(p.report), "complete": p.complete, "cause": p.cause} for p in made.pages]
    each = "1 run, with a page" if len(pages) == 1 else f"{len(pages)} runs, each with a page"
    words = f"Report: {made.index} ({each} in the same folder)"
    emit({"report": str(made.index), "reports": pages, "unread": list(made.unreadable)}, words)


def _is_loop(file: Path) -> bool:
    from smarig.record import load_run
    from smarig.report import is_closed_loop

    return is_closed_loop(load_run(file))


def _run(file: Path, place: _Target, model: Path | None = None) -> None:
    from smarig.app import ModelSource
    from smarig.record import load_run
    from smarig.report import derived_quantities, page_path, run_page
    from smarig.transformation import headline

    target = place.out or page_path(file)
    check_distinct(target, file, model)
    run = load_run(file)
    loaded = ModelSource.of(model) if model else None
    certified = (loaded.model, loaded.name, loaded.sha256) if loaded else None
    derived = derived_quantities(run)
    place.write(run_page(run, certified=certified, derived=derived), target)
    page = {"report": str(target), "complete": run.complete, "cause": run.cause}
    found = {name: e.to_json() for name, e in headline(run).items()} if run.has("input") else {}
    figures = derived.to_json() | ({"transformation": found} if found else {})
    emit({**page, "reports": [page], **figures}, f"Report: {target}")


def _summary(file: Path, model: Path | None, place: _Target) -> None:
    from smarig.record import load_run
    from smarig.replay import load_model
    from smarig.report import page_path, summary_page

    if file.is_dir():
        _characterisation_summary(file, place)
        return
    target = place.out or page_path(file).with_suffix(".summary.html")
    check_distinct(target, file, model)
    run = load_run(file)
    place.write(summary_page(run, load_model(model) if model else None), target)
    page = {"report": str(target), "complete": run.complete, "cause": run.cause}
    emit({**page, "reports": [page]}, f"Report: {target}")


def _characterisation_summary(folder: Path, place: _Target) -> None:
    from smarig.app import characterised_folder
    from smarig.report import characterisation_summary, is_smarig_page

    target = place.out or folder / "summary.html"
    made = is_smarig_page(target)  # by 'smarig characterise'
    if made and place.out is None and not (place.force or place.for_figures):
        emit({"report": str(target)}, f"Report: {target}")
        return
    place.write(characterisation_summary(characterised_folder(folder, show_message)), target)
    emit({"report": str(target)}, f"Report: {target}")


def _forc(file: Path, place: _Target, smoothing: float | None) -> None:
    from smarig.record import load_run
    from smarig.report import forc_page, page_path

    target = place.out or page_path(file)
    check_distinct(target, file)
    run = load_run(file)
    place.write(forc_page(run, smoothing=smoothing), target)
    page = {"report": str(target), "complete": run.complete, "cause": run.cause}
    emit({**page, "reports": [page]}, f"Report: {target}")


def _compared(files: list[Path], place: _Target, *, summary: bool) -> None:
    from smarig.record import load_run
    from smarig.report import comparison_page, distinct_names

    _check_no_repeats(files, "run")
    target = place.out or files[0].with_name(f"comparison{'.summary' if summary else ''}.html")
    check_distinct(target, *files)
    runs = {name: load_run(file) for name, file in zip(distinct_names(files, ".run.sqlite"), files)}
    place.write(comparison_page(runs, summary=summary), target)
    emit({"report": str(target), "runs": [str(file) for file in files]}, f"Report: {target}")


def _models(models: tuple[Path, ...], files: list[Path], place: _Target) -> None:
    from smarig.record import load_run
    from smarig.replay import load_model
    from smarig.report import distinct_names, models_page

    _check_no_repeats(models, "model")
    _check_no_repeats(files, "run")
    target = place.out or files[0].with_name("models.html")
    check_distinct(target, *files, *models)
    names = [name.removesuffix(".json") for name in distinct_names(models, ".model.json")]
    loaded = {name: load_model(file) for name, file in zip(names, models)}
    runs = {name: load_run(file) for name, file in zip(distinct_names(files, ".run.sqlite"), files)}
    place.write(models_page(loaded, runs), target)
    plain = {"models": [str(file) for file in models], "runs": [str(file) for file in files]}
    emit({"report": str(target), **plain}, f"Report: {target}")


def _check_no_repeats(files: list[Path] | tuple[Path, ...], kind: str) -> None:
    """Raise UsageError if a file is given twice."""
    resolved = [os.path.realpath(file) for file in files]  # of links without end too
    repeated = next((file for k, file in enumerate(files) if resolved[k] in resolved[:k]), None)
    if repeated is not None:
        raise UsageError(f"{repeated} is given twice. Give each {kind} once.")
