"""Plans the approach to B_ℓ (§8.3, Thm 8.3) for the *wire*, with heating lag, limits and one-sided current.

    u_ℓ(t) = (1 − t/t₁) A sin(ωt) + ℓ        (8.2), with sin(ωt) for the printed sin(ω)

The wire first visits both limits, which wipes out all memory (a sine that decays from the start does not, theory.md
erratum 9). A therefore need only be the smaller of u₊ − ℓ and ℓ − u₋, the part of B_ℓ inside the range, and the
sinusoid starts at the last limit. The source of each tick brings the wire to its target temperature as far as limits
and cooling allow. The wire's response is simulated tick by tick; its extrema are the memory, and d(B, B_ℓ) is the area
between the boundaries. In closed form, 2N reversals, each A/2N closer, leave 2N triangles of that side, A²/4N;
clipping by the limits adds to it.
"""

import math
from dataclasses import dataclass

import numpy as np

from smarig.control.argument_checks import positive
from smarig.control.regulation.boundary_plane import BoundaryPlane, turning_points
from smarig.core import Array, UsageError, Waveform
from smarig.plant import temperature_along
from smarig.preisach import Everett, Preisach
from smarig.protocols import Setup
from smarig.theory import Boundary

RELATIVE_FREQUENCIES = (
    1.6,
    1.1,
    0.8,
    0.6,
    0.45,
    0.3,
)  # ωτ: a faster sinusoid needs √(1 + ω²τ²) times the amplitude
MAX_CYCLES = 400
MAX_APPROACH_S = 6 * 3600.0
_MEMORY_LEFT_SHARE = 0.1  # of the allowed distance, for earlier memory
_GROWTH = 1.12


@dataclass(frozen=True)
class ApproachPlan:
    """Currents that bring the wire from any state close to B_ℓ, and the predicted distance.

    ``currents_A`` has one value per ``period_s``; ``cycles`` N and ``wave_s`` belong to the sinusoid. Distances are
    areas of the Preisach plane, K²: ``predicted_distance`` of the simulated wire from B_ℓ, ``closed_form`` A²/4N of a
    sinusoid that is followed exactly, ``memory_left`` the largest effect of earlier memory; ``area`` = 2û² is the
    largest distance. ``output_error`` is the predicted output minus ψ(ℓ) as a share of the output range: the area
    counts all relays equally, the output counts them by weight. ``predicted_boundary`` is in the coordinates of
    ``plane``.
    """

    ell: float
    plane: BoundaryPlane
    currents_A: tuple[float, ...]
    period_s: float
    cycles: int
    wave_s: float
    amplitude: float
    predicted_distance: float
    predicted_boundary: Boundary
    closed_form: float
    memory_left: float
    output_error: float
    temperature_K: Array

    @property
    def area(self) -> float:
        """2û², the area of P_r."""
        return self.plane.area

    @property
    def duration_s(self) -> float:
        """Duration, including the visits to the limits."""
        return len(self.currents_A) * self.period_s

    @property
    def share(self) -> float:
        """The predicted distance as a share of 2û²."""
        return self.predicted_distance / self.area

    def is_near(self, allowed: tuple[float, float]) -> bool:
        """Whether distance and output error are within the allowed shares."""
        return self.share <= allowed[0] and abs(self.output_error) <= allowed[1]

    def waveform(self) -> Waveform:
        """The approach as one command."""
        return Waveform(self.currents_A, self.period_s, branch="approach")

    def text(self) -> str:
        """The plan in one sentence."""
        return (
            f"To B_ℓ with ℓ = {self.ell:.1f} K in {self.duration_s / 60:.0f} min: both limits, then {self.cycles} "
            f"cycles of {self.wave_s:.0f} s from ±{self.amplitude:.1f} K; predicted distance "
            f"{100 * self.share:.2f} % of the plane ({100 * self.closed_form / self.area:.2f} % without lag)."
        )


def plan_approach(
    setup: Setup, hysteresis: Everett, ell: float, within: float = 0.01, output_within: float = 1.0
) -> ApproachPlan:
    """The shortest approach found whose predicted distance is at most ``within``, a share of 2û².

    ``output_within`` also limits the output error to a share of its range (1: no limit).

    For each relative frequency ωτ of a short list, the smallest sufficient number of cycles is found. Raises UsageError
    if ℓ is not an input of the hysteresis, if the limits do not reach its saturation, or if no sinusoid suffices.
    """
    plane = BoundaryPlane.of(hysteresis)
    _check(setup, plane, ell, within)
    reach = _reach(setup, plane)
    old_memory_area = _memory_left(plane, reach)
    if old_memory_area > within * plane.area:
        raise UsageError(
            f"The rig's limits allow {reach[0]:.1f} to {reach[1]:.1f} K; the hysteresis reaches from "
            f"{plane.lower:.1f} to {plane.upper:.1f} K. Memory beyond the limits cannot be wiped out and may leave the "
            f"state at a distance of {100 * old_memory_area / plane.area:.1f} % of the plane from B_ℓ. Widen the "
            f"limits, or allow more than {100 * within:.1f} %."
        )
    candidates: list[ApproachPlan] = []
    at_most_s = MAX_APPROACH_S
    for relative_frequency in RELATIVE_FREQUENCIES:
        candidates.append(
            _fewest_cycles(setup, hysteresis, ell, (within, output_within), relative_frequency, at_most_s)
        )
        if candidates[-1].is_near((within, output_within)):
            at_most_s = min(at_most_s, candidates[-1].cycles * candidates[-1].wave_s)
    acceptable = [p for p in candidates if p.is_near((within, output_within))]
    if acceptable:
        return min(acceptable, key=lambda p: p.duration_s)
    closest = min(candidates, key=lambda p: p.share)
    raise UsageError(
        f"No sinusoid brings the wire within {100 * within:.3g} % of B_ℓ, ℓ = {ell:.1f} K. The best of at most "
        f"{MAX_CYCLES} cycles and {MAX_APPROACH_S / 3600:.0f} h reaches {100 * closest.share:.2f} %, with an output "
        f"error of {100 * closest.output_error:.2f} % of the range. Allow a larger distance."
    )


def _check(setup: Setup, plane: BoundaryPlane, ell: float, within: float) -> None:
    positive("The period of a tick", setup.period_s)
    if not 0 < within < 1:
        raise UsageError(
            f"The allowed distance must be a share of the plane between 0 and 1, got {within:g}."
        )
    low, high = max(plane.lower, setup.lower_K), min(plane.upper, setup.upper_K)
    if not low - 1e-9 <= ell <= high + 1e-9:
        raise UsageError(
            f"ℓ = {ell:g} K is outside the common range of this rig and this hysteresis, {low:g}…{high:g} K."
        )


def _reach(setup: Setup, plane: BoundaryPlane) -> tuple[float, float]:
    return max(setup.lower_K, plane.lower), min(setup.upper_K, plane.upper)


def _memory_left(plane: BoundaryPlane, reach: tuple[float, float]) -> float:
    """The area of P_r that a sweep from end to end of ``reach`` does not cover."""
    return max(plane.area - 0.5 * (reach[1] - reach[0]) ** 2, 0.0)


def _fewest_cycles(
    setup: Setup,
    hysteresis: Everett,
    ell: float,
    allowed: tuple[float, float],
    relative_frequency: float,
    at_most_s: float,
) -> ApproachPlan:
    """The approach with the fewest cycles that is close enough, or the closest within the time limit."""
    plane = BoundaryPlane.of(hysteresis)
    low, high = _reach(setup, plane)
    area = allowed[0] * plane.area
    wave_s = 2 * math.pi * setup.tau_s / relative_frequency
    max_cycles = max(1, min(MAX_CYCLES, math.floor(at_most_s / wave_s)))
    cycles = min(max(1, math.ceil(min(high - ell, ell - low) ** 2 / 4 / area)), max_cycles)
    sweep_s = setup.tau_s * math.log(2 * plane.bound * (high - low) / (_MEMORY_LEFT_SHARE * area))
    best = _approach(setup, hysteresis, ell, cycles, wave_s, sweep_s)
    while not best.is_near(allowed):
        cycles = max(cycles + 1, math.ceil(cycles * _GROWTH))
        if cycles > max_cycles:
            break
        more_cycles = _approach(setup, hysteresis, ell, cycles, wave_s, sweep_s)
        if more_cycles.share > 0.99 * best.share and best.share > allowed[0]:
            break  # the rest of the distance comes from the limits, not from the cycles
        best = more_cycles
    return best


def _approach(
    setup: Setup, hysteresis: Everett, ell: float, cycles: int, wave_s: float, sweep_s: float
) -> ApproachPlan:
    plane = BoundaryPlane.of(hysteresis)
    low, high = _reach(setup, plane)
    amplitude = max(min(high - ell, ell - low), 0.0)
    limits = (high, low) if ell - low <= high - ell else (low, high)
    targets_K = _target_temperatures(
        setup=setup,
        limits=limits,
        ell=ell,
        amplitude=amplitude,
        cycles=cycles,
        wave_s=wave_s,
        sweep_s=sweep_s,
    )
    currents, wire_K = _following_currents(setup, targets_K)
    boundary = plane.boundary_after(wire_K)
    shortfall = (high - low) * math.exp(-sweep_s / setup.tau_s)  # at each limit, for any initial temperature
    return ApproachPlan(
        ell=ell,
        plane=plane,
        currents_A=tuple(currents.tolist()),
        period_s=setup.period_s,
        cycles=cycles,
        wave_s=wave_s,
        amplitude=amplitude,
        predicted_distance=plane.distance(boundary, ell),
        predicted_boundary=boundary,
        closed_form=amplitude**2 / (4 * cycles),
        memory_left=_memory_left(plane, (low + shortfall, high - shortfall)),
        output_error=_output_error(hysteresis, wire_K, ell),
        temperature_K=wire_K,
    )


def _output_error(hysteresis: Everett, wire_K: Array, ell: float) -> float:
    """r(B) − ψ(ℓ) as a share of the range, after the response of the wire."""
    operator = Preisach(hysteresis, compiled=False)
    operator.follow(turning_points(wire_K))
    reached = operator.y
    span = hysteresis.everett(hysteresis.upper, hysteresis.lower)
    return (reached - operator.go_to_diagonal(ell)) / span if span else 0.0


def _target_temperatures(
    setup: Setup,
    limits: tuple[float, float],
    ell: float,
    amplitude: float,
    cycles: int,
    wave_s: float,
    sweep_s: float,
) -> Array:
    """Target temperatures at the end of each tick: one limit, the other, and the sinusoid from there."""
    sweep = np.repeat(limits, round(sweep_s / setup.period_s))
    side = 1.0 if limits[1] > ell else -1.0
    end_s = cycles * wave_s
    t = setup.period_s * np.arange(1, round(end_s / setup.period_s) + 1)
    envelope = side * amplitude * np.maximum(1 - t / end_s, 0.0)
    return np.concatenate([sweep, ell + envelope * np.cos(2 * math.pi * t / wave_s)])


def _following_currents(setup: Setup, targets_K: Array) -> tuple[Array, Array]:
    """Currents whose source brings a cold wire to each target within a tick, within limits, and the wire's response.

    T' = s + (T − s) e^(−dt/τ), solved for s; the differential rig's T₁ − T₂ obeys the same law with a signed s.
    """
    decay = math.exp(-setup.period_s / setup.tau_s)
    low, high, wire = setup.lower_K, setup.upper_K, 0.0
    sources_K, wire_temperatures_K = [], []
    for target_K in targets_K.tolist():
        source = min(max((target_K - wire * decay) / (1 - decay), low), high)
        wire = source + (wire - source) * decay
        sources_K.append(source)
        wire_temperatures_K.append(wire)
    s = np.array(sources_K)
    currents = np.copysign(np.sqrt(np.abs(s) / setup.actuator.gain_K_per_A2), s)
    currents = np.clip(currents, setup.limits.current_min_A, setup.limits.current_max_A)
    rate_A = setup.limits.current_rate_A_per_s * setup.period_s
    if np.max(np.abs(np.diff(currents, prepend=0.0))) <= rate_A:
        return currents, np.array(wire_temperatures_K)
    currents = _rate_limited(
        currents, rate_A
    )  # the wire lags slightly more than planned; the prediction includes this
    return currents, temperature_along(setup.actuator, currents, setup.period_s)


def _rate_limited(currents_A: Array, rate_A: float) -> Array:
    """The same currents, limited to steps of ``rate_A``, starting at zero."""
    now, allowed = 0.0, []
    for wanted in currents_A.tolist():
        now = min(max(wanted, now - rate_A), now + rate_A)
        allowed.append(now)
    return np.array(allowed)
