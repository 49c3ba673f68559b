"""``smarig calibrate``: the constants of a wire from runs, with confidence intervals."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, CatalogueName
from smarig.core import UsageError

if TYPE_CHECKING:
    from smarig.plant import Actuator
    from smarig.record import Run


@click.command(
    "calibrate",
    short_help="Estimate the constants of a wire from runs.",
    epilog="\b\nExample:\n  smarig calibrate validation.run.sqlite --actuator gorbet_one_wire",
)
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option(
    "--actuator",
    type=CatalogueName("actuators"),
    help="Parameter set to start from (default: the actuator of the runs).",
)
@click.option(
    "--model",
    type=FILE,
    help="Model of this wire. With it, position transients give the time constant, and -o writes its hysteresis too.",
)
@click.option("-o", "--out", type=FILE, help="Actuator file to write (*.toml).")
@click.option("--force", is_flag=True, help="Replace an existing actuator file.")
@json_option
def command(
    runs: tuple[Path, ...], actuator: str | None, model: Path | None, out: Path | None, force: bool
) -> None:
    """Estimate hA, time constant and resistances from runs, and report those that the runs do not determine."""
    from smarig.identification import calibrate
    from smarig.plant import Actuator
    from smarig.record import load_run
    from smarig.replay import load_model

    base = Actuator.named(actuator) if actuator else None
    hysteresis = None
    if model is not None:
        identified = load_model(model)
        hysteresis = identified.hysteresis
        if out is not None and identified.input.unit != "K":
            raise UsageError(
                f"The input of {model} is in {identified.input.unit}; that of an actuator file is in K above ambient. "
                "Identify the model from runs of the rig."
            )
    check_distinct(out, model, *runs)
    loaded = [load_run(r) for r in runs]
    base = _checked(base, loaded, kelvin_of_model=model is not None)
    result = calibrate(loaded, base, hysteresis)
    if out is not None and base is None:
        raise UsageError("An actuator file needs a parameter set to start from. Give --actuator.")
    if out is not None and base is not None:
        result.write_actuator(out, base, hysteresis=hysteresis, force=force)
    found = result.to_json()
    lines = [
        f"{name} = {e.value:.4g} {e.unit}  (95 %: {e.ci95[0]:.4g} … {e.ci95[1]:.4g}, n = {e.n}; {e.source})"
        for name, e in result.parameters.items()
    ]
    lines += [f"{name}: {why}" for name, why in result.not_available.items()]
    emit(found, "\n".join(lines))


def _checked(base: "Actuator | None", runs: "Sequence[Run]", *, kelvin_of_model: bool) -> "Actuator | None":
    """The actuator to start from: by default that of the runs.

    Raises UsageError if a model's inputs, in kelvin of the actuator of its runs, are not in those of another one.
    """
    from smarig.replay import recorded_actuator

    recorded = recorded_actuator(runs[0])
    if base is None or recorded is None or base.file == recorded.file:
        return base or recorded
    if kelvin_of_model and not math.isclose(base.gain_K_per_A2, recorded.gain_K_per_A2, rel_tol=1e-6):
        raise UsageError(
            f"The runs were made with the actuator '{recorded.name}', which 1 A heats by {recorded.gain_K_per_A2:.4g} "
            f"K; '{base.name}' says {base.gain_K_per_A2:.4g} K, so the inputs of the model are no kelvins of it. Leave "
            "--actuator out, or give the actuator of the runs."
        )
    if base.name != recorded.name:
        show_message(
            f"Warning: the runs were made with the actuator '{recorded.name}'. What they do not determine is taken "
            f"from '{base.name}'."
        )
    return base
