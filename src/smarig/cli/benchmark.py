"""``smarig benchmark``: measured ratios, by the names of the modules in ``smarig.benchmark``."""

import importlib
import json
from collections.abc import Callable
from typing import Any

import click

from smarig.catalogue import names, suggestion
from smarig.cli._output import emit, json_option
from smarig.errors import UsageError

EPILOG = """\b
Examples:
  smarig benchmark forward --json
  smarig benchmark inverse --quick
"""


def _run_of(name: str) -> Callable[..., dict[str, Any]] | None:
    return getattr(importlib.import_module(f"smarig.benchmark.{name}"), "run", None)


@click.command("benchmark", epilog=EPILOG)
@click.argument("name")
@click.option("--quick", is_flag=True, help="Fewer samples: seconds instead of a minute.")
@json_option
def command(name: str, quick: bool) -> None:
    """Measure speed, memory and exactness as ratios in one run; NAME is forward, inverse, …"""
    known = names("smarig.benchmark")
    run = _run_of(name) if name in known else None
    if run is None:
        benchmarks = [n for n in known if _run_of(n) is not None]
        raise UsageError(f"No benchmark '{name}'{suggestion(name, benchmarks)}.")
    found = run(quick=quick)
    emit(found, json.dumps(found, indent=2))
