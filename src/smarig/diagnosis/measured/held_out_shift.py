"""Whether held-out runs differ from the training runs: a plain model misses them by more than left-out blocks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.measured.adequacy import adequate_error
from smarig.identification import Comparison, MeasuredHypothesis
from smarig.measurement import InputRecord, rate_of

Array = NDArray[np.float64]
RATIO = 2.5  # of the error on held-out runs to that on left-out blocks: larger is a difference
REACH = 0.05  # of the input's range: held-out runs that go farther beyond it are extrapolated
RATE_RATIO = 1.5  # a rate that lies outside those of the training runs by more is another rate


@dataclass(frozen=True)
class HeldOutShift:
    """The ``variable`` in which held-out runs differ, and the ratio of their rms error to that on left-out blocks."""

    variable: str
    ratio: float


def held_out_shift(
    base: MeasuredHypothesis, base_error: Array, comparison: Comparison, train: int
) -> HeldOutShift | None:
    """The difference, or None; ``base_error`` (m,): errors of the plain model, held-out ones about their mean."""
    tested = ~comparison.train
    records = comparison.plan.records
    if not tested.any() or not within_reach(records[:train], records[train:]):
        return None
    error = float(np.sqrt(np.mean(base_error[tested] ** 2)))
    if error <= max(RATIO * base.rms, adequate_error(base)):
        return None
    return HeldOutShift(_variable(records[:train], records[train:]), error / base.rms)


def within_reach(train: Sequence[InputRecord], held_out: Sequence[InputRecord]) -> bool:
    """Whether the inputs of held-out runs lie within those of the training runs, or hardly beyond."""
    low, high = min(float(r.u.min()) for r in train), max(float(r.u.max()) for r in train)
    beyond = REACH * (high - low)
    return all(low - beyond <= float(r.u.min()) and float(r.u.max()) <= high + beyond for r in held_out)


def _variable(train: Sequence[InputRecord], held_out: Sequence[InputRecord]) -> str:
    """The rate if all held-out runs are faster or slower than every training run, else the run."""
    if all(r.clock for r in (*train, *held_out)):
        known, other = [rate_of(r) for r in train], [rate_of(r) for r in held_out]
        if min(other) > RATE_RATIO * max(known) or RATE_RATIO * max(other) < min(known):
            return "rate"
    return "run"


def with_held_out_shift(verdict: DiagnosisVerdict, shift: HeldOutShift | None) -> DiagnosisVerdict:
    """The verdict; if nothing else is known, the errors depend on what the held-out runs differ in."""
    if shift is None or verdict.word not in ("silent", "unknown") or verdict.depends_on is not None:
        return verdict
    return DiagnosisVerdict("unknown", depends_on=shift.variable)
