"""The observed position as the feedback of a loop, with the checks that replace those of an encoder, and its record.

Where a reading is missing or ambiguous the observer goes on with the model's prediction. A resistance that no state of
the model explains, or a wire that carries current without a voltage, ends the run at zero current.
"""

import math
from dataclasses import dataclass, field

from smarig.control.sensing.position_observer import Observation, PositionObserver
from smarig.core import LimitExceeded, Mark, Quality, Sample

OBSERVED = "observed position"  # label of the marks
IMPLAUSIBLE = 5.0  # standard deviations of the expected resistance
LONGEST_S = 5.0  # after which an implausible or missing resistance ends the run
BLOCK_S = 60.0  # of a mark


@dataclass
class ResistanceFeedback:
    """``observe(sample)`` at every sample gives the position on the model's scale; ``blocks()`` are marks to record.

    ``predict`` passes over ticks whose samples a protocol does not see, such as those of a hold.
    """

    observer: PositionObserver
    period_s: float
    _seen: list[tuple[float, Observation]] = field(default_factory=list)
    _last_tick: int = -1
    _implausible_s: float = 0.0
    _missing_s: float = 0.0

    def predict(self, current_A: float, seconds: float) -> None:
        """Let time pass at a current, without readings."""
        self.observer.predict(current_A, round(seconds / self.period_s))

    def observe(self, sample: Sample) -> float:
        """The position at a sample. Raises LimitExceeded for a resistance that is missing or impossible."""
        current_A = sample.current_A if math.isfinite(sample.current_A) else sample.current_command_A
        if self._last_tick >= 0:
            self.observer.predict(current_A, sample.tick - self._last_tick - 1)  # lost samples
        self._last_tick = sample.tick
        bad = sample.quality & (Quality.STALE | Quality.TRIPPED)
        found = self.observer.step(math.nan if bad else sample.voltage_V, current_A)
        self._seen.append((sample.t_s, found))
        self._check(sample, current_A, found)
        return found.position

    def blocks(self, *, last: bool = False) -> list[Mark]:
        """The mark of the observations since the one before, once a minute; ``last``: in any case."""
        if not self._seen or (not last and len(self._seen) * self.period_s < BLOCK_S):
            return []
        seen, self._seen = self._seen, []
        data = {
            "at_s": [t_s for t_s, _ in seen],
            "position": [round(o.position, 5) for _, o in seen],
            "half": [round(o.half, 5) for _, o in seen],
            "ambiguous": [int(o.ambiguous) for _, o in seen],
        }
        return [Mark(OBSERVED, data)]

    def _check(self, sample: Sample, current_A: float, found: Observation) -> None:
        carries = abs(current_A) >= self.observer.sensing.least_A
        self._missing_s = (
            self._missing_s + self.period_s if carries and not math.isfinite(sample.voltage_V) else 0.0
        )
        if self._missing_s > LONGEST_S:
            raise LimitExceeded(
                f"The wire has carried {current_A:.3g} A for {LONGEST_S:g} s without a voltage reading, so its "
                "position is not known."
            ).at_zero()
        self._implausible_s = (
            self._implausible_s + self.period_s if abs(found.deviation) > IMPLAUSIBLE else 0.0
        )
        if self._implausible_s > LONGEST_S:
            raise LimitExceeded(
                f"The resistance {sample.voltage_V / current_A:.4g} ohm is {abs(found.deviation):.1f} standard "
                f"deviations from what the model expects, for {LONGEST_S:g} s. Check the contacts, the wire and the "
                "model."
            ).at_zero()
