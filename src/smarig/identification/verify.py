"""Verification: errors of a model at settled points of runs, simulated along the whole history of each run.

The encoder is relative, so model and run agree only up to its zero. The zero is known if the run has the zero of a
training run (of its session, or of its absolute sensor), or was zeroed at power-up in a named state. Otherwise one
additive offset is fitted, and the result reports it.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, UsageError, root_mean_square
from smarig.identification.assumed_starts import assumed_starts, assumed_starts_text
from smarig.identification.fod_data import first_order_points
from smarig.identification.identification_result import Identification
from smarig.identification.measured.load_dependence import expected_rms, is_far
from smarig.identification.measured.zero_by_load import fitted_zero_slope, zero_slope_of
from smarig.identification.noise_floor import NoiseFloor, noise_floor
from smarig.identification.point_selection import matches
from smarig.identification.rows_used import without_dropouts
from smarig.identification.run_zeros import has_own_zero, known_offset
from smarig.identification.verification import PredictionErrors, RunVerification, Verification
from smarig.measurement import input_noise_sd
from smarig.preisach import Preisach
from smarig.record import FORC_PROTOCOL, Run, Runs, continues_run, counted, loaded_runs
from smarig.replay import (
    Model,
    applied_inputs,
    check_output,
    driven_by_input,
    file_hash,
    foreign_conditions,
    load_model,
    missing_earlier_runs,
    out_of_range,
    simulate_runs,
    simulate_samples,
    stress_at_points,
    with_heating_of,
    with_wire_temperature,
)

Offset = Literal["auto", "known", "fitted"]
_NO_POINT_IN_LOOP = (
    "No point lies inside the loop, where the branches of the model are apart: the run tests the ends of the loop "
    "only. Verify with a run that has more levels, or reversal curves."
)


def verify(
    model: Model | Identification | str | Path,
    runs: Runs,
    select: str | None = None,
    *,
    offset: Offset = "auto",
) -> Verification:
    """Compute the errors of a model at the settled points of runs (or paths), each simulated along its whole history.

    ``model``: a model, the result of ``identify``, or the path of a model file.
    ``select`` counts only FOD points for which an expression on curve, alpha, beta holds; the whole history is
    still simulated. A run without settled points is part of the history only, if the model has effects. With ``offset``
    "known", a run with an unknown encoder zero is an error; "fitted" always fits an offset. Raises DataError if units
    differ or the memory of a run is never known.
    """
    if isinstance(model, Identification):
        model = model.model
    if not isinstance(model, Model):
        model = load_model(model)
    several = [_with_inputs(model, run) for run in loaded_runs(runs)]
    for run in several:
        check_output(model, run)
    selected = selected_points(several, select)
    predictions = simulate_runs(model, several)
    missing = missing_earlier_runs(model, several) if model.effects else []
    counted: list[RunVerification] = []
    before: RunVerification | None = None
    has_points = [bool(run.settled) or bool(np.isfinite(p).any()) for run, p in zip(several, predictions)]
    for k, (run, p, c) in enumerate(zip(several, predictions, selected)):
        # An initialisation is part of the history, without settled points.
        if not has_points[k] and any(has_points):
            before = None
            continue
        part = k > 0 and run.info.imported is not None and continues_run(several[k - 1], run)
        before = _verified(
            model=model,
            run=run,
            predicted=p,
            selected=c,
            select=select,
            offset=offset,
            missing=missing,
            before=before if part and not has_own_zero(run) else None,
        )
        counted.append(before)
    return Verification(model.name, model.unit, tuple(counted))


def _with_inputs(model: Model, run: Run) -> Run:
    """The run with the inputs that the model has: by its heating, or by its source of the wire's temperature."""
    found = counted(with_heating_of(model, without_dropouts(run)))
    if model.temperature is None or driven_by_input([found]):
        return found
    return with_wire_temperature(found, model.temperature)


def selected_points(runs: Sequence[Run], select: str | None) -> list[NDArray[np.bool_]]:
    """Masks of the points that count, per run; curves are numbered through all runs, as in ``identify``."""
    if select is None:
        return [np.ones(run.points()[0].size, dtype=bool) for run in runs]
    data = first_order_points(runs)
    hit = matches(select, {"curve": data.curve, "alpha": data.alpha, "beta": data.beta})
    masks = [np.zeros(run.points()[0].size, dtype=bool) for run in runs]
    for r, k in zip(data.run[hit], data.point[hit]):
        masks[r][k] = True
    if not any(mask.any() for mask in masks):
        raise UsageError(f"Selection '{select}' finds no point on the first-order curves of these runs.")
    return masks


def _verified(
    model: Model,
    run: Run,
    predicted: Array,
    selected: NDArray[np.bool_],
    select: str | None,
    offset: Offset,
    missing: Sequence[str],
    before: RunVerification | None,
) -> RunVerification:
    """The verification of one run; ``before`` is that of the part of the same record before it, with the same zero."""
    inputs, measured = run.points()
    counts = selected & np.isfinite(predicted)
    if not counts.any():
        raise DataError(
            f"{run.path}: no point can be predicted, because the memory at its start is unknown and it never "
            "saturates. Also give the run before it, or start runs in saturation."
        )
    predicted, by_load = _with_fitted_zero_slope(model, run, predicted, measured)
    shift, kind = _offset(model, run, (measured - predicted)[counts], offset)
    if before is not None and kind == "fitted" and offset != "fitted":
        shift, kind = before.offset, before.offset_kind
    outside = int(np.sum(out_of_range(model, applied_inputs(model, run)[counts])))
    early = 0 if run.info.protocol == FORC_PROTOCOL else int(np.sum(selected & ~counts))
    floor, is_training = noise_floor(run), _is_training(model, run)
    in_loop = _points_in_loop(model, run, counts, floor.known)
    return RunVerification(
        run=str(run.path),
        settled=_errors((predicted + shift - measured)[counts], measured, floor),
        transient=None if select is not None or by_load else _transient(model, run, shift),
        noise_floor=floor.known,
        offset=shift,
        offset_kind=kind,
        input=inputs,
        measured=measured,
        predicted=predicted + shift,
        counted=counts,
        is_training=is_training,
        in_loop=in_loop,
        warnings=(
            *([_NO_POINT_IN_LOOP] if in_loop == 0 else []),
            *_validity_warnings(model, run, is_training=is_training),
            *by_load,
            *_far_loads(model, run),
            *floor.warnings,
            *_warnings(model, early, outside, kind, missing, encoder=run.has("counts")),
            *(assumed_starts_text(assumed_starts(model, [run]), model.unit) if before is None else ()),
        ),
        expected=_expected(model, run),
        repeatability=floor.repeatability,
    )


def _points_in_loop(model: Model, run: Run, counts: NDArray[np.bool_], noise: float | None) -> int | None:
    """How many points lie where the branches of the major loop are apart by more than twice the noise of a reading."""
    if noise is None:
        return None
    u = applied_inputs(model, run)[counts]
    levels = np.unique(u := u[np.isfinite(u)])
    there_and_back = np.concatenate([levels, levels[::-1]])
    y = Preisach(model.hysteresis).simulate(there_and_back, "negative")
    apart = np.abs(y[: levels.size] - y[levels.size :][::-1])
    return int(np.sum(np.interp(u, levels, apart) > 2 * noise))


def _with_fitted_zero_slope(
    model: Model, run: Run, predicted: Array, measured: Array
) -> tuple[Array, list[str]]:
    """Predictions (k,) with a slope over the load that is fitted to the run itself, if its load changes and the model
    does not know the slope, and a sentence that says so.
    """
    stress_MPa = stress_at_points(run)
    if model.temperature is None or stress_MPa is None or zero_slope_of(model) is not None:
        return predicted, []
    slope, _ = fitted_zero_slope(stress_MPa, measured - predicted, model.unit)
    return predicted + slope.value * (stress_MPa - np.nanmean(stress_MPa)), [
        "The model was made from runs that were each zeroed under their own load, so it does not know how the position "
        f"changes with the load alone. A slope of {slope.value:.3g} {slope.unit} was fitted to this run. To identify "
        "it, add a run under a load that changes to those of identify."
    ]


def _expected(model: Model, run: Run) -> float | None:
    """The rms error to be expected from loads left out of the fit, if the model depends on a load."""
    load = model.fit.get("load")
    stored = run.info.conditions.get(load["condition"]) if isinstance(load, dict) else None
    if not isinstance(load, dict) or not isinstance(stored, dict):
        return None
    errors = [expected_rms(load, v) for v in _extremes(stored)]
    return max((e for e in errors if e is not None), default=None)


def _extremes(stored: dict[str, Any]) -> list[float]:
    """Mean, least and largest value of a condition of a run."""
    values = [stored.get(k) for k in ("mean", "min", "max")]
    return [float(v) for v in values if isinstance(v, int | float) and np.isfinite(v)]


def _far_loads(model: Model, run: Run) -> list[str]:
    """A sentence for a load of which the runs of the model tell nothing."""
    load = model.fit.get("load")
    stored = run.info.conditions.get(load["condition"]) if isinstance(load, dict) else None
    if not isinstance(load, dict) or not isinstance(stored, dict):
        return []
    if not any(is_far(load["values"], v) for v in _extremes(stored)):
        return []
    return [
        f"The {load['condition']} of the run lies farther outside that of the model's runs than these lie apart. What "
        "error is to be expected there is not known."
    ]


def _errors(error: Array, measured: Array, floor: NoiseFloor) -> PredictionErrors:
    rms, span = root_mean_square(error), float(np.ptp(measured))
    share = rms / span if span and not floor.explains(measured) else float("nan")
    return PredictionErrors(error.size, rms, share, float(np.abs(error).max()))


def _transient(model: Model, run: Run, shift: float) -> PredictionErrors | None:
    """Errors of every sample along the run's input column, or None if the input is known at the points only."""
    if not (run.settled and run.has("input") and run.has("position")):
        return None
    error = simulate_samples(model, run) + shift - run["position"]
    known, read = np.isfinite(error), run["position"][np.isfinite(run["position"])]
    noise = input_noise_sd(read) if read.size > 2 else None  # from second differences
    floor = NoiseFloor(noise, read.size, run.unit, "readings")
    return _errors(error[known], read, floor) if known.any() else None


def _offset(model: Model, run: Run, difference: Array, offset: Offset) -> tuple[float, str]:
    known = None if offset == "fitted" else known_offset(model, run)
    if known is not None:
        return known, "known"
    if offset == "known":
        raise DataError(f"{run.path} does not state where its output is zero. Use a fitted offset.")
    return float(difference.mean()), "fitted"


def _is_training(model: Model, run: Run) -> bool:
    """Whether the model was fitted to this run."""
    mine = file_hash(run)
    return bool(mine) and mine in {p.sha256 for p in model.provenance}


def _validity_warnings(model: Model, run: Run, *, is_training: bool) -> list[str]:
    """Warnings about runs of another wire, training runs and incomplete runs."""
    found = []
    wires = {p.wire for p in model.provenance if p.wire}
    wire = run.info.wire
    if wire and wires and wire not in wires:
        found.append(f"The run is of wire '{wire}', but the model is of {', '.join(sorted(wires))}.")
    if is_training:
        found.append(
            "The model was fitted to this run. The errors show how well it fits, not how well it predicts."
        )
    found += foreign_conditions(model, run)
    if run.early_end:
        found.append(f"The run is incomplete: {run.early_end}.")
    return found


def _warnings(
    model: Model, unknown: int, outside: int, kind: str, missing: Sequence[str], *, encoder: bool
) -> tuple[str, ...]:
    found = []
    if unknown:
        found.append(f"{unknown} points come before the memory is known and do not count.")
    if outside:
        h = model.hysteresis
        found.append(
            f"{outside} points lie outside the model's range [{h.lower:g}, {h.upper:g}] {model.input.unit}. "
            "The model saturates there."
        )
    if missing:
        found.append(
            f"The effects of the model depend on earlier runs of the session, but {', '.join(missing)} is neither "
            "given nor found at its path. The errors may be meaningless. Give all runs of the session."
        )
    if kind == "fitted":
        zero = "The encoder's zero" if encoder else "The zero of the output"
        found.append(f"{zero} is not known for this run, so one additive offset was fitted.")
    return tuple(found)
