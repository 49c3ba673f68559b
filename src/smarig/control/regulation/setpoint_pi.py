"""A gentle loop that holds a set-point: PI from position error to source, with its zero at the wire's own lag.

    s_k = K e_k + K (1 − e^(−dt/τ)) Σ_{j<k} e_j    ⇒    T_{k+1} − T_k = K (1 − e^(−dt/τ)) e_k

The zero cancels the pole of the heating at every tick, so the temperature is an integral of the error. While the error
keeps its sign the temperature moves in one direction, and the loop leaves no branch without need. The steepest branch
determines K, so the loop is slower elsewhere and overshoots only if the source is clipped. Errors that would drive the
source further beyond its limits are not integrated (conditional integration); a source summed from its own clipped
increments would turn noise into drift.
"""

import math
from typing import Protocol

import numpy as np

from smarig.preisach import Everett
from smarig.protocols import Setup

BANDWIDTH_FACTOR = 1.0  # τ over the loop's time constant on the steepest branch
_GRID_POINTS = 256


class SetpointController(Protocol):
    """A controller that ``regulate`` can close: an error in, a source temperature out."""

    def start(self, source_K: float) -> None:
        """Start at rest at a source temperature."""
        ...

    def step(self, error: float) -> float:
        """The source temperature of the next tick, K, for the error (wanted − measured) of the last."""
        ...

    def settings(self) -> dict[str, float | None]:
        """Its numbers for the record."""
        ...

    def statement(self) -> str:
        """What is proved about the loop, in a sentence; "" if nothing is stated."""
        ...


class SetpointPI:
    """PI that holds a set-point, gentle on the steepest branch of the model.

        gain (K/unit): kelvin of steady temperature per unit of position
        band (unit): errors within it count as zero

    >>> loop = SetpointPI(gain=2.0, tau_s=5.0, period_s=0.1, low_K=0.0, high_K=100.0)
    >>> loop.start(50.0)
    >>> round(loop.step(1.0), 3), round(loop.step(1.0), 3), loop.step(1000.0)
    (52.0, 52.04, 100.0)
    """

    def __init__(
        self, gain: float, tau_s: float, period_s: float, low_K: float, high_K: float, band: float = 0.0
    ) -> None:
        self.gain, self.band = gain, band
        self._decay = math.exp(-period_s / tau_s)
        self._low_K, self._high_K = low_K, high_K
        self.start(0.0)

    @classmethod
    def for_model(cls, setup: Setup, hysteresis: Everett, band: float = 0.0) -> "SetpointPI":
        """The PI for a rig and a model: time constant τ/BANDWIDTH_FACTOR on the steepest branch."""
        gain = BANDWIDTH_FACTOR / steepest(hysteresis)
        return cls(gain, setup.tau_s, setup.period_s, setup.lower_K, setup.upper_K, band)

    def start(self, source_K: float) -> None:
        """Start at rest at a source temperature."""
        self._integral_K = self._clipped(source_K)

    def step(self, error: float) -> float:
        """The source temperature of the next tick, K."""
        error = 0.0 if abs(error) <= self.band else error
        unlimited_K = self._integral_K + self.gain * error
        limited_K = self._clipped(unlimited_K)
        if (unlimited_K - limited_K) * error <= 0:
            self._integral_K = self._clipped(self._integral_K + self.gain * (1 - self._decay) * error)
        return limited_K

    def settings(self) -> dict[str, float | None]:
        """The numbers for the record."""
        return {"gain": self.gain, "band": self.band}

    def statement(self) -> str:
        """Always "": this loop states nothing."""
        return ""

    def _clipped(self, source_K: float) -> float:
        return min(max(source_K, self._low_K), self._high_K)


def steepest(hysteresis: Everett) -> float:
    """The steepest slope of the major loop's two branches, output per input, over 1/256 of the range."""
    u = np.linspace(hysteresis.lower, hysteresis.upper, _GRID_POINTS + 1)
    rising = np.diff(hysteresis.swept(u, np.full_like(u, hysteresis.lower)))
    falling = -np.diff(hysteresis.swept(np.full_like(u, hysteresis.upper), u))
    return float(max(np.max(rising), np.max(falling)) / (u[1] - u[0]))
