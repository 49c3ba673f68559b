"""``smarig verify``: the error of a model on measured runs."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.output import emit, json_option, show_message
from smarig.cli.parameter_types import FILE, own_effects
from smarig.core import spaced
from smarig.identification import threshold_sentences

if TYPE_CHECKING:
    from smarig.identification import RunVerification


EPILOG = "\n\n".join(
    [
        "\b\nExample:\n  smarig verify wire.model.json validation.run.sqlite",
        "The verdict on the rms error:",
        *threshold_sentences(),
        "The noise floor is the scatter of settled points that were repeated in one run (docs/reference/verdicts.md).",
    ]
)


@click.command("verify", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option(
    "--select", metavar="EXPR", help="Evaluate only the points where this holds, e.g. 'curve%2==1'."
)
@own_effects
@json_option
def command(model: Path, runs: tuple[Path, ...], select: str | None) -> None:
    """Verify a model on the settled points of runs. The model is simulated along the whole history of each
    run."""
    from smarig.identification import ErrorLevel, verify
    from smarig.record import load_run
    from smarig.replay import driven_by_input, load_model

    described, loaded = load_model(model), [load_run(r) for r in runs]
    result = verify(described, loaded, select=select)
    can_be_diagnosed = all(run.settled for run in loaded) or driven_by_input(loaded)
    found = result.to_json()
    unit = found["unit"]
    for run in found["runs"]:
        for warning in run.get("warnings", ()):
            show_message(f"Warning: {warning}")
    for run in result.runs:
        if run.verdict.level == ErrorLevel.POOR:
            show_message(f"Warning: The model does not predict {run.run}: {run.verdict.size}.")
    remedy = (
        f"smarig diagnose {model} --train RUN… looks for the cause"
        if can_be_diagnosed
        else "smarig diagnose looks for the cause, in runs that wait at each level, such as those of 'validation'"
    )
    lines = [
        f"{run['run']}: rms error {run['rms']:.4g}{spaced(unit)} ({_share(run)}), "
        f"largest {run['max_abs']:.4g}{spaced(unit)}, n = {run['n']}; noise floor "
        f"{_floor(run, unit)}{_expected(run, unit)}"
        for run in found["runs"]
    ]
    emit(found, "\n".join([*lines, *(_verdict(run, remedy) for run in result.runs)]))


def _verdict(run: "RunVerification", remedy: str) -> str:
    """Whether the error is good, and what to do if not."""
    from smarig.identification import ErrorLevel

    found = run.verdict
    more = f" ({remedy})" if found.level == ErrorLevel.POOR else ""
    return f"Verdict: {found.text}{more}."


def _share(run: dict) -> str:
    """The error over the measured range, if that is more than noise."""
    from smarig.identification import ONLY_NOISE

    if run["nrmse"] is None:
        return f"no NRMSE: {ONLY_NOISE}"
    return f"NRMSE {run['nrmse']:.3g}"


def _expected(run: dict, unit: str) -> str:
    """The error to be expected at a load that was not measured."""
    return (
        f"; expected at this load {run['expected_rms']:.2g}{spaced(unit)} rms"
        if "expected_rms" in run
        else ""
    )


def _floor(run: dict, unit: str) -> str:
    return (
        f"{run['noise_floor']:.2g}{spaced(unit)}"
        if run["noise_floor"] is not None
        else "unknown (nothing repeats)"
    )
