"""What a protocol may ask of a rig: a closed union of inert commands.

A protocol is a generator that yields commands and is sent a ``StepResult`` (or, for ``Drive``, a
``Sample``) in return. Commands are plain data: printable, comparable, storable. Refuses to know who
carries them out: the same protocol is listed, costed, run on a twin and run on hardware.
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
    """Hold until the position stands still (thesis §5.2.1: constant for 25 s).

    The window is cut into 25 blocks; the wire has settled when the means of the last 25 blocks lie
    within ``band_counts`` of each other (peak to peak). Block means, because single samples carry
    the encoder's noise. That noise also hides the last tenth of a count of an approach, whose bias has
    the sign of the move: so the window does not begin before the heating model is within ``approach_K``
    of its steady state. ``timeout_s`` ends a hold that never settles; its verdict says so.
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
    """Apply a constant current until a condition holds; one step of the record."""

    current_A: float
    until: Elapsed | Settled
    target: float | None = None
    branch: str = ""


@dataclass(frozen=True, slots=True)
class Waveform:
    """Apply currents one after the other, each for ``period_s``; one step of the record."""

    currents_A: tuple[float, ...]
    period_s: float
    branch: str = ""


@dataclass(frozen=True, slots=True)
class Drive:
    """Apply a current for one tick and answer with its Sample: how a closed loop drives the rig."""

    current_A: float


@dataclass(frozen=True, slots=True)
class Zero:
    """Zero the relative encoder where it stands."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A remark in the record: the start of a phase, a discovery, a note."""

    label: str
    data: dict[str, Any] = field(default_factory=dict)


class StepVerdict(StrEnum):
    """How a step ended; the values are what the record stores."""

    SETTLED = "settled"
    TIMED_OUT = "timed_out"
    ELAPSED = "elapsed"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class StepResult:
    """What became of a step: mean position over its window, n samples, verdict."""

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
