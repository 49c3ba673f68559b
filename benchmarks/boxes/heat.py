"""Temperatures of the wires of a box: the heat balance integrated in small steps (Runge–Kutta, fourth
order).

    τ dT/dt = p − T (T/T_ref)ⁿ        p: the steady temperature of a power with n = 0

The latent heat is applied afterwards as a temperature difference.
"""

import math

_FINE = 0.1  # of the time constant


class WireTemperatures:
    """Temperatures of one or two wires above ambient."""

    def __init__(self, reference_K: float, exponent: float = 0.0) -> None:
        self.wire_K = [0.0, 0.0]
        self._reference_K, self._exponent = reference_K, exponent

    @property
    def input_K(self) -> float:
        """T, or T₁ − T₂."""
        return self.wire_K[0] - self.wire_K[1]

    def step(self, powers_K: tuple[float, float], dt_s: float, tau_s: float) -> None:
        """Advance with constant powers."""
        steps = max(1, math.ceil(dt_s / (_FINE * tau_s)))
        x = dt_s / steps / tau_s
        for wire, power_K in enumerate(powers_K):
            T = self.wire_K[wire]
            for _ in range(steps if abs(self._net(power_K, T)) > 1e-9 else 0):
                T = self._runge_kutta(power_K, T, x)
            self.wire_K[wire] = T

    def add_temperature(self, by_K: float) -> None:
        """Add to T₁ − T₂, in the warmer wire."""
        if self.input_K >= 0:
            self.wire_K[0] += by_K
        else:
            self.wire_K[1] -= by_K

    def distance_to_steady_K(self, powers_K: tuple[float, float]) -> float:
        """The distance of the wires from their steady temperatures with these powers."""
        return max(abs(self.steady_K(p) - T) for p, T in zip(powers_K, self.wire_K))

    def steady_K(self, power_K: float) -> float:
        """The temperature at which the loss equals the power."""
        if not self._exponent or not power_K:
            return power_K
        return self._reference_K * (power_K / self._reference_K) ** (1 / (1 + self._exponent))

    def _net(self, power_K: float, T: float) -> float:
        if not self._exponent:
            return power_K - T
        return power_K - T * (max(abs(T), 1.0) / self._reference_K) ** self._exponent  # below 1 K as at 1 K

    def _runge_kutta(self, power_K: float, T: float, x: float) -> float:
        a = self._net(power_K, T)
        b = self._net(power_K, T + x / 2 * a)
        c = self._net(power_K, T + x / 2 * b)
        d = self._net(power_K, T + x * c)
        return T + x / 6 * (a + 2 * b + 2 * c + d)
