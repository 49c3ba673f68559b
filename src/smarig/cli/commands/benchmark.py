"""``smarig benchmark``: run a module of ``benchmarks`` and print its results."""

import importlib
import json
import os
import tempfile
from collections.abc import Callable
from inspect import signature
from typing import Any

import click

from smarig.cli.output import emit, json_option
from smarig.cli.parameter_types import FILE
from smarig.core import UsageError, catalogue_names, make_importable, suggestion

EPILOG = """\b
Examples:
  smarig benchmark forward --json
  smarig benchmark inverse --quick
"""


def _run_of(name: str) -> Callable[..., dict[str, Any]] | None:
    return getattr(importlib.import_module(f"benchmarks.{name}"), "run", None)


@click.command(
    "benchmark", short_help="Measure speed, accuracy, and the success of the diagnosis.", epilog=EPILOG
)
@click.argument("name")
@click.option("--quick", is_flag=True, help="Fewer samples: seconds instead of a minute.")
@click.option("--boxes", type=int, help="diagnosis, mystery: number of boxes.")
@click.option("--runs", type=click.IntRange(min=1), help="library: number of runs.")
@click.option("--seed", type=int, help="diagnosis, mystery, critic, library, plausibility, comparison: seed.")
@click.option("--workers", type=int, help="diagnosis, mystery: number of processes.")
@click.option(
    "--left-out",
    is_flag=True,
    default=None,
    help="diagnosis: only boxes with an effect that is left out of the catalogue.",
)
@click.option(
    "--part", type=click.Choice(["public", "sealed"]), help="diagnosis: boxes of all worlds from this half."
)
@click.option("--dask", help="diagnosis: address of a Dask scheduler (extra 'scale').")
@click.option(
    "-o",
    "--out",
    type=FILE,
    help="diagnosis, comparison: file for the answers; an existing file is continued.",
)
@json_option
def command(name: str, quick: bool, **settings: Any) -> None:
    """Measure speed, memory and accuracy as ratios to a reference program, or the success rate of the diagnosis on
    sealed boxes (synthetic data sets with hidden effects).

    NAME: adaptive, comparison, console, critic, density, diagnosis, fast_curves, forward, identify, inverse, large,
    library, links, live, mystery, one_input, plausibility, real, regulation, self_sensing, soak, tracking,
    tracking_effects.
    """
    make_importable("benchmarks")
    modules = catalogue_names("benchmarks")
    run = _run_of(name) if name in modules else None
    if run is None:
        benchmarks = [n for n in modules if _run_of(n) is not None]
        raise UsageError(f"No benchmark '{name}'{suggestion(name, benchmarks)}.")
    chosen_settings = {key: value for key, value in settings.items() if value is not None}
    for key in chosen_settings:
        if key not in signature(run).parameters:
            raise UsageError(f"Benchmark '{name}' has no --{key.replace('_', '-')}.")
    with tempfile.TemporaryDirectory() as wires:
        os.environ.setdefault(
            "SMARIG_HISTORY_DIR", wires
        )  # keep the wires of benchmarks out of the user's histories
        found = run(quick=quick, **chosen_settings)
    emit(found, json.dumps(found, indent=2))
