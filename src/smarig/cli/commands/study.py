"""``smarig study``: from somebody's data files to a page."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.output import emit, json_option, json_requested, show_message
from smarig.cli.parameter_types import ANY_PATH, FOLDER, CatalogueName
from smarig.cli.working_line import without_line
from smarig.core import UsageError, pattern_order

if TYPE_CHECKING:
    from smarig.study import Split, StudyOptions, StudyResult

EPILOG = """\b
Examples:
  smarig study loop.csv -o loop
  smarig study monday.csv tuesday.csv --split run -o wire
  smarig study 50MPa.txt 100MPa.txt 200MPa.txt --split load -o alloy
  smarig study measured.xlsx --input 'T [°C]' --output Weg --unit Weg=mm -o measured
  smarig study data/ -o pages --workers 4
"""


@click.command("study", short_help="Make a page from data files of any origin.", epilog=EPILOG)
@click.argument("places", metavar="FILE…", nargs=-1, required=True, type=ANY_PATH)
@click.option(
    "--split",
    type=click.Choice(["auto", "run", "time", "curve", "load", "none"]),
    default="auto",
    show_default=True,
    help="Data that the model is tested on: other runs, a later part, other curves, another load.",
)
@click.option(
    "--map",
    "mapping",
    type=CatalogueName("imports"),
    help="Mapping file, in place of the draft; by name or path.",
)
@click.option("--input", "input_", metavar="NAME", help="Column of the input.")
@click.option("--output", metavar="NAME", help="Column of the output.")
@click.option("--unit", "units", multiple=True, metavar="NAME=UNIT", help="Unit of a column; repeatable.")
@click.option("--yes", is_flag=True, help="Take the draft of the mapping without a question.")
@click.option(
    "--each", is_flag=True, help="Study each file on its own and compare them; a folder implies it."
)
@click.option("--no-diagnosis", is_flag=True, help="Do not look for the causes of the errors.")
@click.option(
    "--workers",
    type=click.IntRange(1, 1000),
    help="Processes for many files (default: as many as processors).",
)
@click.option("--scheduler", metavar="ADDRESS", help="Dask scheduler for many files (extra 'scale').")
@click.option(
    "--figures", metavar="DIR", type=FOLDER, help="Also save the figures of the page in DIR, as SVG and PDF."
)
@click.option("-o", "--out", type=FOLDER, required=True, help="Folder of the page, mapping, runs and model.")
@json_option
def command(
    places: tuple[Path, ...],
    split: "Split",
    mapping: str | None,
    input_: str | None,
    output: str | None,
    units: tuple[str, ...],
    yes: bool,
    each: bool,
    no_diagnosis: bool,
    workers: int | None,
    scheduler: str | None,
    figures: Path | None,
    out: Path,
) -> None:
    """Read data files of any origin, find what their columns mean, identify a model, compare it with simple curves,
    diagnose it, and write a page. The files given together are runs of one specimen; a folder gives a page for each
    file."""
    from smarig.study import StudyOptions

    options = StudyOptions(
        split=split,
        mapping=mapping,
        input=input_,
        output=output,
        units=_units(units),
        accept=yes,
        diagnose=not no_diagnosis,
    )
    _check_out(out, places)
    if each or scheduler is not None or any(place.is_dir() for place in places):
        if figures is not None:
            raise UsageError("--figures saves those of one page. Study the files together, or name one file.")
        _each(places, out, options, workers or os.cpu_count() or 1, scheduler)
    elif figures is None:
        _one(pattern_order(places), out, options)
    else:
        from smarig.report import figures_saved_in

        figures.mkdir(
            parents=True, exist_ok=True
        )  # a place that cannot be written is refused before the work
        with figures_saved_in(figures, force=True):  # as the page, which a study replaces
            _one(pattern_order(places), out, options)
        show_message(f"Figures: {figures}")


def _one(files: Sequence[Path], out: Path, options: "StudyOptions") -> None:
    from smarig.study import POOR, field_sentences, next_step, study

    result = study(files, out, options, ask=_asker(), progress=show_message)
    show_message(_columns_text(result))
    for title, reason in (result.understood.left_out | result.left_out).items():
        show_message(f"Left out: {title}: {reason.removesuffix('.')}.")
    if result.verdict == POOR and result.function is None:
        show_message("Warning: The model is poor. Do not use it before its errors are explained.")
    temperatures = result.transformation.lines() if result.transformation else []
    step = [f"Next: {text}"] if (text := next_step(result)) else []
    lines = [
        *result.false_readings(),
        *filter(None, result.sentences()),
        *step,
        *field_sentences(result.field_loops),
        *temperatures,
        *result.reasons,
        *result.hints(),
    ]
    lines = list(dict.fromkeys([*lines, f"Page: {out / 'index.html'}"]))  # what is false is a hint as well
    emit(result.to_json(), "\n".join(lines))


def _each(
    places: Sequence[Path], out: Path, options: "StudyOptions", workers: int, scheduler: str | None
) -> None:
    from smarig.study import studies_json, study_each

    outcomes = study_each(places, out, options, workers=workers, scheduler=scheduler, progress=show_message)
    found = studies_json(outcomes, out)
    tried = found["studied"] + len(found["failed"])
    if not found["studied"]:
        raise UsageError(f"None of the {tried} files could be studied; {out / 'index.html'} says why.")
    failed = f", {len(found['failed'])} failed" if found["failed"] else ""
    failed += f"; {len(found['left_out'])} left out, not data" if found["left_out"] else ""
    last = f"{found['studied']} of {tried} files studied{failed}. Page: {out / 'index.html'}"
    emit(found, "\n".join([*found["other_zeros"].values(), *found["over_rates"].values(), last]))


def _columns_text(result: "StudyResult") -> str:
    """The columns with their roles, and the drafted mapping."""
    if result.understood.forc:
        return "Reversal curves, which state their own columns."
    if result.mapping is not None:
        return f"Columns as described by mapping {result.mapping}."
    lines = ["Columns:"]
    guess = result.understood.guesses[0]
    for c in guess.columns:
        role = guess.shown_role(c.name)
        unit = f", {c.unit} assumed" if c.unit_is_assumed else f" in {c.unit}" if c.unit else ""
        unit = "" if c.unit_is_assumed and role.role == "ignored" else unit
        lines.append(
            f"  {c.name}: {role.role}{unit}; {c.facts.low:.4g} … {c.facts.high:.4g}, {c.facts.looks()}; {role.reason}"
        )
    lines += [f"Sign of the output: {guess.sign}."] if guess.sign else []
    draft = result.folder / "mapping.toml"
    if draft.is_file():
        lines += [f"Mapping ({draft}):", draft.read_text(encoding="utf-8")]
    return "\n".join(lines)


def _asker() -> Callable[[str, Sequence[str]], str] | None:
    """A function that asks at the terminal; None where nobody answers."""
    if (
        json_requested()
        or None in (sys.stdin, sys.stderr)
        or not (sys.stdin.isatty() and sys.stderr.isatty())
    ):
        return None

    def ask(question: str, choices: Sequence[str]) -> str:
        kind = click.Choice(list(choices)) if choices else str
        with without_line():
            return click.prompt(question, type=kind, err=True)

    return ask


def _units(entries: Sequence[str]) -> dict[str, str]:
    found = {}
    for entry in entries:
        name, sign, unit = entry.rpartition("=")
        if not sign or not name or not unit:
            raise UsageError(f"--unit {entry} is not understood. Give NAME=UNIT, for example --unit Weg=mm.")
        found[name] = unit
    return found


def _check_out(out: Path, places: Sequence[Path]) -> None:
    for place in places:
        if place.is_dir() and (out.resolve() == place.resolve() or place.resolve() in out.resolve().parents):
            raise UsageError(
                f"{out} lies in {place}, so its files would be studied next time. Give another folder."
            )
