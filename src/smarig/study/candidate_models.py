"""Identifies the models that the data allow and judges each on the held-out data."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from smarig.core import DataError, UsageError
from smarig.identification import (
    GOOD_RATIO,
    RunVerification,
    identify,
    noise_floor,
    verify,
    without_dropouts,
)
from smarig.measurement import output_noise_sd, rounding_sd
from smarig.record import load_run
from smarig.replay import Model
from smarig.study.baselines import BRANCHES, RunPoints, baseline_rms, baselines, points_of
from smarig.study.data_split import LOAD, DataSplit

_ONE_MODEL = "one model of all loads"
_POSITIVE = "positive measure"
SCATTER_OF_REPEATS, NOISE_OF_A_READING = "scatter of repeats", "noise of a reading"
WORSE = 2.0  # times the error of the fit: clearly worse
EXTENDED = "extended model of the diagnosis"
PROPORTIONAL_PART = "positive measure and a part proportional to the input"
_NOT_PLAIN = (_ONE_MODEL, EXTENDED, PROPORTIONAL_PART)
_SURFACES = {"table": "table of the curves", "exponential": "exponential surface"}


@dataclass(frozen=True, eq=False)
class CandidateModel:
    """A model with its errors on training and held-out runs (in-sample twice if nothing is held out)."""

    name: str
    model: Model
    warnings: tuple[str, ...]
    train: tuple[RunVerification, ...]
    held_out: tuple[RunVerification, ...]

    @property
    def proportional_slope(self) -> float | None:
        """Output per input of the part that is proportional to the input; None for a model without one."""
        return self.model.measurement["amplitudes"][0] if self.name == PROPORTIONAL_PART else None

    @property
    def rms(self) -> float:
        """Rms error over all held-out points."""
        return _pooled(self.held_out)

    @property
    def train_rms(self) -> float:
        """Rms error over all training points."""
        return _pooled(self.train)

    @property
    def misses_held_out(self) -> bool:
        """Whether held-out data are clearly worse than fitted ones."""
        return self.rms > WORSE * self.train_rms


def noise_of_repeats(runs: Sequence[RunVerification]) -> tuple[float, str] | None:
    """What readings of one state differ by, and its name; None if too few repeat.

    Repeats also differ by whatever changed in between, so what they scatter by is no noise of a reading.
    """
    floors = [f for r in runs if (f := noise_floor(without_dropouts(load_run(r.run)))).known]
    if not floors:
        return None
    value = float(np.median([f.known for f in floors if f.known]))
    repeats = any(f.source != "windows" for f in floors)
    return value, SCATTER_OF_REPEATS if repeats else NOISE_OF_A_READING


def noise_of_neighbours(candidate: CandidateModel) -> float | None:
    """The noise of a reading from neighbouring readings of the fitted runs, at least that of their rounding; None
    unless the error on held-out data exceeds it: where rows are far apart, neighbours differ by more than noise.
    """
    found = []
    for run in candidate.train:
        points = compared_points(run)
        noise = output_noise_sd(points.u, points.y) if points.y.size > 2 else np.nan
        found += [max(noise, rounding_sd(load_run(run.run)))] if points.y.size > 2 else []
    noise = float(np.median(found)) if found else np.inf
    return noise if candidate.rms > GOOD_RATIO * noise else None


@dataclass(frozen=True, eq=False)
class Evaluation:
    """All candidates, the best first; simple curves with their rms errors; and models that failed with the reason."""

    candidates: tuple[CandidateModel, ...]
    simple: dict[str, float]
    failed: dict[str, str]

    @property
    def best(self) -> CandidateModel:
        """The candidate with the least error on held-out data."""
        return self.candidates[0]

    @property
    def extended(self) -> CandidateModel | None:
        """The extended model of the diagnosis; None without one."""
        return next((c for c in self.candidates if c.name == EXTENDED), None)

    @property
    def plain(self) -> CandidateModel:
        """The best candidate without a load and without effects, which a diagnosis starts from."""
        return next((c for c in self.candidates if c.name not in _NOT_PLAIN), self.best)

    @property
    def by_history(self) -> CandidateModel:
        """The best candidate that follows from the history of the input alone: without a load and without causes."""
        return self.plain if self.best.proportional_slope is None else self.best


def evaluate(split: DataSplit, progress: Callable[[str], None]) -> Evaluation:
    """Fit and judge the candidates, and simple curves beside them. DataError if no model can be identified."""
    found, failed = [], {}
    for name, settings in _candidates(split):
        progress(f"fitting: {name}")
        try:
            result = identify(list(split.train), **settings)
            found.append(_evaluated(name, result.model, result.warnings, split))
        except (DataError, UsageError) as error:
            failed[name] = str(error)
    if not found:
        raise DataError("No model can be identified. " + " ".join(dict.fromkeys(failed.values())))
    found.sort(key=lambda c: c.rms)
    return Evaluation(tuple(found), _simple(found[0], split), failed)


def with_diagnosed(evaluation: Evaluation, name: str, model: Model, split: DataSplit) -> Evaluation:
    """The evaluation with a model of the diagnosis; it comes first only if it is best on held-out data."""
    try:
        extended = _evaluated(name, model, model.warnings, split, train_zero="fitted")
    except (DataError, UsageError) as error:
        return replace(evaluation, failed=evaluation.failed | {name: str(error)})
    first, *rest = evaluation.candidates
    ahead = split.kind != "none" and extended.rms < first.rms
    ordered = (extended, first, *rest) if ahead else (first, *sorted([extended, *rest], key=lambda c: c.rms))
    return replace(evaluation, candidates=ordered)


def rms_without_cause(evaluation: Evaluation, refitted: Model, split: DataSplit) -> float:
    """The least rms error on held-out data of models without the cause: those in the evaluation, and the one that the
    diagnosis fitted again to the same readings.
    """
    errors = [c.rms for c in evaluation.candidates if c.name not in _NOT_PLAIN]
    with suppress(DataError, UsageError):
        errors.append(_evaluated("refitted", refitted, (), split, train_zero="fitted").rms)
    return min(errors)


def _candidates(split: DataSplit) -> list[tuple[str, dict[str, Any]]]:
    if split.select is not None:
        chosen = {"select": split.select[0]}
        return [(name, {"surface": kind, **chosen}) for kind, name in _SURFACES.items()]
    found: list[tuple[str, dict[str, Any]]] = [(_POSITIVE, {"surface": "positive"})]
    if split.kind == "load":
        found.append((_ONE_MODEL, {"load_from": LOAD}))
    return found


def _evaluated(
    name: str,
    model: Model,
    warnings: Sequence[str],
    split: DataSplit,
    train_zero: Literal["auto", "fitted"] = "auto",
) -> CandidateModel:
    """The errors of a model on the training and held-out parts. A diagnosis fits a zero of its own to each training
    run; ``train_zero`` "fitted" does so too.
    """
    train, held_out = list(split.train), list(split.held_out)
    if split.select is not None:
        own, others = split.select
        fitted = verify(model, train, select=own, offset=train_zero).runs
        other = verify(model, train, select=others).runs
    elif split.continued:
        both = verify(model, [*train, *held_out]).runs
        fitted, other = both[: len(train)], both[len(train) :]
    else:
        fitted = verify(model, train, offset=train_zero).runs
        other = verify(model, held_out).runs if held_out else fitted
    return CandidateModel(name, model, tuple(warnings), tuple(fitted), tuple(other))


def _simple(best: CandidateModel, split: DataSplit) -> dict[str, float]:
    """Errors of simple curves, fitted and tested at the same points as the model.

    If nothing is held out, both branches of the one loop are left out: their mean is the measured loop itself.
    """
    train, held_out = ([compared_points(r) for r in runs] for runs in (best.train, best.held_out))
    free = [r.offset_kind == "fitted" for r in best.held_out]
    known = [b for b in baselines(train) if split.kind != "none" or b.name != BRANCHES]
    return {b.name: baseline_rms(b, held_out, free) for b in known}


def compared_points(run: RunVerification) -> RunPoints:
    """The readings of a run at which the model and simple curves are compared."""
    return points_of(run.input, run.measured, run.counted & np.isfinite(run.predicted))


def _pooled(runs: Sequence[RunVerification]) -> float:
    total = sum(r.settled.n * r.settled.rms**2 for r in runs)
    return float(np.sqrt(total / sum(r.settled.n for r in runs)))
