"""``smarig certify``: what can be proved of a model before a loop is closed around it."""

from pathlib import Path

import click

from smarig.cli._output import distinct, emit, json_option
from smarig.cli._types import FILE, VELOCITY
from smarig.errors import UsageError
from smarig.file_kind import PAGE
from smarig.protocols._settings import parse_pairs

EPILOG = """\b
Examples:
  smarig certify wire.model.json
  smarig certify wire.model.json --controller leaky_pi --set gain=50 -o certificate.html
"""


@click.command("certify", epilog=EPILOG)
@click.argument("model", type=FILE)
@click.option(
    "--controller", type=VELOCITY, help="One velocity controller (default: all, at their defaults)."
)
@click.option(
    "--set", "pairs", multiple=True, metavar="KEY=VALUE", help="A number of --controller; repeatable."
)
@click.option("-o", "--out", type=FILE, help="HTML page to write.")
@click.option("--force", is_flag=True, help="Replace an existing page.")
@json_option
def command(
    model: Path, controller: str | None, pairs: tuple[str, ...], out: Path | None, force: bool
) -> None:
    """Certify a model: classes of μ, dissipativity, stored energy (Thm 8.1), and for velocity controllers δ, γ and k_e
    (Thm 8.2) with every hypothesis that fails. It speaks of the hysteresis alone, and says how far that reaches: the
    loops of track and regulate are not covered. Where passivity fails, the input that breaks it is given."""
    from smarig.closed_loop import Given
    from smarig.control.certificate import certificate
    from smarig.report.certificate_page import certificate_page, origin, units_of
    from smarig.report.page import write_page
    from smarig.whole_file import may_be_written

    if pairs and not controller:
        raise UsageError("--set belongs to one controller: name it with --controller.")
    given = Given.of(model)
    if out is not None:
        distinct(out, model)
        may_be_written(out, force=force, kind=PAGE)
    numbers = {controller: parse_pairs(pairs)} if controller else None
    found = certificate(given.model.hysteresis, numbers, units_of(given.model))
    about = origin(given.model, given.name, given.sha256)
    page = {}
    if out is not None:
        write_page(certificate_page(given.model, found, about), out, force=force)
        page = {"report": str(out)}
    words = [about.sentence(), found.text, *([f"Page: {out}"] if out else [])]
    emit(about.to_json() | found.to_json() | page, "\n".join(words))
