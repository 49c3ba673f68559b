"""Identification of a model from runs (§5.4, §5.6): chooses what to fit, and joins the results into a model.

Surfaces and tables use first-order curves. A positive measure uses every point with a known memory, from any
protocol.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.core import DataError, UsageError, suggestion
from smarig.identification.assumed_starts import assumed_starts, assumed_starts_text
from smarig.identification.extended.choose_extension import choose_extension
from smarig.identification.extended.extension_names import NONE, extension_names
from smarig.identification.fitted_hysteresis import (
    FittedHysteresis,
    check_usable,
    fitted_positive,
    fitted_surface,
)
from smarig.identification.fod_data import FodData, first_order_points, fod_data
from smarig.identification.fod_data import select as selected
from smarig.identification.identification_result import Identification, model_of_runs
from smarig.identification.identify_loads import check_load_settings, identify_loads
from smarig.identification.positive.positive_fit import PositiveFit
from smarig.identification.rows_used import rows_of_runs, without_dropouts
from smarig.identification.run_zeros import (
    DISAGREE,
    disagreement_text,
    zeros_disagree,
)
from smarig.identification.surface.choose_surface import (
    choose_surface,
)
from smarig.identification.surface.curve_report import curve_report, motion_within_a_tick, twin_crossing_note
from smarig.identification.surface.surface_fit import ROOT_WEIGHT, MajorLoopWeighting, fit_surface
from smarig.identification.surface.surface_kinds import BEST_KIND, POSITIVE_KIND, surface_kinds
from smarig.identification.sweeps.heating_of_sweeps import (
    heating_of_sweeps,
    with_fitted_inputs,
)
from smarig.preisach import Everett, Mirrored, surface_forms
from smarig.record import OWN_ZERO, Run, Runs, counted, loaded_runs
from smarig.replay import (
    Model,
    file_hash,
    load_model,
)

STILL_COUNTS = 3.0  # a sensor that stands still scatters over two
LARGEST_SLOPE_WEIGHT = 1000.0
FOR_ARRAYS = "For rows of inputs and outputs, call smarig.fit(u, y)."


@threadpool_limits.wrap(limits=1, user_api="blas")  # narrow bands: threads would wait for each other
def identify(
    runs: Runs,
    surface: str = BEST_KIND,
    *,
    select: str | None = None,
    anchor: bool = False,
    weights: MajorLoopWeighting = "residual",
    symmetric: bool = False,
    extension: str = NONE,
    load_from: str | None = None,
    slopes: float = 0.0,
    reference: Model | str | Path | None = None,
) -> Identification:
    """Identify a Preisach model from runs (or paths) of any protocol.

    ``surface`` is a form of (5.5), or a "table" without a fit, both from first-order curves; a "positive" measure
    from all points with a known memory (for reversal curves and selections: their points); or the "best" by
    held-out curves. ``select`` keeps the points for which an expression on curve, alpha, beta holds. ``anchor`` and
    ``weights`` are as in ``fit_surface``, and so is ``slopes``, the weight of slopes (§9.2), for a named form of (5.5).
    ``symmetric``: the positive measure is its own image under (u, y) → (−u,
    −y), like that of a magnet. Surfaces and tables of ascending curves, and all models of magnetic reversal curves,
    are fitted in that mirror. ``extension`` adds one of the extended models of §3.5, or the "best" of them on runs
    left out; the model then predicts with it. ``load_from`` names a condition of the runs, "stress": one positive
    measure, shifted by it, for all loads. Runs of continuous sweeps also give the time constant of the heating, with
    which their inputs are computed; ``reference``, a model of the same wire (or its path), gives its R/hA too. Raises
    UsageError for unknown names, and DataError if the runs contain too little.
    """
    if not isinstance(surface, str):
        raise UsageError(f"surface is the name of a kind, got {type(surface).__name__}. {FOR_ARRAYS}")
    _check_words(surface, weights, symmetric, slopes)
    if extension not in extension_names():
        raise UsageError(
            f"There is no extension '{extension}'{suggestion(extension, list(extension_names()))}."
        )
    given = _loaded(runs)
    loaded = [without_dropouts(run) for run in given]
    if load_from is not None:
        check_load_settings(surface, select, anchor, symmetric, extension)
        return identify_loads(given, load_from)
    heating = heating_of_sweeps(loaded, _known_hysteresis(reference))
    if heating is not None:
        loaded = with_fitted_inputs(loaded, heating)
    loaded = [counted(run) for run in loaded]
    _check_motion(loaded)
    everything = _first_order_curves(loaded, surface)
    data = everything if select is None else selected(everything, select)
    choice = choose_surface(data, anchor=anchor, weights=weights) if surface == BEST_KIND else None
    kind = choice.kind if choice else surface
    if kind == POSITIVE_KIND:
        found = fitted_positive(loaded, data, select, weights, symmetric)
    else:
        fit = choice.fit if choice and choice.fit and choice.fit.points == len(data) else None
        if kind in surface_forms() and fit is None:
            fit = fit_surface(data, kind, anchor=anchor, weights=weights, slopes=slopes)
        found = fitted_surface(loaded, data, fit, select, weights)
    # from all points: a selection does not show the range
    curves = curve_report(everything, motion_within_a_tick(loaded, everything))
    warnings = (*curves.warnings, *found.warnings, *_unsettled_warning(loaded, data, found))
    model = _model(kind, found, given, loaded, warnings)
    model = heating.model(model) if heating else model
    remarks = assumed_starts_text(assumed_starts(model, loaded), model.unit)
    if found.positive and select is None and zeros_disagree(model, loaded):
        remarks += _zeros_remark(loaded, found.positive, symmetric)
    plain = Identification(
        model=replace(model, warnings=(*remarks, *model.warnings)),
        surface=kind,
        data=data,
        fit=found.fit,
        density=found.density,
        curves=curves,
        choice=choice,
        positive=found.positive,
        crossing_note=twin_crossing_note(loaded) if curves.cross else "",
        rows=rows_of_runs(loaded if heating else given, data, select, found.points),
        heating=heating,
    )
    if extension == NONE:
        return plain
    return _extended(plain, loaded, extension, anchor, weights, symmetric, slopes)


def _model(
    kind: str, found: FittedHysteresis, given: Sequence[Run], used: Sequence[Run], warnings: tuple[str, ...]
) -> Model:
    fit = found.fit
    return model_of_runs(
        kind,
        given,
        used,
        warnings,
        hysteresis=Mirrored(found.image) if found.mirrored else found.image,
        mirrored=found.mirrored,
        fit=found.figures,
        parameters=fit.names if fit else (),
        covariance=fit.covariance if fit else np.empty((0, 0)),
        intervals=fit.intervals if fit else {},
    )


def _known_hysteresis(reference: Model | str | Path | None) -> Everett | None:
    if reference is None:
        return None
    return (reference if isinstance(reference, Model) else load_model(reference)).hysteresis


def _zeros_remark(runs: Sequence[Run], common: PositiveFit, symmetric: bool) -> list[str]:
    """What a zero for each run would change, if it changes much."""
    try:
        apart = identify(
            [run.with_meta(encoder_zero=OWN_ZERO) for run in runs], POSITIVE_KIND, symmetric=symmetric
        )
    except DataError:  # no measure follows the runs with zeros of their own
        return []
    own = apart.model.fit["rms"]
    return [disagreement_text(common.rms, own, common.unit)] if own < DISAGREE * common.rms else []


def _extended(
    plain: Identification,
    runs: Sequence[Run],
    extension: str,
    anchor: bool,
    weights: MajorLoopWeighting,
    symmetric: bool,
    slopes: float,
) -> Identification:
    """The result with an extended model, evaluated on runs left out."""

    def refit(kept: Sequence[Run]) -> Everett:
        again = identify(
            kept, plain.surface, anchor=anchor, weights=weights, symmetric=symmetric, slopes=slopes
        )
        return again.model.hysteresis

    model = plain.model
    chosen = choose_extension(runs, model.hysteresis, model.unit, extension, refit)
    return replace(plain, model=replace(model, extension=chosen.values), extension=chosen)


def _check_motion(runs: Sequence[Run]) -> None:
    """Raise DataError if no run moves its sensor by more than rounding and noise do."""
    known = [y[np.isfinite(y)] for y in (run["position"] for run in runs)]
    travels = [float(np.ptp(y)) if y.size else np.inf for y in known]
    resolutions = [run.info.output.resolution for run in runs]
    counts = [travel / size if size else np.inf for travel, size in zip(travels, resolutions)]
    if max(counts, default=np.inf) < STILL_COUNTS:
        raise DataError(
            f"{', '.join(run.path.name for run in runs)}: the output moves by {max(travels):.2g} {runs[0].unit} only, "
            f"{max(counts):.1f} counts of its sensor. There is no motion to identify: heat the wire further."
        )


def _check_words(surface: str, weights: str, symmetric: bool, slopes: float) -> None:
    known = [*surface_kinds(), BEST_KIND]
    if surface not in known:
        raise UsageError(f"There is no surface '{surface}'{suggestion(surface, known)}.")
    if weights not in ROOT_WEIGHT:
        raise UsageError(f"Weights '{weights}' are not one of {', '.join(ROOT_WEIGHT)}.")
    if slopes > LARGEST_SLOPE_WEIGHT:
        raise UsageError(
            f"The weight of slopes {slopes:g} leaves no weight to the outputs. Give at most {LARGEST_SLOPE_WEIGHT:g}."
        )
    if slopes and surface not in surface_forms():
        raise UsageError(
            f"The weight of slopes applies to a fitted surface ({', '.join(surface_forms())}), not to '{surface}'."
        )
    if symmetric and surface != POSITIVE_KIND:
        raise UsageError(
            f"Mirror symmetry is available for the {POSITIVE_KIND} surface only, not for '{surface}'."
        )


def _loaded(runs: Runs) -> list[Run]:
    if isinstance(runs, np.ndarray):
        raise UsageError(f"identify takes runs, or the paths of their files. {FOR_ARRAYS}")
    loaded = loaded_runs(runs)
    if len({file_hash(run) or id(run) for run in loaded}) < len(loaded):
        raise UsageError("The same run was given twice, so its points would count twice. Name each run once.")
    return loaded


def _first_order_curves(runs: Sequence[Run], surface: str) -> FodData:
    """The first-order curves of the runs; DataError if a surface needs some and there are too few."""
    data = first_order_points(runs)
    if surface == POSITIVE_KIND:
        return data
    if data.curves < 2:
        try:
            fod_data(runs)
        except DataError as error:
            raise DataError(
                f"{error} Without such curves, only the {POSITIVE_KIND} surface (--surface {POSITIVE_KIND}) can be "
                "identified: it uses every point whose memory is known."
            ) from None
    check_usable(data.y, data.alpha, data.unit)
    return data


def _unsettled_warning(runs: Sequence[Run], data: FodData, found: FittedHysteresis) -> list[str]:
    """A warning with the number of points from steps that did not settle."""
    if found.positive and not (found.mirrored or found.figures["select"]):
        late = sum(step.verdict != "settled" for run in runs for step in run.settled)
    else:
        late = sum(
            runs[r].settled[k].verdict != "settled" for r, k in zip(data.run, data.point) if runs[r].settled
        )
    points = found.figures["points"]
    return [f"{late} of {points} points are from steps that did not settle in time."] if late else []
