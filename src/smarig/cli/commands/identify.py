"""``smarig identify``: identify a model from runs."""

from pathlib import Path

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, SurfaceKind
from smarig.core import MODEL, check_writable
from smarig.identification import BEST_KIND, extension_names, surface_choices

EPILOG = """\b
Examples:
  smarig identify fod.run.sqlite --surface exponential -o wire.model.json
  smarig identify sweeps.run.sqlite -o wire.model.json
  smarig identify fod.run.sqlite loops.run.sqlite --surface positive -o wire.model.json
  smarig identify fod.run.sqlite loops.run.sqlite --surface exponential --extension best -o wire.model.json
  smarig identify 50_MPa.run.sqlite 150_MPa.run.sqlite --load-from stress -o wire.model.json
  smarig identify forc.run.sqlite --surface table --select 'curve%2==0' -o half.model.json
"""


@click.command("identify", short_help="Identify a Preisach model from runs.", epilog=EPILOG)
@click.argument("runs", nargs=-1, required=True, type=FILE)
@click.option(
    "--surface",
    type=SurfaceKind(surface_choices()),
    default=BEST_KIND,
    show_default=True,
    help="Kind of surface, or the surface form of a plug-in by name.",
)
@click.option("--select", metavar="EXPR", help="Fit only to the points where this holds, e.g. 'curve%2==0'.")
@click.option(
    "--anchor",
    is_flag=True,
    help="Keep the measured outputs at both ends of the range, as the thesis does (default: fit them).",
)
@click.option(
    "--symmetric",
    is_flag=True,
    help="Require the positive surface to equal its mirror image (u, y) → (−u, −y).",
)
@click.option(
    "--extension",
    type=click.Choice(extension_names()),
    default="none",
    show_default=True,
    help="Extended model (thesis §3.5) on top of the surface; best: chosen by cross-validation over the runs.",
)
@click.option(
    "--load-from",
    metavar="CONDITION",
    help="Model several loads: the condition of the runs that states the load, 'stress'.",
)
@click.option(
    "--slopes",
    type=click.FloatRange(0.0),
    default=0.0,
    show_default=True,
    metavar="WEIGHT",
    help="Also fit the slopes along the curves (thesis §9.2), with this weight; the outputs have 1.",
)
@click.option(
    "--reference",
    metavar="MODEL",
    type=FILE,
    help="A model of the same wire, from which a run of continuous sweeps also determines R/hA.",
)
@click.option("-o", "--out", type=FILE, required=True, help="Model file (*.model.json).")
@click.option("--force", is_flag=True, help="Replace an existing model file.")
@json_option
def command(
    runs: tuple[Path, ...],
    surface: str,
    select: str | None,
    anchor: bool,
    symmetric: bool,
    extension: str,
    load_from: str | None,
    slopes: float,
    reference: Path | None,
    out: Path,
    force: bool,
) -> None:
    """Identify a Preisach model from runs with first-order curves or, with --surface positive, from any runs."""
    from smarig.identification import ErrorLevel, identify
    from smarig.record import is_recording

    check_distinct(out, reference, *runs)
    check_writable(out, force=force, kind=MODEL)
    recorded_now = [  # asked before the runs are read: one may end meanwhile
        f"{run} is being recorded. The model describes only the rows so far."
        for run in runs
        if is_recording(run)
    ]
    result = identify(
        runs,
        surface=surface,
        select=select,
        anchor=anchor,
        symmetric=symmetric,
        extension=extension,
        load_from=load_from,
        slopes=slopes,
        reference=reference,
    )
    result.model.save(out, force=force)
    for warning in (*result.warnings, *recorded_now):
        show_message(f"Warning: {warning}")
    if result.crossing_note:
        show_message(result.crossing_note)
    if result.fit_verdict.level == ErrorLevel.POOR:
        formless = " Or try --surface positive, a measure without a prescribed form."
        other = "" if surface == "positive" else formless
        show_message(
            f"Warning: The fit is poor, {result.fit_verdict.size}. The data do not follow this "
            f"model, or something else acts on them: smarig diagnose {out} --train RUN seeks the cause, in runs with "
            f"settled steps or a measured input.{other}"
        )
    found = {**result.to_json(), "model": str(out)}
    extended = [result.extension.text] if result.extension else []
    loads = [result.load.text] if result.load else []
    heating = [result.heating.text] if result.heating else []
    rows = [rows.text for rows in result.rows]
    verdict = f"Fit: {result.fit_verdict.text}"
    emit(found, "\n".join([result.text, verdict, *extended, *loads, *heating, *rows, f"Model: {out}"]))
