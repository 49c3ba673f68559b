"""Velocity feedback on a rig: the controller of ``loop`` as a protocol, and what the rig does to its theorem.

The controller asks for a temperature, u = ũ + u_o; the current follows by the steady law (5.3), within the limits.
Velocity comes from counts, one difference per tick through a first-order filter. The current of a tick is
decided from the samples before it. So Thm 8.2's algebra does not hold here; ``RigLoopResult`` says which of its
hypotheses are kept, which are not, and what the error's norm was all the same. Knows samples; refuses to know
whether a twin or hardware gave them.
"""

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from smarig.certify.hypothesis import Hypothesis, failing
from smarig.certify.velocity.stability import k_e, stability
from smarig.control.current_limits import limited_current
from smarig.control.velocity.velocity_controller import VelocityController
from smarig.core.command import Command, Drive, Mark
from smarig.core.errors import UsageError
from smarig.core.sample import Sample
from smarig.preisach.everett import Everett
from smarig.protocols._setup import Setup
from smarig.protocols.initialise import initialise as initialise_wire

Array = NDArray[np.float64]
ROUNDING_K = 1e-9  # between a temperature asked for and that of the current which makes it


@dataclass(frozen=True, eq=False)
class RigLoopResult:
    """What a loop on a rig did, (n,) each: ``rate`` ṙ, ``offset`` u_o, ``velocity`` as filtered, ``commanded_K`` u, ``applied_K``
    the temperature the current stands for, ``position``. ``hypotheses`` are Thm 8.2's, as this rig keeps them.
    """

    controller: VelocityController
    dt_s: float
    rate: Array
    offset: Array
    velocity: Array
    commanded_K: Array
    applied_K: Array
    position: Array
    hypotheses: tuple[Hypothesis, ...]

    @property
    def k_e(self) -> float:
        """The bound of the loop without delay."""
        return k_e(self.controller)

    @property
    def ratio(self) -> float:
        """‖ṙ − v‖/(‖ṙ‖ + ‖u_o‖) over the run, v the filtered velocity; NaN when nothing drove the loop."""
        return self._ratio(self.velocity)

    @property
    def raw_ratio(self) -> float:
        """The same with v the plain differences of positions: encoder noise and quantum included."""
        return self._ratio(np.diff(self.position, prepend=self.position[0]) / self.dt_s)

    @property
    def clipped_share(self) -> float:
        """Share of samples at which the limits gave another input than was asked for."""
        return float(np.mean(np.abs(self.commanded_K - self.applied_K) > ROUNDING_K))

    def _ratio(self, velocity: Array) -> float:
        drive_norm = np.linalg.norm(self.rate) + np.linalg.norm(self.offset)
        return float(np.linalg.norm(self.rate - velocity) / drive_norm) if drive_norm else math.nan

    @property
    def text(self) -> str:
        """The plain statement for a report."""
        lines = [
            f"Measured ‖ė‖ = {self.ratio:.4g} (‖ṙ‖ + ‖u_o‖) against k_e = {self.k_e:.4g}, which is proved for the "
            "operator without delay, noise and quantum, not for this rig.",
            *(h.text for h in failing(self.hypotheses)),
        ]
        return " ".join(lines)

    def data(self) -> dict[str, Any]:
        """For a mark in the record: plain values."""
        return {
            "ratio": _finite_or_none(self.ratio),
            "raw_ratio": _finite_or_none(self.raw_ratio),
            "k_e": self.k_e,
            "delta": self.controller.delta,
            "gamma": self.controller.gamma,
            "clipped_share": self.clipped_share,
            "hypotheses": [{"name": h.name, "holds": h.holds, "why": h.why} for h in self.hypotheses],
        }


def _finite_or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


def velocity_feedback(
    setup: Setup,
    controller: VelocityController,
    rate: Sequence[float],
    offset: float | Sequence[float] = 0.0,
    *,
    initialise: Literal["none", "planned", "thesis"] = "none",
    filter_s: float | None = None,
    model: Everett | None = None,
) -> Generator[Command, Any, RigLoopResult]:
    """Drive a rig along velocities ``rate`` (one a tick, rig unit per second), and return the ``RigLoopResult``.

    ``offset`` u_o in kelvin (one, or one a tick) makes up for what the controller does not start from: an ambient
    that has drifted since the identification, or a temperature other than zero at the start. ``initialise``
    brings the wire to its initial state first (u(0) = 0, §5.2.2). ``filter_s`` is the time constant of the
    velocity filter, by default ten ticks; with a ``model`` the outcome says what Thm 8.2 asks of that, too. Yields
    Drive commands and wants Samples in answer.
    """
    rates = [float(r) for r in rate]
    offsets = [float(offset)] * len(rates) if isinstance(offset, int | float) else [float(o) for o in offset]
    if not rates or len(rates) != len(offsets) or not np.isfinite([*rates, *offsets]).all():
        raise UsageError("Velocity feedback needs a finite rate for every tick, and one offset or as many.")
    filter_s = 10 * setup.period_s if filter_s is None else filter_s
    if not filter_s >= 0:
        raise UsageError(f"filter_s must not be negative, got {filter_s:g}.")
    if initialise != "none":
        yield from initialise_wire(setup, method=initialise)
    yield Mark("velocity_feedback", {"delta": controller.delta, "gamma": controller.gamma})
    signals = yield from _drive(setup, controller, rates, offsets, filter_s)
    velocity, commanded_K, applied_K, position = signals
    clipped = float(np.mean(np.abs(commanded_K - applied_K) > ROUNDING_K))
    hypotheses = (
        *_model_hypotheses(model, controller),
        *_rig_hypotheses(setup, controller, filter_s, clipped),
    )
    result = RigLoopResult(
        controller,
        setup.period_s,
        np.array(rates),
        np.array(offsets),
        velocity,
        commanded_K,
        applied_K,
        position,
        hypotheses,
    )
    yield Mark("velocity_feedback_outcome", result.data())
    return result


def _drive(
    setup: Setup, controller: VelocityController, rates: list[float], offsets: list[float], filter_s: float
) -> Generator[Command, Any, Array]:
    """Velocities, asked and given inputs, positions, shape (4, n)."""
    running, signals = controller.start(setup.period_s), np.empty((4, len(rates)))
    share = setup.period_s / (setup.period_s + filter_s)
    velocity, position, current_A = 0.0, math.nan, 0.0
    for k, (rate, offset) in enumerate(zip(rates, offsets, strict=True)):
        error = rate - velocity
        commanded_K = running.output(error) + offset
        running.advance(error)
        current_A = limited_current(setup, setup.current_for(commanded_K), current_A)
        applied_K = setup.actuator.input_for(current_A)
        sample: Sample = yield Drive(current_A)
        moved = 0.0 if math.isnan(position) else sample.position - position
        velocity += share * (moved / setup.period_s - velocity)
        position = sample.position
        signals[:, k] = velocity, commanded_K, applied_K, position
    return signals


def _model_hypotheses(model: Everett | None, controller: VelocityController) -> tuple[Hypothesis, ...]:
    if model is None:
        return (Hypothesis("passive", None, "no model was given"),)
    return stability(model, controller, "negative" if model.lower >= 0 else "anhysteretic").hypotheses


def _rig_hypotheses(
    setup: Setup, controller: VelocityController, filter_s: float, clipped: float
) -> tuple[Hypothesis, ...]:
    """What Thm 8.2 asks, and what this rig makes of it."""
    low, high = setup.lower_K, setup.upper_K
    return (
        Hypothesis(
            "supply rate at the current",
            True,
            f"a current sets where the wire would settle, not where it is (τ = {setup.tau_s:.3g} s), but the wire "
            "moves towards it and the output with the wire, which only adds to the supplied energy",
        ),
        Hypothesis(
            "input as asked for",
            clipped == 0.0,
            f"the limits ({low:.4g} … {high:.4g} K{_one_sided(low)}) gave another in {clipped:.1%} of the samples; "
            "passivity survives that, the reference may be out of reach",
        ),
        Hypothesis(
            "no delay",
            False,
            f"a tick of {setup.period_s:g} s passes between velocity and current: at the highest frequency it turns "
            f"H₁ into −H₁, so its δ is at most −{controller.delta:.4g}",
        ),
        Hypothesis(
            "velocity as it is",
            False,
            f"it comes from differences of counts ({setup.actuator.unit} per tick) through a filter of {filter_s:g} s, "
            "with noise that no reference drives: the ratio grows when ṙ and u_o are small",
        ),
    )


def _one_sided(low: float) -> str:
    return ", cooling no faster than the wire cools by itself" if low >= 0 else ""
