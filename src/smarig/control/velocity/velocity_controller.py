"""Velocity controllers: biproper sampled systems from velocity error ė to input ũ, with their δ and γ.

    ⟨ė, ũ⟩_T ≥ δ ‖ė‖²_T        ‖ũ‖_T ≤ γ ‖ė‖_T        for every T, from rest                       (Thm 8.2)

They are biproper, because strict passivity and smoothing exclude each other (theory.md §8, erratum 11). δ and γ are
those of the sampled controller. The catalogue in ``controllers`` uses two kinds: without memory, and with one linear
state. ũ is in the model's input unit, ė in its output unit per second.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from smarig.control.argument_checks import positive
from smarig.core import Array

_SHORTEST, _LONGEST = 64, 1 << 20


class ControllerState(Protocol):
    """A running controller. ``output`` may be called repeatedly before ``advance`` moves to the next sample."""

    def output(self, error: float) -> float:
        """ũ for an error at the present sample; increases with the error."""
        ...

    def advance(self, error: float) -> None:
        """Move to the next sample with the error of the present one."""
        ...


class VelocityController(Protocol):
    """A controller by its constants; ``start`` makes a running one from rest."""

    @property
    def delta(self) -> float:
        """δ, the input strict passivity index: input unit per output unit per second."""
        ...

    @property
    def gamma(self) -> float:
        """γ, the gain."""
        ...

    def start(self, dt_s: float) -> ControllerState:
        """A running controller from rest, sampled every ``dt_s``."""
        ...

    def probes(self, dt_s: float) -> Iterator[Array]:
        """Error signals (n,) that approach δ and γ increasingly closely."""
        ...


@dataclass(frozen=True)
class MemorylessController:
    """ũ = law(sample, ė) with least ≤ law/ė ≤ most at every sample: δ = ``least``, γ = ``most`` for any law.

    ``probe_signals`` gives error signals that approach both bounds.
    """

    law: Callable[[int, float], float]
    least: float
    most: float
    probe_signals: Callable[[], Iterable[Array]]

    @property
    def delta(self) -> float:
        """min ũ/ė: then ė ũ ≥ δ ė² at every sample."""
        return self.least

    @property
    def gamma(self) -> float:
        """max ũ/ė."""
        return self.most

    def start(self, dt_s: float) -> ControllerState:
        """A running controller at sample 0."""
        positive("dt_s", dt_s)  # not needed for the law itself, but sums over signals use it
        return _MemorylessState(self.law)

    def probes(self, dt_s: float) -> Iterator[Array]:
        """The given probe signals."""
        del dt_s
        return iter(self.probe_signals())


class _MemorylessState:
    def __init__(self, law: Callable[[int, float], float]) -> None:
        self._law, self._sample = law, 0

    def output(self, error: float) -> float:
        return self._law(self._sample, error)

    def advance(self, error: float) -> None:
        del error
        self._sample += 1


@dataclass(frozen=True)
class FirstOrderController:
    """H(s) = H∞ + (H₀ − H∞) a/(s + a): ``static_gain`` H₀ for steady errors, ``high_frequency_gain`` H∞ for sudden
    ones.

    H(jω) is a half circle whose diameter is the real segment from H₀ to H∞, so

        δ = inf Re H = min(H₀, H∞)        γ = sup |H| = max(H₀, H∞)            (H₀, H∞ > 0)

    in closed form. Sampled by the bilinear rule, s = (2/dt)(z − 1)/(z + 1), H has on the unit circle its values on the
    imaginary axis and at ∞: the sampled controller has the same δ and γ for every dt. Truncation has no effect: ũ up
    to T depends only on ė up to T, and Parseval's theorem holds for ė_T.
    """

    static_gain: float
    high_frequency_gain: float
    rate_per_s: float

    @property
    def delta(self) -> float:
        """min(H₀, H∞)."""
        return min(self.static_gain, self.high_frequency_gain)

    @property
    def gamma(self) -> float:
        """max(H₀, H∞)."""
        return max(self.static_gain, self.high_frequency_gain)

    def start(self, dt_s: float) -> ControllerState:
        """x₊ = p x + ė, ũ = (H∞ + g) ė + g (1 + p) x, p = (2/dt − a)/(2/dt + a), g = (H₀ − H∞) a/(2/dt + a)."""
        positive("dt_s", dt_s)
        pole = (2.0 / dt_s - self.rate_per_s) / (2.0 / dt_s + self.rate_per_s)
        gain = (
            (self.static_gain - self.high_frequency_gain) * self.rate_per_s / (2.0 / dt_s + self.rate_per_s)
        )
        return _FirstOrderState(pole, gain * (1.0 + pole), self.high_frequency_gain + gain)

    def probes(self, dt_s: float) -> Iterator[Array]:
        """Steady and alternating errors with a half-sine window, which approach H₀ (ω = 0) and H∞ (z = −1)."""
        del dt_s
        n = _SHORTEST
        while n <= _LONGEST:
            window = np.sin(np.pi * (np.arange(n) + 0.5) / n).astype(float)
            yield window
            yield np.where(np.arange(n) % 2, -window, window)
            n *= 2


class _FirstOrderState:
    def __init__(self, pole: float, output_gain: float, feedthrough: float) -> None:
        self._pole, self._output_gain, self._feedthrough, self._x = pole, output_gain, feedthrough, 0.0

    def output(self, error: float) -> float:
        return self._feedthrough * error + self._output_gain * self._x

    def advance(self, error: float) -> None:
        self._x = self._pole * self._x + error
