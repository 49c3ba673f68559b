"""Fig. 5.4 as numbers: the distance of major loops that start from different histories.

Encoders are incremental: a major loop is recorded relative to the position at which the encoder was zeroed. The rig's
own noise-free twin gets three histories, is initialised in three ways, and is driven round the major loop. The result
holds for hardware as far as the twin represents it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from smarig.config import RigFile
from smarig.core import Elapsed, Hold, Protocol, Sample, Settled, StepResult, Zero
from smarig.plant import Actuator
from smarig.protocols import Setup, initialise
from smarig.rig import Guard, Twin, TwinSettings, stress_limit
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

InitialisationMethod = Literal["none", "thesis", "planned"]
_HISTORIES = ((), (0.8,), (-0.7,))  # fresh; wire 1 heated; wire 2 heated: currents as fractions of the limit


@dataclass(frozen=True)
class InitialisationSpread:
    """Spread of both ends of the major loop over the histories, in counts, and the largest inputs (kelvin)."""

    method: InitialisationMethod
    offset_counts: float
    max_input_K: float
    min_input_K: float

    def sentence(self) -> str:
        """The result in one line."""
        what = {
            "none": "On this rig's noise-free twin: without initialisation",
            "thesis": "With the thesis's initialisation (0.1 Hz, 180 s)",
            "planned": "With the initialisation planned from the time constant",
        }[self.method]
        extremes = (
            ""
            if self.method == "none"
            else f"; the input varies between {self.max_input_K:+.0f} and −{-self.min_input_K:.0f} K"
        )
        return f"{what} the major loops of three histories are up to {self.offset_counts:.1f} counts apart{extremes}."


def initialisation_spread(
    rig: RigFile, actuator: Actuator, method: InitialisationMethod
) -> InitialisationSpread:
    """Spread of major loops over three histories after one kind of initialisation; settled, noise-free counts."""
    loops, all_extremes = [], []
    for history in _HISTORIES:
        loop, extremes = _major_loop(rig, actuator, method, history)
        loops.append(loop)
        all_extremes.append(extremes)
    spread = max(max(end) - min(end) for end in zip(*loops, strict=True))
    # The fresh wire shows the effect of the sinusoid alone; the other wires are still warm from their history.
    return InitialisationSpread(method, spread, *all_extremes[0])


def _major_loop(
    rig: RigFile, actuator: Actuator, method: InitialisationMethod, history: Sequence[float]
) -> tuple[list[float], tuple[float, float]]:
    twin = Twin(rig, actuator, TwinSettings(noise=False))
    extremes = _InputExtremes()
    ends: list[StepResult] = []
    watch = CallbackListener(extremes.sample, ends.append)
    runner = Runner(
        Guard(twin, rig.limits, actuator, stress=stress_limit(rig, actuator)),
        twin.position_per_count,
        [watch],
    )
    setup = Setup(actuator, rig.limits, rig.period_s)
    runner.run(_history(setup, history))
    extremes.max_K = extremes.min_K = 0.0
    runner.run(_zero_only() if method == "none" else initialise(setup, method=method))
    range_K = (extremes.max_K, extremes.min_K)
    ends.clear()
    runner.run(_loop(setup))
    return [end.counts for end in ends], range_K


def _history(setup: Setup, shares: Sequence[float]) -> Protocol:
    long = Elapsed(10 * setup.tau_s)
    for share in shares:
        yield Hold(share * setup.current_for(setup.upper_K), long)
        yield Hold(0.0, long)


def _zero_only() -> Protocol:
    yield Zero()


def _loop(setup: Setup) -> Protocol:
    for input_K in (setup.lower_K, setup.upper_K, setup.lower_K):
        yield Hold(setup.current_for(input_K), Settled(), target=input_K)


class _InputExtremes:
    """The extreme inputs."""

    def __init__(self) -> None:
        self.max_K = self.min_K = 0.0

    def sample(self, _s: Sample, _step: int | None, input_K: float) -> None:
        self.max_K, self.min_K = max(self.max_K, input_K), min(self.min_K, input_K)
