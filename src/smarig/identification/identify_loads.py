"""Identification of one model from runs under several loads."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.core import DataError, UsageError, spaced
from smarig.identification.density_report import density_report
from smarig.identification.extended.extension_names import NONE
from smarig.identification.fod_data import first_order_points
from smarig.identification.identification_result import Identification, model_of_runs
from smarig.identification.measured.load_dependence import LoadDependence, fit_load_dependence
from smarig.identification.measured.reading_plan import reading_plan
from smarig.identification.measured.zero_by_load import zero_slope
from smarig.identification.rows_used import THINNED, rows_used
from smarig.identification.surface.curve_report import curve_report, motion_within_a_tick
from smarig.identification.surface.fit_figures import error_figures
from smarig.identification.surface.surface_kinds import BEST_KIND, POSITIVE_KIND
from smarig.measurement import InputRecord
from smarig.preisach import FodTable
from smarig.record import Run
from smarig.replay import (
    TemperatureSource,
    driven_by_input,
    load_records,
    stress_of_samples,
    temperature_source,
    with_wire_temperature,
)


def check_load_settings(
    surface: str, select: str | None, anchor: bool, symmetric: bool, extension: str
) -> None:
    """Raise UsageError for settings that need another identification than that of several loads."""
    if surface not in (POSITIVE_KIND, BEST_KIND):
        raise UsageError(
            f"Several loads are identified with the {POSITIVE_KIND} surface, not with '{surface}'."
        )
    if select is not None or anchor or symmetric or extension != NONE:
        raise UsageError(
            "Several loads are identified from all rows by a plain measure. Leave out the selection, the anchor, the "
            "symmetry and the extension."
        )


def identify_loads(runs: Sequence[Run], condition: str) -> Identification:
    """Identify one model of runs with a measured input under several values of a condition.

    Raises DataError for other runs, or if they do not state several values of it.
    """
    everything, changing = runs, [run for run in runs if stress_of_samples(run) is not None]
    runs = [run for run in runs if run not in changing]
    if not runs:
        raise DataError("The load changes in all of these runs. Give runs under several constant loads, too.")
    source, records = _records(runs)
    data = first_order_points(runs)
    found = fit_load_dependence(records, condition)
    table = found.hysteresis
    falls = table.values[-1, -1] < table.y_lower
    density = density_report(FodTable(table.nodes, -table.values, table.unit) if falls else table)
    curves = curve_report(data, motion_within_a_tick(runs, data))
    figures = error_figures(found.error, np.zeros(found.error.size, dtype=bool), 1.0)
    model = model_of_runs(
        f"by {condition}",
        everything,
        runs,
        _warnings(found),
        varied={condition},
        hysteresis=table,
        mirrored=False,
        fit={**figures, "points": found.error.size, "select": None, "load": found.to_json()},
        measurement={**found.part.to_json(), **({"temperature": source} if source else {})},
    )
    if changing:
        reference_MPa = next(e for e in found.part.effects if e.kind.by_condition).values["reference"]
        found = found.with_zero_slope(zero_slope(model, changing, reference_MPa))
        model = replace(
            model,
            measurement={**model.measurement, **found.part.to_json()},
            fit={**model.fit, "load": found.to_json()},
        )
    plan = reading_plan(records)
    return Identification(
        model=model,
        surface=POSITIVE_KIND,
        data=data,
        fit=None,
        density=density,
        curves=curves,
        choice=None,
        rows=rows_used(
            runs,
            [len(r) - start.first for r, start in zip(records, plan.starts)],
            [r.size for r in plan.rows],
            THINNED,
        ),
        load=found,
    )


def _records(runs: Sequence[Run]) -> tuple[TemperatureSource | None, list[InputRecord]]:
    """The records of runs, and the source of the temperature in those of a rig."""
    measured = [driven_by_input([run]) for run in runs]
    if any(measured) and not all(measured):
        raise DataError(
            "Some of the runs have a heating current or settled steps, others only a measured input. Loads are "
            "identified from runs of one kind."
        )
    source = None if all(measured) else temperature_source(runs)
    for run in runs:
        if source and not run.settled:
            raise DataError(f"{run.path} has no settled points. Loads are identified from settled points.")
    records = load_records([with_wire_temperature(run, source) for run in runs] if source else runs)
    if len(records) < len(runs):
        raise DataError("A run contains no row in which input and output are known. Leave it out.")
    return source, records


def _warnings(found: LoadDependence) -> list[str]:
    if not found.at_bound:
        return []
    return [
        f"{found.parameter} = {found.value:.3g}{spaced(found.unit)} is at the end of its search, so these loads do not "
        "determine it."
    ]
