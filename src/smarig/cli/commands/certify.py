"""``smarig certify``: what is proved about a model before a loop is closed around it."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from smarig.cli.output import check_distinct, emit, json_option
from smarig.cli.parameter_types import FILE, VELOCITY
from smarig.core import PAGE, UsageError

if TYPE_CHECKING:
    from smarig.certificate import RobustCertificate
    from smarig.replay import Model

EPILOG = """\b
Examples:
  smarig certify wire.model.json
  smarig certify wire.model.json --controller leaky_pi --set gain=50 -o certificate.html
  smarig certify wire.model.json --run validation.run.sqlite --position-controller 10,20/1,0.5
"""


@click.command(
    "certify", short_help="List what is proved about a model: passivity, stability.", epilog=EPILOG
)
@click.argument("model", type=FILE)
@click.option(
    "--controller", type=VELOCITY, help="Velocity controller (default: all of them, with default parameters)."
)
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A parameter of --controller; repeatable."
)
@click.option(
    "--run",
    "runs",
    multiple=True,
    type=FILE,
    help="Run whose readings are compared with the bound; repeatable.",
)
@click.option(
    "--position-controller",
    "laws",
    multiple=True,
    metavar="N/D",
    help="Position controller K(s) of §9.2 as numerator/denominator, each with the coefficients of 1, s, s², for "
    "instance 10,20/1,0.5; repeatable.",
)
@click.option(
    "--samples",
    type=click.IntRange(0, 100_000),
    default=100,
    show_default=True,
    help="Models drawn from the uncertainty of the identification, for the probability that the model is "
    "dissipative; 0: none.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of these draws.")
@click.option("-o", "--out", type=FILE, help="HTML page to write.")
@click.option("--force", is_flag=True, help="Replace an existing page.")
@json_option
def command(
    model: Path,
    controller: str | None,
    pairs: tuple[str, ...],
    runs: tuple[Path, ...],
    laws: tuple[str, ...],
    samples: int,
    seed: int,
    out: Path | None,
    force: bool,
) -> None:
    """Certify a model: classes of μ, dissipativity, stored energy (Thm 8.1), and for velocity controllers δ,
    γ and k_e (Thm 8.2), with every hypothesis that fails. If passivity fails, an input that violates it
    is printed. The probability that the model is dissipative follows from models drawn from the uncertainty of its
    identification. The certificate covers the hysteresis alone; it does not cover the closed loops of the commands
    track and regulate."""
    from smarig.app import ModelSource, timing_of
    from smarig.certificate import PositionController, certificate
    from smarig.core import check_writable
    from smarig.identification import passivity_of_run
    from smarig.protocols import parse_pairs
    from smarig.record import load_run
    from smarig.report import Further, certificate_page, certificate_units, certified_model, write_page

    if pairs and not controller:
        raise UsageError("--set applies to one controller only. Name it with --controller.")
    source = ModelSource.of(model)
    if out is not None:
        check_distinct(out, model, *runs)
        check_writable(out, force=force, kind=PAGE)
    numbers = {controller: parse_pairs(pairs)} if controller else None
    units, timing = certificate_units(source.model), timing_of(source.model)
    found = certificate(source.model.hysteresis, numbers, units, timing)
    model_origin = certified_model(source.model, source.name, source.sha256)
    further = Further(
        {path.name: passivity_of_run(load_run(path), source.model) for path in runs},
        tuple(PositionController.parse(text) for text in laws),
        _robust(source.model, samples, seed),
    )
    page = {}
    if out is not None:
        write_page(certificate_page(source.model, found, model_origin, further), out, force=force)
        page = {"report": str(out)}
    sentences = [model_origin.summary_text(), found.text, *further.text, *([f"Page: {out}"] if out else [])]
    emit(model_origin.to_json() | found.to_json() | further.to_json() | page, "\n".join(sentences))


def _robust(model: "Model", samples: int, seed: int) -> "RobustCertificate | None":
    """The probabilities over models drawn from the uncertainty in the file; None for no samples."""
    from smarig.certificate import model_posterior, robust_certificate
    from smarig.report import certificate_units

    if not samples:
        return None
    posterior = model_posterior(
        model.hysteresis,
        model.parameters,
        model.covariance,
        non_negative="smoothing" in model.fit,
    )
    return robust_certificate(posterior, samples, seed=seed, unit=certificate_units(model).energy)
