"""The properties of a rig that a protocol may use: ranges and the heating law. The rig itself is not accessible."""

from dataclasses import dataclass

from smarig.config import LimitsFile, load_rig
from smarig.core import ConfigError
from smarig.plant import Actuator

_MARGIN_K = 0.5


@dataclass(frozen=True)
class Setup:
    """Actuator, limits and tick of the rig a protocol will run on.

    >>> setup = Setup.of("one_wire_twin")
    >>> setup.lower_K, setup.upper_K, round(setup.current_for(43.5), 3)
    (0.0, 174.1, 0.5)
    """

    actuator: Actuator
    limits: LimitsFile
    period_s: float

    def __post_init__(self) -> None:
        if self.limits.current_min_A < 0 and not self.actuator.two_wire:
            raise ConfigError(
                f"limits.current_min_A is {self.limits.current_min_A:g}, but {self.actuator.name} is one wire, which "
                "no negative current drives. Set it to 0."
            )

    @classmethod
    def of(cls, rig: str) -> "Setup":
        """The setup of a rig given by name or path."""
        file = load_rig(rig)
        return cls(Actuator.named(file.actuator), file.limits, file.period_s)

    @property
    def lower_K(self) -> float:
        """Smallest hysteresis input that the limits allow, in kelvin above ambient."""
        return max(self.actuator.input_for(self.limits.current_min_A), -self._hottest_K)

    @property
    def upper_K(self) -> float:
        """Largest hysteresis input that the limits allow, in kelvin above ambient."""
        return min(self.actuator.input_for(self.limits.current_max_A), self._hottest_K)

    @property
    def largest_A(self) -> float:
        """Largest steady current that the limits of current and temperature allow."""
        return min(self.limits.current_max_A, self.actuator.current_for(self._hottest_K))

    @property
    def _hottest_K(self) -> float:
        """The temperature limit minus a margin for the noise of the prediction."""
        return self.limits.temperature_max_K - _MARGIN_K

    @property
    def tau_s(self) -> float:
        """Thermal time constant."""
        return self.actuator.tau_s

    @property
    def two_wire(self) -> bool:
        """Whether the rig is differential."""
        return self.actuator.two_wire

    def current_for(self, input_K: float) -> float:
        """Steady current for an input, clipped to the limits against rounding."""
        current = self.actuator.current_for(input_K)
        low, high = self.limits.current_min_A, self.limits.current_max_A
        return min(max(current, low - 0.0), high) if low - 1e-9 <= current <= high + 1e-9 else current

    def at(self, share: float) -> float:
        """Input at a share of the range: 0 is the lower end and 1 the upper end."""
        return self.lower_K + share * (self.upper_K - self.lower_K)
