"""Why a model misses data: what differs between fitted and held-out data, in physical words."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from smarig.core import spaced
from smarig.exchange import dimension
from smarig.identification import RunVerification, opposite_senses
from smarig.measurement import first_branch_differs, reversals
from smarig.record import FindingKind, Run
from smarig.replay import same_condition
from smarig.study.candidate_models import CandidateModel
from smarig.study.data_split import LOAD, DataSplit
from smarig.study.imported_runs import ImportedTable
from smarig.study.input_turns import wide_turns
from smarig.study.runs_by_condition import differing, numeric_conditions

_FALSE: tuple[FindingKind, ...] = (
    "clipped output",
    "disagreeing sensors",
    "impossible readings",
    "frozen readings",
)
_MENDED: tuple[FindingKind, ...] = (*_FALSE, "restarted clock", "other starting state")
_BEYOND_SHARE = 0.05  # of the fitted range: inputs further outside are new to the model
_FITS_SHARE = 0.03  # of the output's range: a fit that misses by less describes its own data
_LOADS_NEEDED = 3
_BACK_SHARE = 0.08  # of the output's range
_WIDE_BRANCH = 0.5  # of the input's range
_MAGNETIC = ("magnetic moment", "specific moment", "magnetic field")
_FEWEST_ROWS, _PARTS = 60, 20  # of a branch
_FEW_READINGS = 100  # a model passes through so few, whatever the specimen does


def error_reasons(split: DataSplit, best: CandidateModel, *, undetermined: bool = False) -> list[str]:
    """Sentences on what the data say about the error of a model, the most certain first; empty if nothing stands out.

    They compare facts of the fitted and the held-out data (conditions, range of the input, errors) and name no effect:
    that is the diagnosis. ``undetermined``: the error is missing knowledge, so nothing need have changed.
    """
    if one_way(best):
        return [
            "The input goes one way only: the data hold no loop, and the model knows nothing of the way back. Record "
            "both ways."
        ]
    back = [*_turned_back(best)]
    found = [*_senses(split), *_conditions(split), *_range(best), *back, *_repeats(best)]
    if back and _misses_fitted(best):  # what goes back is missed, whatever else is right
        return found
    return [*found, *_fit(split, best, explained=bool(found), undetermined=undetermined)]


def one_way(best: CandidateModel) -> bool:
    """Whether the input of all runs goes one way only, so that they hold no loop."""
    ways = set()
    for run in (*best.train, *best.held_out):
        u = run.input[np.isfinite(run.input)]
        ways |= set(np.sign(np.diff(u[wide_turns(u)]))) - {0.0} if u.size > 1 else set()
    return len(ways) == 1


def wrong_direction(tables: Sequence[ImportedTable]) -> Iterator[str]:
    """A sentence on loops in which the output leads its input, which no hysteresis does."""
    found = _of_kind(tables, "leading output")
    if found:
        many = f" In {len(found)} of {len(tables)} runs." if len(tables) > 1 else ""
        yield f"{found[0]}{many}"


def noisy_input(tables: Sequence[ImportedTable]) -> Iterator[str]:
    """The first sentence of the import on an input whose noise a model takes for reversals."""
    yield from _of_kind(tables, "noisy input")[:1]


def false_readings(tables: Sequence[ImportedTable]) -> Iterator[str]:
    """Which readings are clipped, and which the import masked: the first sentence of each kind."""
    yield from _first_of(tables, _FALSE)


def mended(tables: Sequence[ImportedTable]) -> Iterator[str]:
    """What is wrong with readings of the tables, and what the import mended: the first sentence of each kind."""
    yield from _first_of(tables, _MENDED)


def _first_of(tables: Sequence[ImportedTable], kinds: Sequence[FindingKind]) -> Iterator[str]:
    for kind in kinds:
        found = _of_kind(tables, kind)
        more = " More findings of this kind are on the page." if len(found) > 1 else ""
        yield from (f"{text}{more}" for text in found[:1])


def _of_kind(tables: Sequence[ImportedTable], kind: FindingKind) -> list[str]:
    return [f.text for t in tables for f in t.findings if f.kind == kind]


def _senses(split: DataSplit) -> Iterator[str]:
    """That the output follows the input in opposite senses, which one positive measure gives in no run."""
    if opposite := opposite_senses(() if split.select else (*split.train, *split.held_out)):
        yield f"{opposite[0].upper()}{opposite[1:]}: no model with one positive measure does both. Fit them separately."


def _conditions(split: DataSplit) -> Iterator[str]:
    """Conditions of the held-out runs that no fitted run had."""
    if split.kind not in ("run", "load"):
        return
    fitted, held = (_by_condition(runs) for runs in (split.train, split.held_out))
    for name, values in held.items():
        known = fitted.get(name, {})
        new = [
            v for v, unit in values.items() if known and not any(same_condition(v, k, unit) for k in known)
        ]
        if not new:
            continue
        unit = spaced(next(iter(values.values())))
        which = f"{_listed(new)}{unit} in the held-out data, {_listed(list(known))}{unit} in the fitted data"
        if name == LOAD and len(known) < _LOADS_NEEDED - 1:
            yield (
                f"The stress differs: {which}. It moves the transformation temperatures and changes the stroke; a "
                f"model of one load cannot know by how much. Give runs at {_LOADS_NEEDED} or more loads."
            )
        elif name == "load" and LOAD not in held:
            yield (
                f"The load differs: {which}. One model of all loads needs their stress: divide the load by the cross "
                "section of the wire, and write it as stress under [conditions] of each mapping."
            )
        elif name == "frequency":
            yield f"The frequency differs: {which}. A model without rates predicts one loop for all frequencies."
        elif name != LOAD:
            yield f"The {name.replace('_', ' ')} differs: {which}."


def _by_condition(runs: Sequence[Run]) -> dict[str, dict[float, str]]:
    """The values of numeric conditions with their units, by name, of conditions that all runs state."""
    each = [numeric_conditions(run) for run in runs]
    names = set.intersection(*(set(e) for e in each)) if each else set()
    return {name: {e[name][0]: e[name][1] for e in each} for name in sorted(names)}


def _range(best: CandidateModel) -> Iterator[str]:
    """Held-out inputs beyond those of the fit."""
    if not best.train:
        return
    low, high = _extent(best.train)
    below, above = _extent(best.held_out)
    margin = _BEYOND_SHARE * (high - low)
    if below < low - margin or above > high + margin:
        yield (
            f"The held-out input goes from {below:.4g} to {above:.4g}, the fitted one only from {low:.4g} to "
            f"{high:.4g}: what switches beyond is not in the model."
        )


def _extent(runs: Sequence[RunVerification]) -> tuple[float, float]:
    u = np.concatenate([r.input for r in runs])
    return float(np.nanmin(u)), float(np.nanmax(u))


def _turned_back(best: CandidateModel) -> Iterator[str]:
    """An output that moves both ways while the input moves one way, which no positive measure gives by itself."""
    if best.proportional_slope is not None:
        return
    runs = (*best.train, *best.held_out)
    span = (
        float(np.ptp(np.concatenate([r.measured for r in runs]))) if runs else 0.0
    )  # a small loop of a family is small
    most = max((_back(r, span) for r in runs), default=0.0)
    if most > _BACK_SHARE:
        yield (
            f"While the input goes one way, the output goes back by {100 * most:.2g} % of its range. No hysteresis "
            f"with a positive measure does this. {_would_go_back(best)} would."
        )


def _would_go_back(best: CandidateModel) -> str:
    """What makes an output go back, by what drives it."""
    model = best.model
    if dimension(model.output.unit) == "resistance":  # it has no grips, and its own dependence on temperature
        return "The temperature coefficient of resistance, an R-phase, or a sensor that lags"
    if dimension(model.output.unit) in _MAGNETIC and dimension(model.input.unit) == "temperature":
        return (
            "A background or a moment that changes with the temperature in each phase, or a sensor that lags"
        )
    if dimension(model.output.unit) in _MAGNETIC:
        return "A background that falls with the field, as of a diamagnetic holder, or a sensor that lags"
    if model.input.quantity == "temperature":
        return "Thermal expansion, an R-phase, slip in the grips, or a sensor that lags"
    return "A part of the output that falls with the input, slip, or a sensor that lags"


def differing_conditions(runs: Sequence[Run]) -> tuple[str, ...]:
    """The conditions in which runs differ, with their values: "load (0.05, 0.1 kN)"."""
    every = _by_condition(runs)
    return tuple(
        f"{name.replace('_', ' ')} ({_listed(list(every[name]))}{spaced(next(iter(every[name].values())))})"
        for name in differing(runs)
    )


def _without_conditions(best: CandidateModel) -> str:
    """What makes an output depend on more than the history of the input, by what is measured."""
    would = "A sensor that lags, a rate, creep, or a variable that is not used"
    if dimension(best.model.output.unit) in _MAGNETIC:
        would = "Magnetic viscosity, a drift, another temperature, or a variable that is not used"
    return f"the output does not follow from the history of this input alone. {would} would do this."


def _back(run: RunVerification, span: float) -> float:
    """The largest travel of the output against its net direction on a wide branch, as a share of ``span``."""
    known = np.isfinite(run.input) & np.isfinite(run.measured)
    u, y = run.input[known], run.measured[known]
    if u.size < _FEWEST_ROWS or not np.ptp(y):
        return 0.0
    most, turns = 0.0, reversals(u)
    if first_branch_differs(u, y, turns):  # it began in another state
        turns = turns[1:]
    for a, b in pairwise(turns):
        if abs(u[b] - u[a]) < _WIDE_BRANCH * np.ptp(u) or b - a < _FEWEST_ROWS:
            continue
        bins = np.array([np.median(part) for part in np.array_split(y[a : b + 1], _PARTS)])  # free of noise
        way = np.sign(bins[-1] - bins[0])
        most = max(most, float(np.max(np.maximum.accumulate(way * bins) - way * bins)))
    return most / span


def _repeats(best: CandidateModel) -> Iterator[str]:
    """Repeats of one state that differ by more than noise."""
    texts = dict.fromkeys(run.repeatability.text for run in (*best.train, *best.held_out))
    yield from (f"The {text}: something besides the input acts on the output." for text in texts if text)


def _fit(split: DataSplit, best: CandidateModel, *, explained: bool, undetermined: bool) -> Iterator[str]:
    """Whether the model misses its own data already, or only those that it has not seen."""
    share = _share_of_range(best)
    if share is None:
        return
    if _misses_fitted(best):
        misses = f"The model misses the fitted data as well, by {100 * share:.2g} % of their range:"
        differ = " and ".join(differing_conditions(split.train))
        one_model = f"one model of runs that differ in {differ}. Fit them separately."
        yield f"{misses} {one_model if differ else _without_conditions(best)}"
    elif split.kind in ("run", "time") and best.misses_held_out and not explained:
        if (n := sum(r.settled.n for r in best.train)) < _FEW_READINGS:
            yield (
                f"Only {n} readings could be fitted, and the model passes through them: this says nothing of branches "
                "that they do not contain. Give a full loop in one file, or --split none for a model of all data."
            )
            return
        if undetermined:
            return
        later = "later in the run" if split.kind == "time" else "in the other run"
        yield (
            f"The model fits its own data to {100 * share:.2g} % of their range and misses what came {later}: "
            "either the specimen or the set-up changed (training, a shifted zero, another temperature reading), or the "
            "specimen is no Preisach operator and a free density follows only what it has seen. The diagnosis predicts "
            "excursions that were left out: if it misses those as well, nothing need have changed."
        )


def _share_of_range(best: CandidateModel) -> float | None:
    """The error on the fitted data over the range of their output; None for an output that never moves."""
    y = np.concatenate([r.measured[r.counted] for r in best.train])
    return best.train_rms / float(np.ptp(y)) if y.size and np.ptp(y) else None


def _misses_fitted(best: CandidateModel) -> bool:
    """Whether the model misses its own data."""
    return (_share_of_range(best) or 0.0) > _FITS_SHARE


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{float(f'{v:.3g}'):g}" for v in sorted(values))
