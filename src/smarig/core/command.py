"""Commands that a protocol can send to a rig.

A protocol is a generator. It yields commands and receives a ``StepResult`` for each (for ``Drive``, a ``Sample``).
Commands are plain data that can be printed, compared and stored. The same protocol can therefore be listed, costed,
run on a twin and run on hardware.
"""

from collections.abc import Generator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from smarig.core.errors import UsageError
from smarig.core.sample import Sample


@dataclass(frozen=True, slots=True)
class Elapsed:
    """Hold for a fixed time."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Settled:
    """Hold until the position has settled (thesis §5.2.1: constant for 25 s).

    The window is cut into 25 blocks. The wire has settled when the means of the last 25 blocks lie within
    ``band_counts`` of each other (peak to peak). Block means are used because single samples carry the encoder's
    noise. That noise also hides the last tenth of a count of an approach, a bias with the sign of the move. The window
    therefore starts only when the heating model, at the current as ordered, is within ``approach_K`` of its steady
    state. ``timeout_s`` ends a hold that does not settle, with the verdict timed_out.
    """

    band_counts: float = 1.0
    window_s: float = 25.0
    timeout_s: float = 600.0
    approach_K: float = 0.01

    def __post_init__(self) -> None:
        if not (
            self.band_counts > 0
            and self.window_s > 0
            and 1e6 >= self.timeout_s >= self.window_s
            and self.approach_K > 0
        ):
            raise UsageError(
                "Settling needs band_counts > 0, window_s > 0, timeout_s ≥ window_s and approach_K > 0; got "
                f"{self.band_counts:g}, {self.window_s:g}, {self.timeout_s:g}, {self.approach_K:g}."
            )


@dataclass(frozen=True, slots=True)
class Hold:
    """Apply a constant current until a condition is met. One step of the record."""

    current_A: float
    until: Elapsed | Settled
    target: float | None = None
    branch: str = ""


@dataclass(frozen=True, slots=True)
class Waveform:
    """Apply a sequence of currents, each for ``period_s``. One step of the record."""

    currents_A: tuple[float, ...]
    period_s: float
    branch: str = ""


@dataclass(frozen=True, slots=True)
class Drive:
    """Apply a current for one tick and return its Sample. Closed loops drive the rig with it."""

    current_A: float


@dataclass(frozen=True, slots=True)
class Zero:
    """Set the relative encoder to zero at its present position."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A remark in the record: the start of a phase, a finding, a note."""

    label: str
    data: dict[str, Any] = field(default_factory=dict)


class StepVerdict(StrEnum):
    """How a step ended. The record stores these values."""

    SETTLED = "settled"
    TIMED_OUT = "timed_out"
    ELAPSED = "elapsed"
    INTERRUPTED = "interrupted"
    SUSPECT = "suspect"
    """It had settled, but its readings contradict later ones, and which are wrong is not known."""


@dataclass(frozen=True, slots=True)
class StepResult:
    """The result of a step: verdict, mean position over its window, and number of samples n."""

    index: int
    verdict: StepVerdict
    position: float
    counts: float
    counts_sd: float
    n: int
    t_start_s: float
    t_end_s: float


Command = Hold | Waveform | Drive | Zero | Mark
CommandReply = StepResult | Sample | None
Protocol = Generator[Command, Any, None]
