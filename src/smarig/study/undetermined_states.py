"""Missing knowledge of a study: the held-out data enter states that the fitted data did not determine."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from smarig.core import Array, DataError, UsageError, root_mean_square, spaced
from smarig.diagnosis import RULES, inputs_of_error, missing_share
from smarig.identification import RunVerification, identify, verify
from smarig.record import Run
from smarig.report import display_unit, number
from smarig.study.candidate_models import CandidateModel
from smarig.study.data_split import DataSplit
from smarig.study.input_turns import wide_turns

_SAME_TURN = 0.05  # of the range of the input: a turn as near to a fitted one is no new one
_MOST_SHOWN = 3
_PARTLY = 0.75  # of the held-out error: half way from what a shift leaves (``missing_share``) to all of it


@dataclass(frozen=True)
class UndeterminedStates:
    """``share`` of the held-out square error, beyond the fitted one, that one model of all rows does not have.

    ``inputs``: between these lie nine tenths of that error. ``turns``: the inputs at which the held-out data turn and
    the fitted data never did. ``left``: the rms error of that model over the one that the fitted data leave to their
    own.
    """

    share: float
    inputs: tuple[float, float]
    turns: tuple[float, ...]
    left: float

    @property
    def explains(self) -> bool:
        """Whether hardly any of the held-out error is left to another cause."""
        return self.share >= RULES["not_determined"].value and self.left <= RULES["adequate"].value

    def sentence(self, input_unit: str) -> str:
        """What is not known, and the experiment that would close it."""
        unit = spaced(display_unit(input_unit))
        low, high = (number(u) for u in self.inputs)
        share = (
            f"Up to {100 * self.share:.0f} % of the additional error on held-out data is missing knowledge"
        )
        known = f"{share}, and nothing need have changed" if self.explains else share
        if not self.turns:
            return f"{known}: from {low} to {high}{unit} the held-out data enter states that the fitted data did not."
        turns = ", ".join(number(u) for u in self.turns[:_MOST_SHOWN])
        more = " and elsewhere" if len(self.turns) > _MOST_SHOWN else ""
        return (
            f"{known}: the held-out data turn at {turns}{unit}{more}, where the fitted data never turned. First-order "
            "curves are missing: record a run that turns there, and fit it too."
        )


def undetermined_states(split: DataSplit, plain: CandidateModel) -> UndeterminedStates | None:
    """What the fitted data leave open and the held-out data need; None if that is not where the error lies.

    ``plain`` may have a part proportional to the input: the rest of the output is then that of a measure.
    """
    if split.kind not in ("run", "time") or not plain.misses_held_out:
        return None
    runs = [_of_measure(plain, run) for run in (*split.train, *split.held_out)]
    try:
        found = _of_one_model(runs)
        if len(found) < len(runs):
            found = _of_one_model([_within(plain, run) for run in runs])
    except (DataError, UsageError):
        return None
    if len(found) < len(runs):
        return None
    fitted, held = found[: len(split.train)], found[len(split.train) :]
    error, own, together = _errors(plain.held_out), _errors(plain.train), (_errors(held), _errors(fitted))
    share = missing_share(error, together, own)
    before = root_mean_square(own)
    left = root_mean_square(np.concatenate(together)) / before if before else np.inf
    u = np.concatenate([r.input[r.counted] for r in plain.held_out])
    found = UndeterminedStates(share, inputs_of_error(u, error**2), new_turns(split, plain), left)
    return found if found.explains or (found.turns and share > _PARTLY) else None


def _of_one_model(runs: Sequence[Run]) -> tuple[RunVerification, ...]:
    """The runs as one model of all of them predicts them, without those of which it predicts nothing."""
    return verify(identify(runs, surface="positive").model, runs).runs


def _of_measure(plain: CandidateModel, run: Run) -> Run:
    """The run without the part of its output that is proportional to the input: no measure has it."""
    slope = plain.proportional_slope
    if slope is None:
        return run
    return replace(run, columns={**run.columns, "position": run["position"] - slope * run["input"]})


def _within(plain: CandidateModel, run: Run) -> Run:
    """The run with its input within the range of the fitted model, beyond which that model is saturated.

    If the held-out input goes further, by its noise for example, the fitted runs never saturate a model of all rows,
    and their memory is unknown to it.
    """
    h = plain.model.hysteresis
    return replace(run, columns={**run.columns, "input": np.clip(run["input"], h.lower, h.upper)})


def _errors(runs: Sequence[RunVerification]) -> Array:
    return np.concatenate([(r.predicted - r.measured)[r.counted] for r in runs])


def new_turns(split: DataSplit, plain: CandidateModel) -> tuple[float, ...]:
    """The inputs at which held-out data turn and fitted data never did, in order of the input.

    A record is split at a turn: it is one of the part that goes on from there.
    """
    known, new = turns_of(plain.train), turns_of(plain.held_out)
    new = np.append(new, [r.input[0] for r in plain.held_out]) if split.continued else new
    least = _SAME_TURN * float(np.ptp(known)) if known.size else 0.0
    far = [u for u in np.unique(new) if not known.size or np.abs(known - u).min() > least]
    return tuple(float(u) for u, before in zip(far, [-np.inf, *far]) if u - before > least)


def turns_of(runs: Sequence[RunVerification]) -> Array:
    """The inputs (k,) at which runs turn, without their ends."""
    return np.concatenate([_turns(r.input) for r in runs])


def inside(turns: Sequence[float] | Array, fitted: Sequence[RunVerification]) -> bool:
    """Whether one of these turns lies inside the range of the fitted input: at its ends, full loops turn."""
    u = np.concatenate([r.input for r in fitted])
    low, high = float(np.nanmin(u)), float(np.nanmax(u))
    edge = _SAME_TURN * (high - low)
    return any(low + edge < turn < high - edge for turn in turns)


def _turns(u: Array) -> Array:
    known = u[np.isfinite(u)]
    return known[wide_turns(known)[1:-1]] if known.size > 3 else known[:0]
