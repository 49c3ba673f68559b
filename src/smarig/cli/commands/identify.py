"""``smarig identify``: identify a model, or the constants of the material, from runs."""

from pathlib import Path
from typing import Any

import click

from smarig.cli.output import check_distinct, emit, json_option, show_message
from smarig.cli.parameter_types import FILE, CatalogueName, SurfaceKind
from smarig.core import MODEL, PAGE, TOML, UsageError, check_writable
from smarig.identification import BEST_KIND, extension_names, surface_choices

EPILOG = """\b
Examples:
  smarig identify fod.run.sqlite --surface exponential -o wire.model.json
  smarig identify sweeps.run.sqlite -o wire.model.json
  smarig identify fod.run.sqlite loops.run.sqlite --surface positive -o wire.model.json
  smarig identify fod.run.sqlite loops.run.sqlite --surface exponential --extension best -o wire.model.json
  smarig identify 50_MPa.run.sqlite 150_MPa.run.sqlite --load-from stress -o wire.model.json
  smarig identify forc.run.sqlite --surface table --select 'curve%2==0' -o half.model.json
  smarig identify 50_MPa.run.sqlite 150_MPa.run.sqlite loop_80_degC.run.sqlite --material --actuator flexinol_015 \\
    -o wire.toml --page wire.html
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
@click.option(
    "--material",
    is_flag=True,
    help="Constants of the material (E_A, E_M, ε_L, C_A, C_M, A_s to M_f) from isobaric and isothermal loops.",
)
@click.option(
    "--actuator",
    type=CatalogueName("actuators"),
    help="With --material: what the loops do not determine, and the size of the wire (default: that of the runs).",
)
@click.option(
    "--page", type=FILE, help="With --material: page to write (*.html), with the loops and the model."
)
@click.option(
    "-o", "--out", type=FILE, help="Model file (*.model.json); with --material an actuator file (*.toml)."
)
@click.option("--force", is_flag=True, help="Replace existing files.")
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
    material: bool,
    actuator: str | None,
    page: Path | None,
    out: Path | None,
    force: bool,
) -> None:
    """Identify a Preisach model from runs with first-order curves or, with --surface positive, from any runs. With
    --material, fit a constitutive model to loops over temperature under several loads, and over stress at several
    temperatures."""
    if material:
        settings = (select, anchor or None, symmetric or None, load_from, slopes or None, reference)
        if any(s is not None for s in settings) or extension != "none" or surface != BEST_KIND:
            raise UsageError(
                "--material fits a constitutive model, without a surface. Give it only --actuator, --page, -o."
            )
        _identify_material(runs, actuator, page, out, force=force)
        return
    if actuator is not None or page is not None:
        raise UsageError(
            f"--{'page' if actuator is None else 'actuator'} serves --material only. Leave it out."
        )
    if out is None:
        raise UsageError("Name the model file with -o.")
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


def _identify_material(
    runs: tuple[Path, ...], actuator: str | None, page: Path | None, out: Path | None, *, force: bool
) -> None:
    """Print the material, and write the actuator file and the page."""
    from smarig.identification import identify_material
    from smarig.plant import Actuator

    check_distinct(out, page, *runs)
    for path, kind in ((page, PAGE), (out, TOML)):
        if path is not None:
            check_writable(path, force=force, kind=kind)
    base = Actuator.named(actuator) if actuator else None
    found = identify_material(list(runs), base, progress=show_message)
    result: dict[str, Any] = {**found.to_json(), "actuator": None, "report": None}
    text = str(found)
    if page is not None:
        from smarig.report import material_page, write_page

        write_page(material_page(found), page, force=force)
        result["report"] = str(page)
        text += f"\nReport: {page}"
    if out is not None:
        found.write_actuator(out, force=force)
        result["actuator"] = str(out)
        text += f"\nActuator: {out}"
    emit(result, text)
