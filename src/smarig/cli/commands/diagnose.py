"""``smarig diagnose``: find what a model predicts wrongly, explain it and extend the model."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, FOLDER, own_effects
from smarig.core import TOML, UsageError

if TYPE_CHECKING:
    from smarig.diagnosis import CommandedDiagnosis, MeasuredDiagnosis

EPILOG = """\b
Examples:
  smarig diagnose wire.model.json --train fod.run.sqlite --train loops.run.sqlite \\
      --held-out validation.run.sqlite -o diagnosis --propose next.toml
  smarig run next.toml --rig one_wire_twin -o more
  smarig diagnose --transient heating_step.run.sqlite
"""


class _MultiValueOption(click.Option):
    """An option that takes all values up to the next option: --train A B C."""

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        super().add_to_parser(parser, ctx)
        for name in self.opts:
            option = parser._long_opt.get(name)
            if option is not None:
                option.process = _taking_all_values(option.process)


def _taking_all_values(process: Any) -> Any:
    def take_all(value: str, state: Any) -> None:
        if value.startswith("--"):
            raise UsageError(f"A file is missing before {value}.")
        process(value, state)
        while state.rargs and not state.rargs[0].startswith("-"):
            process(state.rargs.pop(0), state)

    return take_all


@click.command(
    "diagnose", short_help="Find the cause of a model's errors and extend the model.", epilog=EPILOG
)
@click.argument("model", type=FILE, required=False)
@click.option("--train", type=FILE, cls=_MultiValueOption, multiple=True, help="Runs to fit to, one or more.")
@click.option(
    "--held-out",
    type=FILE,
    cls=_MultiValueOption,
    multiple=True,
    help="Runs to measure the gain on, one or more.",
)
@click.option(
    "--transient",
    type=FILE,
    help="Diagnose the measured wire temperature of this run, instead of a model; the run also needs the current or "
    "another input that heats the wire.",
)
@click.option("-o", "--out", type=FOLDER, help="Folder for extended.model.json, diagnosis.json, report.html.")
@click.option(
    "--propose",
    type=FILE,
    help="Campaign file to write: the run that distinguishes the likely hypotheses.",
)
@click.option(
    "--without", multiple=True, metavar="EFFECT", help="Leave this effect out of the catalogue; repeatable."
)
@click.option(
    "--select",
    metavar="EXPR",
    help="Use only the points of first-order curves where this holds, e.g. 'curve%2==0' (measured inputs).",
)
@own_effects
@click.option(
    "--alpha",
    type=float,
    default=0.03,
    hidden=True,
    help="Accepted, without effect: no null data are drawn.",
)
@click.option(
    "--nulls",
    type=int,
    default=400,
    hidden=True,
    help="Accepted, without effect: no null data are drawn.",
)
@click.option(
    "--seed",
    type=int,
    default=0,
    help="Seed of the resampling of blocks.",
)
@click.option("--force", is_flag=True, help="Replace existing files.")
@json_option
def command(
    model: Path | None,
    train: tuple[Path, ...],
    held_out: tuple[Path, ...],
    transient: Path | None,
    out: Path | None,
    propose: Path | None,
    without: tuple[str, ...],
    select: str | None,
    alpha: float,
    nulls: int,
    seed: int,
    force: bool,
) -> None:
    """Find what a model predicts wrongly on runs, name the cause, extend the model and measure the gain."""
    from smarig.core import check_writable
    from smarig.diagnosis import DIAGNOSIS_FILES, MeasuredDiagnosis, diagnose, prepare_folder

    if transient is not None:
        if model or train or held_out or propose or select:
            raise UsageError(
                "--transient diagnoses the temperature of one run. Leave out MODEL, --train, --held-out, --select and "
                "--propose."
            )
        _transient(transient, out, force, alpha=alpha, nulls=nulls, seed=seed, without=without)
        return
    if model is None or not train:
        raise UsageError("A diagnosis needs MODEL and --train RUN…, or --transient RUN.")
    if set(train) & set(held_out):
        raise UsageError(
            "A run is given to both --train and --held-out. Use different runs to fit and to evaluate."
        )
    inputs = (model, *train, *held_out)
    if out is not None:
        for name in DIAGNOSIS_FILES:
            check_distinct(out / name, *inputs, propose)
        prepare_folder(out, force=force)
    if propose is not None:
        check_distinct(propose, *inputs)
        check_writable(propose, force=force, kind=TOML)
    found = diagnose(
        model,
        train,
        held_out,
        alpha=alpha,
        nulls=nulls,
        seed=seed,
        without=without,
        select=select,
        progress=show_message,
    )
    paths = _written(found, out, force=force)  # save the diagnosis before hours of simulated runs
    if propose is not None and isinstance(found, MeasuredDiagnosis):
        show_message("No rig made these runs, so no run is proposed and no campaign is written.")
    elif propose is not None and not isinstance(found, MeasuredDiagnosis):
        found = _with_proposal(found, propose, force=force)
        paths = _written(found, out, force=True) if found.separating_run else paths
    emit(found.to_json() | paths, found.text())


def _transient(run: Path, out: Path | None, force: bool, **settings: Any) -> None:
    """Diagnose the thermal record of one run instead of a model."""
    from smarig.diagnosis import DIAGNOSIS_PAGE, diagnose_transient, prepare_folder, write_transient
    from smarig.report import thermal_diagnosis_page, write_page

    if out is not None:
        prepare_folder(out, force=force)
    thermal = diagnose_transient(run, **settings, progress=show_message)
    written = {}
    if out is not None:
        written = write_transient(thermal, out, force=force)
        write_page(thermal_diagnosis_page(thermal), out / DIAGNOSIS_PAGE, force=force)
        written["report"] = str(out / DIAGNOSIS_PAGE)
    emit(thermal.to_json() | written, thermal.text())


def _written(
    found: "CommandedDiagnosis | MeasuredDiagnosis", out: Path | None, *, force: bool
) -> dict[str, Any]:
    """Write the folder of a diagnosis, if requested, and return its paths."""
    from smarig.diagnosis import DIAGNOSIS_PAGE, write_diagnosis
    from smarig.report import diagnosis_page, write_page

    if out is None:
        return {}
    paths = write_diagnosis(found, out, force=force)
    write_page(diagnosis_page(found), out / DIAGNOSIS_PAGE, force=force)
    return paths | {"report": str(out / DIAGNOSIS_PAGE)}


def _with_proposal(found: "CommandedDiagnosis", path: Path, *, force: bool) -> "CommandedDiagnosis":
    """The diagnosis together with the separating run, which is written as a campaign."""
    from smarig.app import propose_run, write_campaign

    proposal = propose_run(found, show_message)
    if proposal is None:
        show_message("No run is proposed, so no campaign is written.")
        return found
    write_campaign(proposal, path, force=force)
    return replace(found, separating_run=proposal.to_json() | {"campaign": str(path)})
