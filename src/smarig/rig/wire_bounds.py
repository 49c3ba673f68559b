"""What a wire within a tolerance of its actuator file can do under the measured current: bounds, tick by tick.

Temperature: every wire whose time constant lies between 0.3 τ and 3 τ and whose R/hA differs by at most the share g:

    T_low = (1 − g) min T(kτ),   T_high = (1 + g) max T(kτ),   k = 0.3, 1, 3;   u = T, or T₁ − T₂, ± δ

(``temperature_bounds.py``).

Position: a Preisach operator with a measure that is not negative keeps the order of its inputs, so that

    u_low(s) ≤ u(s) ≤ u_high(s) for all s ≤ t   ⇒   Γ[u_low](t) ≤ y(t) ≤ Γ[u_high](t)

whatever the path between (Brokate and Sprekels, Hysteresis and Phase Transitions, 1996, section 2.2: monotone
operators). The operator of the lower bound starts in negative saturation and that of the upper bound in positive, so no
initial state is assumed; two bounds cost as much as two wires. The stroke may differ by the share g too.
"""

import math
from itertools import pairwise
from typing import Protocol

import numpy as np

from smarig.plant import Actuator, ThermomechanicalPlant, WirePhases, thermomechanical_travel
from smarig.preisach import Everett, Preisach
from smarig.rig.temperature_bounds import EVERY_LAG, LAG_BANDS, Bands, TemperatureBounds

BEATS_PER_TAU = 6  # how often the bounds of the position are computed
RATE_FACTOR = 2.0  # of the steepest branch: minor effects make it steeper
SENSOR_LAG_TAUS = 1.0  # lag of a position sensor
HEAT_BANDS, STROKE_BANDS = 4, 3  # groups of like wires
THERMOMECHANICAL_BANDS = 2  # of heat: a model of Brinson costs more


class _Models(Protocol):
    """Models of the wire with more and more heat; it lies between two of them, one after the other."""

    def advance(self) -> tuple[Bands, Bands]:
        """The bounds of the position between each two, in the rig's unit, at the end of a beat; and those of wires that
        are alike in their time constants, too.
        """
        ...

    def add(self, current_A: float) -> None:
        """One more tick of the beat."""
        ...

    def ohm(self, current_A: float) -> tuple[float, float]:
        """The bounds of the resistance of the wire that carries this current."""
        ...


class _Enclosures:
    """Pairs of Preisach operators, each pair around the wires whose heat is within a band, with these of ``LAGS``."""

    def __init__(self, surface: Everett, bands: Bands, lags: slice = EVERY_LAG) -> None:
        self._bands, self._lags = bands, lags
        self.low = [Preisach(surface, "negative", compiled=False) for _ in bands]
        self.high = [Preisach(surface, "negative", compiled=False) for _ in bands]
        for operator in self.high:
            operator.step(surface.upper)

    def advance(self, temperature: TemperatureBounds) -> Bands:
        """The bounds of the position at the end of a beat."""
        extremes = temperature.extremes(self._bands, self._lags)
        present, bounds = temperature.present(self._bands, self._lags), []
        for low, high, extreme_K, present_K in zip(self.low, self.high, extremes, present):
            # an extremum within a beat is remembered; most often the operator is there already, or goes on from it
            for operator, first_K, last_K in zip((low, high), extreme_K, present_K):
                if first_K != operator.u:
                    operator.step(first_K)
                if last_K != first_K:
                    operator.step(last_K)
            bounds.append((low.y, high.y))
        return bounds


class _PreisachModels:
    def __init__(
        self, actuator: Actuator, surface: Everett, temperature: TemperatureBounds, heats: list[float]
    ) -> None:
        self._actuator, self._temperature = actuator, temperature
        self._bands = list(pairwise(heats))
        self._wires = _Enclosures(surface, self._bands)
        self._like = [_Enclosures(surface, self._bands, lags) for lags in LAG_BANDS]
        self._phases = [WirePhases(surface) for _ in range(2)] if actuator.two_wire else []
        self._y_lower = surface.y_lower
        self._stroke = surface.everett(surface.upper, surface.lower)

    def add(self, current_A: float) -> None:
        del current_A  # the temperature has it

    def advance(self) -> tuple[Bands, Bands]:
        temperature = self._temperature
        bounds = self._wires.advance(temperature)
        like = [pair for wires in self._like for pair in wires.advance(temperature)]
        temperature.forget_extremes()
        wires = temperature.coldest_K, temperature.hottest_K
        for phases, wires_K, heat in zip(self._phases, wires, (self._bands[0][0], self._bands[-1][1])):
            phases.step([heat * wire_K for wire_K in wires_K])
        return bounds, like

    def ohm(self, current_A: float) -> tuple[float, float]:
        if self._phases:
            wire = 1 if current_A < 0 else 0
            shares = [phases.fraction(wire) for phases in self._phases]
        else:
            shares = [
                (operator.y - self._y_lower) / self._stroke
                for operator in (self._wires.low[0], self._wires.high[-1])
            ]
        a, b = (self._actuator.resistance_at_ohm(share) for share in shares)
        return min(a, b), max(a, b)


class _ThermomechanicalModels:
    """Wires of Brinson's model, each with its own heat balance."""

    def __init__(
        self,
        actuator: Actuator,
        beat_s: float,
        heats: list[float],
        ambient_degC: float,
        force_N: float | None,
    ) -> None:
        self._plants = [ThermomechanicalPlant(actuator, beat_s, ambient_degC, force_N) for _ in heats]
        self._factors = [math.sqrt(heat) for heat in heats]
        self._n, self._square_A2 = 0, 0.0

    def add(self, current_A: float) -> None:
        self._n += 1
        self._square_A2 += math.copysign(current_A * current_A, current_A)

    def advance(self) -> tuple[Bands, Bands]:
        square = self._square_A2 / self._n
        current_A = math.copysign(math.sqrt(abs(square)), square)
        self._n, self._square_A2 = 0, 0.0
        positions = [plant.step(factor * current_A) for plant, factor in zip(self._plants, self._factors)]
        bounds = [(min(pair), max(pair)) for pair in pairwise(positions)]
        return bounds, bounds

    def ohm(self, current_A: float) -> tuple[float, float]:
        ohms = [plant.resistance_ohm(current_A) for plant in self._plants]
        return min(ohms), max(ohms)


class WireBounds:
    """``step(current_A)`` advances. ``positions``: for each group of like wires the bounds in counts, or None between
    two beats, at which they are computed. A group shares its heat and its stroke within a band of the tolerance.
    """

    def __init__(
        self,
        actuator: Actuator,
        period_s: float,
        position_per_count: float,
        tolerance: float,
        ambient_degC: float,
        force_N: float | None = None,
    ) -> None:
        surface = actuator.hysteresis
        thermomechanical = actuator.file.thermomechanical
        self.temperature = TemperatureBounds(actuator, period_s, tolerance)
        self._beat = max(1, round(actuator.tau_s / BEATS_PER_TAU / period_s))
        self.lag = -math.expm1(-self._beat * period_s / (SENSOR_LAG_TAUS * actuator.tau_s))
        self._ticks, self._per_count = 0, position_per_count
        self._strokes = list(pairwise(_edges(tolerance, STROKE_BANDS)))
        if thermomechanical is None:
            heats = _edges(tolerance, HEAT_BANDS)
            self._models: _Models = _PreisachModels(actuator, surface, self.temperature, heats)
            travel = actuator.stroke
            steepest = steepest_per_K(surface)
            self._from = 0.0 if actuator.two_wire else surface.y_lower
        else:
            heats = _edges(tolerance, THERMOMECHANICAL_BANDS)
            beat_s = self._beat * period_s
            self._models = _ThermomechanicalModels(actuator, beat_s, heats, ambient_degC, force_N)
            travel, self._from = thermomechanical_travel(actuator), 0.0
            steepest = travel * math.pi / 2 / thermomechanical.width_K  # of a cosine
        self.kinds = (len(heats) - 1) * len(self._strokes)
        self.stroke = travel / position_per_count
        self.counts_per_K = RATE_FACTOR * steepest / position_per_count  # no wire is steeper
        self._readings: Bands = []
        self._like: Bands = []
        self._least_stroke = self._strokes[0][0]
        self._ohm: dict[int, tuple[float, float]] = {}  # of each wire, at the last beat
        self.positions: list[tuple[float, float]] | None = None

    def step(self, current_A: float) -> float:
        """Advance one tick at a constant current. The fastest change of any wire in it, in kelvin."""
        temperature = self.temperature
        temperature.step(current_A)
        self._models.add(current_A)
        self._ticks += 1
        self.positions = None
        if self._ticks >= self._beat:
            self._ticks = 0
            self._ohm = {}
            bounds, like = self._models.advance()
            self._readings = self._lagging(bounds, self._readings or bounds)
            self._like = self._lagging(like, self._like or like)
            self.positions = self._in_counts(self._readings)
        return temperature.rate_K

    @property
    def like_positions(self) -> Bands:
        """The bounds at the last beat for each group of wires that are alike in heat and time constants, with the
        least stroke.
        """
        per_unit = self._least_stroke / self._per_count
        return [(low * per_unit, high * per_unit) for low, high in self._like]

    def resistance_ohm(self, current_A: float) -> tuple[float, float]:
        """Bounds of the resistance of the wire that carries this current, at the last beat."""
        wire = 1 if current_A < 0 else 0
        if wire not in self._ohm:
            self._ohm[wire] = self._models.ohm(current_A)
        return self._ohm[wire]

    def _in_counts(self, readings: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Bounds in counts of wires whose stroke is between two shares of the nominal one."""
        from_, per_count = self._from, self._per_count
        moved = [(low - from_, high - from_) for low, high in readings]
        return [
            (
                low * (least if low > 0 else largest) / per_count,
                high * (largest if high > 0 else least) / per_count,
            )
            for low, high in moved
            for least, largest in self._strokes
        ]

    def _lagging(self, now: Bands, before: Bands) -> Bands:
        """A sensor may still show what was: its bounds retreat at once and advance slowly."""
        lag = self.lag
        return [
            (
                low if low < low_before else low_before + lag * (low - low_before),
                high if high > high_before else high_before + lag * (high - high_before),
            )
            for (low, high), (low_before, high_before) in zip(now, before)
        ]


def _edges(tolerance: float, bands: int) -> list[float]:
    return np.linspace(1 - tolerance, 1 + tolerance, bands + 1).tolist()


def steepest_per_K(surface: Everett) -> float:
    """The largest slope of both branches of the major loop, in the unit of position per kelvin."""
    u = np.linspace(surface.lower, surface.upper, 201)
    wire = Preisach(surface, "negative")
    rising, falling = (
        wire.simulate(u, "negative"),
        wire.simulate(np.concatenate([u, u[::-1]]), "negative")[201:],
    )
    return float(max(np.abs(np.diff(rising)).max(), np.abs(np.diff(falling)).max()) / (u[1] - u[0]))
