"""Velocity feedback on a rig (Fig. 8.2): a controller of the velocity error as a protocol, and its measurement.

    e_k = ṙ_k − v_{k−1},   ũ_k = H₁e,   u_k = ũ_k + u_o,   i_k = sgn(u_k) √(|u_k| hA/R), within the limits

The current follows from u by the steady law (5.3). v is the velocity of the readings: one difference of positions per
tick through a first-order filter. The current of a tick depends on earlier samples only, so the algebra of Thm 8.2
does not hold here; the protocol measures the ratio instead.
"""

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from smarig.control.argument_checks import not_negative
from smarig.control.current_limits import limited_current, ramp_to_zero
from smarig.control.tracking.reference import Reference
from smarig.control.tracking.tracking_protocol import TRACKING_LOOP_CLOSED, TRACKING_LOOP_OPENED
from smarig.control.velocity.velocity_controller import VelocityController
from smarig.core import Array, Command, Drive, Mark, Protocol, Sample, UsageError
from smarig.protocols import Setup
from smarig.protocols import initialise as initialise_wire

# Thm 8.2 for this loop, for the record, as a function of the share of clipped samples (None before it is measured).
Assessment = Callable[[float | None], Mapping[str, Any]]

VELOCITY_LOOP_STARTED, VELOCITY_LOOP_MEASURED = (
    "velocity_feedback",
    "velocity_feedback_outcome",
)  # labels of the marks
FILTER_TICKS = 10  # default time constant of the velocity filter
LEAD_IN_S = 20.0  # from the encoder's zero to the first position of a reference
ROUNDING_K = 1e-9  # between a commanded temperature and that of its current


@dataclass(frozen=True, eq=False)
class VelocityMeasurement:
    """Signals of a loop on a rig, (n,) each: ``rate`` ṙ, ``offset`` u_o, filtered ``velocity``, ``commanded_K`` u,
    ``applied_K`` the steady temperature of the current, ``position``, ``current_A``.
    """

    controller: VelocityController
    dt_s: float
    rate: Array
    offset: Array
    velocity: Array
    commanded_K: Array
    applied_K: Array
    position: Array
    current_A: Array

    @property
    def ratio(self) -> float:
        """‖ṙ − v‖/(‖ṙ‖ + ‖u_o‖) over the run, v the filtered velocity; NaN if nothing drove the loop."""
        return self._ratio(self.velocity)

    @property
    def raw_ratio(self) -> float:
        """The same ratio with plain differences of positions as v, including encoder noise and quantisation."""
        return self._ratio(np.diff(self.position, prepend=self.position[0]) / self.dt_s)

    @property
    def rest_ratio(self) -> float:
        """The ratio of a wire at rest: ‖ṙ‖/(‖ṙ‖ + ‖u_o‖), 1 without an offset."""
        return self._ratio(np.zeros_like(self.velocity))

    @property
    def bound_share(self) -> float:
        """‖ṙ − v‖ as a share of [(γ + δ)‖ṙ‖ + ‖u_o‖]/δ, Thm 8.2's bound from rest in any units; NaN like ``ratio``."""
        delta, gamma = self.controller.delta, self.controller.gamma
        bound = ((gamma + delta) * np.linalg.norm(self.rate) + np.linalg.norm(self.offset)) / delta
        return float(np.linalg.norm(self.rate - self.velocity) / bound) if bound else math.nan

    @property
    def clipped_share(self) -> float:
        """Share of samples at which the limits changed the commanded input."""
        return float(np.mean(np.abs(self.commanded_K - self.applied_K) > ROUNDING_K))

    def _ratio(self, velocity: Array) -> float:
        drive_norm = np.linalg.norm(self.rate) + np.linalg.norm(self.offset)
        return float(np.linalg.norm(self.rate - velocity) / drive_norm) if drive_norm else math.nan

    def data(self) -> dict[str, Any]:
        """Plain values for a mark in the record."""
        return {
            "ratio": _finite_or_none(self.ratio),
            "raw_ratio": _finite_or_none(self.raw_ratio),
            "rest_ratio": _finite_or_none(self.rest_ratio),
            "bound_share": _finite_or_none(self.bound_share),
            "clipped_share": self.clipped_share,
        }


def _finite_or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


class VelocityFilter:
    """v_k = v_{k−1} + c ((y_k − y_{k−1})/dt − v_{k−1}), c = dt/(dt + filter_s), from v = 0.

    >>> velocity = VelocityFilter(0.1, 0.1)
    >>> [round(velocity.after(position), 3) for position in (0.0, 1.0, 2.0)]
    [0.0, 5.0, 7.5]
    """

    def __init__(self, dt_s: float, filter_s: float) -> None:
        self._dt_s, self._share = dt_s, dt_s / (dt_s + filter_s)
        self._velocity, self._position = 0.0, math.nan

    def after(self, position: float) -> float:
        """The velocity after a position; 0 after the first one, which has no difference."""
        moved = 0.0 if math.isnan(self._position) else position - self._position
        self._velocity += self._share * (moved / self._dt_s - self._velocity)
        self._position = position
        return self._velocity


def with_lead_in(reference: Reference, seconds: float = LEAD_IN_S) -> Reference:
    """The reference after a straight line from zero, the encoder's position when the loop is closed.

    >>> with_lead_in(Reference("r", (0.0, 10.0), (3.0, 4.0))).t_s
    (0.0, 20.0, 30.0)
    """
    if reference.position[0] == 0:
        return reference
    t_s, position = (seconds + t for t in reference.t_s), reference.position
    return Reference(reference.name, (0.0, *t_s), (0.0, *position), reference.held)


def reference_rates(reference: Reference, dt_s: float) -> Array:
    """ṙ of each tick, (n,): the change of the reference in it, over ``dt_s``."""
    ticks = max(1, round(reference.duration_s / dt_s))
    return np.diff([reference.at(k * dt_s) for k in range(ticks + 1)]) / dt_s


def running_ratio(rate: Array, velocity: Array, offset: Array) -> Array:
    """‖ṙ − v‖_T/(‖ṙ‖_T + ‖u_o‖_T) up to every sample T, (n,); NaN while nothing drives the loop."""
    error, rates, offsets = (np.sqrt(np.cumsum(x**2)) for x in (rate - velocity, rate, offset))
    drive_norm = rates + offsets
    return np.divide(error, drive_norm, out=np.full_like(error, math.nan), where=drive_norm > 0)


def velocity_tracking(
    setup: Setup,
    controller: VelocityController,
    reference: Reference,
    offset_K: float = 0.0,
    *,
    name: str = "",
    filter_s: float | None = None,
    assess: Assessment | None = None,
) -> Protocol:
    """Initialise (§5.2.2), feed back the velocity along that of a reference, and open the loop.

    Only the velocity of the reference is followed; the position is not fed back. ``offset_K`` is u_o, ``name`` the
    controller's in the record; further arguments are those of ``velocity_feedback``.
    """
    yield from initialise_wire(setup)
    first: Sample = yield Drive(0.0)
    yield Mark(
        TRACKING_LOOP_CLOSED, {"controller": name, "start_s": first.t_s, "reference": reference.as_data()}
    )
    rates = reference_rates(reference, setup.period_s).tolist()
    measured = yield from velocity_feedback(
        setup, controller, rates, offset_K, filter_s=filter_s, assess=assess
    )
    yield Mark(TRACKING_LOOP_OPENED)
    yield from ramp_to_zero(setup, float(measured.current_A[-1]))


def velocity_feedback(
    setup: Setup,
    controller: VelocityController,
    rate: Sequence[float],
    offset: float | Sequence[float] = 0.0,
    *,
    initialise: Literal["none", "planned", "thesis"] = "none",
    filter_s: float | None = None,
    assess: Assessment | None = None,
) -> Generator[Command, Any, VelocityMeasurement]:
    """Drive a rig along velocities ``rate`` (one per tick, rig unit per second); returns the ``VelocityMeasurement``.

    ``offset`` u_o in kelvin (one, or one per tick) compensates initial conditions: an ambient that has drifted since
    the identification, or an initial temperature other than zero. ``initialise`` brings the wire to its initial state
    first (u(0) = 0, §5.2.2). ``filter_s`` is the time constant of the velocity filter, by default ten ticks. The marks
    at start and end contain the result of ``assess``. Yields Drive commands and receives Samples. Raises UsageError
    for invalid rates and offsets.
    """
    rates = [float(r) for r in rate]
    constant = isinstance(offset, int | float)
    offsets = [float(offset)] * len(rates) if isinstance(offset, int | float) else [float(o) for o in offset]
    if not rates or len(rates) != len(offsets) or not np.isfinite([*rates, *offsets]).all():
        raise UsageError(
            "Velocity feedback needs a finite rate for every tick, and one offset or one per tick."
        )
    filter_s = not_negative("filter_s", FILTER_TICKS * setup.period_s if filter_s is None else filter_s)
    if initialise != "none":
        yield from initialise_wire(setup, method=initialise)
    known = {
        "delta": controller.delta,
        "gamma": controller.gamma,
        "offset_K": offsets[0] if constant else None,
        "filter_s": filter_s,
    }
    yield Mark(VELOCITY_LOOP_STARTED, known | (dict(assess(None)) if assess else {}))
    signals = yield from _drive(setup, controller, rates, offsets, VelocityFilter(setup.period_s, filter_s))
    measured = VelocityMeasurement(controller, setup.period_s, np.array(rates), np.array(offsets), *signals)
    assessed = dict(assess(measured.clipped_share)) if assess else {}
    yield Mark(VELOCITY_LOOP_MEASURED, known | measured.data() | assessed)
    return measured


def _drive(
    setup: Setup,
    controller: VelocityController,
    rates: list[float],
    offsets: list[float],
    velocity_filter: VelocityFilter,
) -> Generator[Command, Any, Array]:
    """Velocities, commanded and applied inputs, positions and currents, shape (5, n)."""
    running, signals = controller.start(setup.period_s), np.empty((5, len(rates)))
    velocity, current_A = 0.0, 0.0
    for k, (rate, offset) in enumerate(zip(rates, offsets, strict=True)):
        error = rate - velocity
        commanded_K = running.output(error) + offset
        running.advance(error)
        current_A = limited_current(setup, setup.current_for(commanded_K), current_A)
        sample: Sample = yield Drive(current_A)
        velocity = velocity_filter.after(sample.position)
        signals[:, k] = (
            velocity,
            commanded_K,
            setup.actuator.input_for(current_A),
            sample.position,
            current_A,
        )
    return signals
