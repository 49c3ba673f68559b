"""Bounds of the temperature of wires that differ in time constant and heat, tick by tick: see ``wire_bounds.py``."""

import math

from smarig.plant import Actuator

LAGS = (0.3, 1.0, 3.0)  # of the time constant: insulated, thick, in moving air, with latent heat
EVERY_LAG = slice(None)
LAG_BANDS = (slice(0, 2), slice(1, 3))  # of like wires
LEAST_SHARE = 0.015  # δ as a share of the range: ambient temperature, noise of the input
Bands = list[tuple[float, float]]


class TemperatureBounds:
    """Bounds of the hysteresis input in kelvin; ``rate_K`` is the fastest change of any wire in the last tick.

    >>> bounds = TemperatureBounds(Actuator.named("gorbet_one_wire"), 0.1, 0.1)
    >>> for _ in range(3000):
    ...     bounds.step(1.0)
    >>> low_K, high_K = bounds.between(0.9, 1.1)
    >>> round(low_K, 1), round(high_K, 1)
    (154.1, 194.1)
    """

    def __init__(self, actuator: Actuator, period_s: float, tolerance: float) -> None:
        surface = actuator.hysteresis
        self.least_K = LEAST_SHARE * max(surface.upper, -surface.lower)
        self._fastest, self._two_wire = 1 + tolerance, actuator.two_wire
        self._gain = actuator.gain_K_per_A2
        self._approach = list(enumerate(-math.expm1(-period_s / (lag * actuator.tau_s)) for lag in LAGS))
        self._wires = [[0.0] * len(LAGS) for _ in range(2 if actuator.two_wire else 1)]
        self.rate_K = 0.0
        self.coldest_K, self.hottest_K = [0.0, 0.0], [0.0, 0.0]  # of each wire, with its nominal heat
        self._lowest_K = [
            [0.0] * len(LAGS) for _ in range(2)
        ]  # of each wire and lag, since ``forget_extremes``
        self._highest_K = [[0.0] * len(LAGS) for _ in range(2)]

    def step(self, current_A: float) -> None:
        """Advance one tick at a constant current."""
        source = self._gain * current_A * current_A
        hot = 1 if self._two_wire and current_A < 0 else 0
        rate_K = 0.0
        for number, wire in enumerate(self._wires):
            end = source if number == hot else 0.0
            if end == 0.0 == self.hottest_K[number]:
                continue  # it has never been heated
            coldest_K, hottest_K, fastest = math.inf, -math.inf, 0.0
            lowest_K, highest_K = self._lowest_K[number], self._highest_K[number]
            for k, share in self._approach:
                before = wire[k]
                change = (end - before) * share
                wire[k] = wire_K = before + change
                if change > fastest:
                    fastest = change
                elif -change > fastest:
                    fastest = -change
                if wire_K < coldest_K:
                    coldest_K = wire_K
                if wire_K > hottest_K:
                    hottest_K = wire_K
                if wire_K < lowest_K[k]:
                    lowest_K[k] = wire_K
                elif wire_K > highest_K[k]:
                    highest_K[k] = wire_K
            rate_K += fastest
            self.coldest_K[number], self.hottest_K[number] = coldest_K, hottest_K
        self.rate_K = self._fastest * rate_K

    @property
    def wires_K(self) -> list[list[float]]:
        """The temperature of each wire at each of ``LAGS``, with its nominal heat."""
        return self._wires

    def between(self, least: float, largest: float) -> tuple[float, float]:
        """Bounds of the input of wires whose heat is between these shares of the nominal one."""
        return self._inputs_K(self.coldest_K, self.hottest_K, [(least, largest)])[0]

    def present(self, bands: Bands, lags: slice = EVERY_LAG) -> Bands:
        """The same for each band of shares, of the wires with these of ``LAGS``."""
        if lags == EVERY_LAG:
            return self._inputs_K(self.coldest_K, self.hottest_K, bands)
        wires = self._wires if self._two_wire else [*self._wires, [0.0] * len(LAGS)]
        return self._inputs_K([min(wire[lags]) for wire in wires], [max(wire[lags]) for wire in wires], bands)

    def extremes(self, bands: Bands, lags: slice = EVERY_LAG) -> Bands:
        """The same of all ticks since ``forget_extremes``."""
        lowest_K, highest_K = self._lowest_K, self._highest_K
        return self._inputs_K(
            [min(wire[lags]) for wire in lowest_K], [max(wire[lags]) for wire in highest_K], bands
        )

    def forget_extremes(self) -> None:
        """Later extremes are those from now on."""
        for number, wire in enumerate(self._wires):
            self._lowest_K[number], self._highest_K[number] = wire[:], wire[:]

    def _inputs_K(self, coldest_K: list[float], hottest_K: list[float], bands: Bands) -> Bands:
        (cold, cold_2), (hot, hot_2), delta_K = coldest_K, hottest_K, self.least_K
        return [
            (least * cold - largest * hot_2 - delta_K, largest * hot - least * cold_2 + delta_K)
            for least, largest in bands
        ]
