"""The hysteresis of one kind fitted to the data of runs: a surface of (5.5), a table, or a positive measure.

Whether the output of runs rises with the input in some of them and falls in others, which no one measure gives.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from smarig.core import Array, DataError, correlation, spaced
from smarig.identification.density_report import DensityReport, density_report
from smarig.identification.fod_data import FodData, table
from smarig.identification.forc.forc_curves import curves_from_run
from smarig.identification.positive.observations import Observations
from smarig.identification.positive.positive_fit import PositiveFit, fit_positive
from smarig.identification.run_zeros import spread_about_zeros, with_own_zeros
from smarig.identification.surface.choose_surface import MOST_OBSERVATIONS, thinned, thinning_mask
from smarig.identification.surface.fit_figures import (
    positive_figures,
    positive_warnings,
    surface_figures,
    surface_warnings,
)
from smarig.identification.surface.surface_fit import MajorLoopWeighting, SurfaceFit
from smarig.identification.sweeps.heating_of_sweeps import sweep_nodes
from smarig.measurement import reversals
from smarig.preisach import FodSurface, FodTable, ForcTable
from smarig.record import FORC_PROTOCOL, Run

_LARGEST_VALUE = 1e30
_UNEXPLAINED_SHARE = 0.9  # of the output's standard deviation: a fit with larger residuals hardly follows it
_NO_HYSTERESIS = 1 - 1e-6  # share of the measure on the diagonal: hardly any hysteresis is left
_UNFOLLOWED_SHARE = 0.3  # of the output's standard deviation: a fit without hysteresis must leave less


@dataclass(frozen=True, eq=False)
class FittedHysteresis:
    """One fitted kind: ``image`` is the hysteresis, or its mirror image if ``mirrored``."""

    image: FodSurface | FodTable | ForcTable
    mirrored: bool
    figures: dict[str, Any]
    density: DensityReport
    warnings: list[str]
    fit: SurfaceFit | None = None
    positive: PositiveFit | None = None
    points: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())  # with a known memory, and used, per run


def fitted_surface(
    runs: Sequence[Run],
    data: FodData,
    fit: SurfaceFit | None,
    select: str | None,
    weights: MajorLoopWeighting,
) -> FittedHysteresis:
    """A fitted surface, or a table without a fit."""
    image = fit.surface if fit else _tabulated(runs, data, select)
    figures = surface_figures(image.y(data.alpha, data.beta) - data.y, data, fit, weights, select)
    density = density_report(image)
    return FittedHysteresis(
        image, data.mirrored, figures, density, surface_warnings(image, data, fit, density), fit
    )


def _tabulated(runs: Sequence[Run], data: FodData, select: str | None) -> FodTable | ForcTable:
    """A table of the data; whole reversal curves are used as cleaned by their reader."""
    if select is not None or any(run.info.protocol != FORC_PROTOCOL for run in runs):
        return table(data)
    return ForcTable.from_curves([c for run in runs for c in curves_from_run(run)], unit=data.unit)


def fitted_positive(
    runs: Sequence[Run], data: FodData, select: str | None, weights: MajorLoopWeighting, symmetric: bool
) -> FittedHysteresis:
    """A positive measure of the selected points on first-order curves, else of all points with a known memory.

    Only selected points can be mirrored: the memory is followed in the signs of the measurement.
    """
    points_alone = select is not None or any(run.info.protocol == FORC_PROTOCOL for run in runs)
    points: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())
    if points_alone:
        observations = Observations.of_fod(thinned(data, MOST_OBSERVATIONS))
    else:
        observations = with_own_zeros(Observations.of_runs(runs), runs)
        kept = thinning_mask(observations.curve, MOST_OBSERVATIONS)
        ends = np.cumsum(observations.known)[:-1]
        points = observations.known, tuple(int(part.sum()) for part in np.split(kept, ends))
        observations = observations.where(kept)
    check_usable(observations.y, observations.alpha, data.unit)
    inputs = np.concatenate([run.points()[0] for run in runs])
    if np.ptp(inputs) == 0:
        raise DataError(f"The input is {inputs[0]:g} at every point. The output is not driven.")
    nodes = sweep_nodes(runs) if not points_alone else None
    fit, table, warnings = fit_positive(observations, nodes=nodes, symmetric=symmetric), None, []
    spread = spread_about_zeros(observations)
    if fit.rms > _UNEXPLAINED_SHARE * spread:
        turned = replace(observations, y=-observations.y)
        negative = fit_positive(turned, nodes=nodes, symmetric=symmetric)
        if negative.rms < fit.rms:  # as of strain, which falls while a wire gets hot
            observations = turned
            fit, table = negative, FodTable(negative.table.nodes, -negative.table.values, negative.table.unit)
            warnings = [
                "The output falls while the input rises. The measure is that of its negative; the model predicts the "
                "output as recorded."
            ]
    if fit.rms > _UNEXPLAINED_SHARE * spread and largest_correlation(runs) < LEAST_CORRELATION:
        raise DataError(f"No positive measure fits this output, nor its negative: {_why_none(runs)}")
    if fit.rms > _UNEXPLAINED_SHARE * spread:
        warnings.append(
            f"The model leaves {100 * fit.rms / spread:.0f} % of the output's standard deviation unexplained. The "
            "output hardly follows the input through a Preisach model. Diagnose the runs."
        )
    _check_follows(fit, spread, runs)
    figures = positive_figures(fit, observations, data, weights, select)
    return FittedHysteresis(
        image=fit.table if table is None else table,
        mirrored=points_alone and data.mirrored,
        figures=figures,
        density=density_report(fit.table),
        warnings=[*warnings, *positive_warnings(fit)],
        positive=fit,
        points=points,
    )


def _why_none(runs: Sequence[Run]) -> str:
    """Why no positive measure fits an output that does not move with the input over a whole run."""
    if senses := senses_of_branches(runs):
        return f"{senses}. Something else than the input differs between them. Identify each in a run of its own."
    return "it does not move with the input. Check what was recorded as input and as output."


def _check_follows(fit: PositiveFit, spread: float, runs: Sequence[Run]) -> None:
    """Raise DataError if the best positive measure has no hysteresis and misses that of the output (sd ``spread``)."""
    if fit.reversible_share <= _NO_HYSTERESIS or fit.rms <= _UNFOLLOWED_SHARE * spread:
        return
    if opposite := opposite_senses(runs):
        raise DataError(f"No positive measure follows this output: {opposite}. Identify each by itself.")
    raise DataError(
        "No positive measure follows this output: the best one has no hysteresis and leaves "
        f"{100 * fit.rms / spread:.0f} % of the output's standard deviation unexplained, as if the output led its "
        "input. Exchange input and output in the mapping (the columns of input and position, and [input] with "
        "[output]), or identify a measure of any sign (--surface exponential or table)."
    )


def check_usable(y: Array, alpha: Array, unit: str) -> None:
    """Raise DataError if the output does not move or a value is implausible."""
    if not (
        np.isfinite(y).all() and np.abs(y).max() < _LARGEST_VALUE and np.abs(alpha).max() < _LARGEST_VALUE
    ):
        raise DataError("The runs contain values that are not finite or implausibly large.")
    if np.ptp(y) == 0:
        raise DataError(
            f"The output is {y[0]:g}{spaced(unit)} at every point. There is no motion to identify."
        )


LEAST_CORRELATION = 0.3  # of output and input: with a smaller one, the output does not follow its input


def largest_correlation(runs: Sequence[Run]) -> float:
    """The largest absolute correlation of inputs and outputs within a run."""
    return max((abs(_correlation(*run.points())) for run in runs), default=0.0)


def opposite_senses(runs: Sequence[Run]) -> str:
    """A clause that names the runs in which the output rises with the input and those in which it falls; "" if it does
    the same in all.
    """
    rises, falls = (
        [run.name for run in runs if sign * _correlation(*run.points()) > LEAST_CORRELATION]
        for sign in (1, -1)
    )
    if not rises or not falls:
        return ""
    return f"the output rises with the input in {', '.join(rises)} and falls in {', '.join(falls)}"


def senses_of_branches(runs: Sequence[Run]) -> str:
    """The same of the branches of a run, in which a variable that is not used may have changed."""
    for run in runs:
        u, y = run.points()
        found = [_correlation(u[a : b + 1], y[a : b + 1]) for a, b in pairwise(reversals(u))]
        if min(found) < -LEAST_CORRELATION and max(found) > LEAST_CORRELATION:
            return f"the output rises with the input on some branches of {run.name} and falls on others"
    return ""


def _correlation(u: Array, y: Array) -> float:
    moves = u.size > 2 and np.ptp(u) > 0 and np.ptp(y) > 0
    return correlation(u, y) if moves else 0.0
