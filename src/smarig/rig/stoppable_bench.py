"""A rig whose commands can be refused from outside: before each step, and while it is left without commands."""

from collections.abc import Callable

from smarig.core import Sample
from smarig.rig.bench import Bench
from smarig.rig.rig import Alarm

_LOOK_S = 0.5  # of the device's time without commands, between two looks


class StoppableBench:
    """A bench that calls ``raise_if_stopped`` before whatever takes time. Switching off is never refused."""

    def __init__(self, bench: Bench, raise_if_stopped: Callable[[], None]) -> None:
        self.bench, self._raise_if_stopped = bench, raise_if_stopped

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Step, unless a stop was requested."""
        self._raise_if_stopped()
        return self.bench.step(current_A, at_most)

    def idle(self, seconds: float) -> None:
        """Send no command for at least this time; a stop does not wait for its end."""
        period_s = self.period_s
        left, block = -int(-seconds // period_s), max(1, int(_LOOK_S / period_s))
        while left > 0:
            self._raise_if_stopped()
            self.bench.idle(min(left, block) * period_s)
            left -= block

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.bench.period_s

    @property
    def tick(self) -> int:
        """The tick of the last sample."""
        return self.bench.tick

    @property
    def position_per_count(self) -> float:
        """mm or degrees of one count."""
        return self.bench.position_per_count

    @property
    def shutdown_unconfirmed(self) -> str:
        """Why a device may still be on; "" if it is off."""
        return self.bench.shutdown_unconfirmed

    @property
    def has_lease(self) -> bool:
        """Whether the source switches itself off when the host stops communicating."""
        return self.bench.has_lease

    @property
    def holds_wire_limit(self) -> bool:
        """Whether the source measures the wire temperature and can limit it by itself."""
        return self.bench.holds_wire_limit

    @property
    def measures_ambient(self) -> bool:
        """Whether the ambient temperature of the samples is measured."""
        return self.bench.measures_ambient

    @property
    def counts_ticks(self) -> bool:
        """Whether the tick at which it switched itself off is known."""
        return self.bench.counts_ticks

    def identity(self) -> list[str]:
        """One line for each device."""
        return self.bench.identity()

    def alarms(self) -> list[Alarm]:
        """Alarms since the last call."""
        return self.bench.alarms()

    def zero(self) -> None:
        """Zero the encoder."""
        self.bench.zero()

    def arm(self) -> None:
        """Clear a latched trip."""
        self.bench.arm()

    def safe(self) -> None:
        """Set the current to zero."""
        self.bench.safe()

    def close(self) -> None:
        """Close all lines."""
        self.bench.close()
