"""Set-point regulation as a protocol (Fig. 8.4): approach a state with the wanted output, close the loop, hold.

The state is B_ℓ with ℓ = ψʳ(y). For comparison it may be reached on an outer branch instead, rising from negative or
falling from positive saturation, which is the usual way to a set-point. The encoder is incremental, so negative
saturation is visited first: the position there is y₋. The loop may be disturbed by a pulse on the control input, in
kelvin of source temperature. The protocol ends at zero current.
"""

from collections.abc import Callable, Generator
from typing import Any, Literal

from smarig.control.current_limits import limited_current, ramp_to_zero
from smarig.control.divergence_monitor import DivergenceLimits, DivergenceMonitor
from smarig.control.regulation.anhysteretic_output import Psi
from smarig.control.regulation.approach import ApproachPlan, plan_approach
from smarig.control.regulation.sensor_plausibility import SensorPlausibility
from smarig.control.regulation.setpoint_pi import SetpointController, SetpointPI
from smarig.control.sensing.resistance_feedback import ResistanceFeedback
from smarig.core import (
    Command,
    Drive,
    Elapsed,
    Hold,
    Mark,
    Protocol,
    Quality,
    Sample,
    Settled,
    UsageError,
    Waveform,
)
from smarig.preisach import Everett, Preisach, State
from smarig.protocols import Setup

StartState = Literal["diagonal", "ascending", "descending"]
START_STATES: tuple[StartState, ...] = ("diagonal", "ascending", "descending")
# labels of marks
REGULATION_PLANNED, SETPOINT_DISTURBED = "regulate", "disturbance"
SETPOINT_LOOP_CLOSED, SETPOINT_LOOP_OPENED = "loop closed", "loop opened"
PULSE_TAUS, QUIET_S = 4.0, 60.0
LONGEST_S = 24 * 3600.0
OUTPUT_WITHIN = 0.005  # of the output range: a larger error would make the loop change the state
_COOL_TAUS = 8.0
_REST_TAUS = 10.0  # of a hold without an encoder
_PSI_POINTS = 128  # approximate number of recorded points of ψ


def regulate(
    setup: Setup,
    *,
    hysteresis: Everett,
    setpoint: float,
    within: float = 0.01,
    hold_s: float = 600.0,
    start: StartState = "diagonal",
    loop: SetpointController | None = None,
    settle: Settled | None = None,
    disturbance_K: float = 0.0,
    quiet_s: float = QUIET_S,
    pulse_s: float | None = None,
    feedback: ResistanceFeedback | None = None,
) -> Protocol:
    """Bring the wire to a state whose output is ``setpoint`` and hold it there in closed loop (§8.3).

    ``setpoint`` is in the unit of the model's output, y₋ to y₊; ``within`` is the allowed distance of the approach from
    B_ℓ, a share of the plane. After ``quiet_s`` of the ``hold_s`` in closed loop, ``disturbance_K`` is added to the
    source for ``pulse_s`` (default 4 τ). ``loop`` replaces the default PI. With ``feedback`` the position is that of
    the wire's resistance. The encoder is then only recorded, and holds last 10 τ, because nothing shows when they have
    settled. An unreachable set-point is refused at the first command, before any current flows. Raises LimitExceeded if
    the loop diverges or readings are implausible.
    """
    settle = settle or Settled()
    pulse_s = PULSE_TAUS * setup.tau_s if pulse_s is None else pulse_s
    check_times(setup, hold_s, disturbance_K, quiet_s, pulse_s)
    check_saturation(setup, hysteresis, start)
    rest = settle if feedback is None else Elapsed(_REST_TAUS * setup.tau_s)
    approach_waveform, state, facts = _approach_to_state(setup, hysteresis, setpoint, within, start, rest)
    rest_K = state.u
    yield Mark(REGULATION_PLANNED, {"setpoint": setpoint, "start": start, "rest_K": rest_K} | facts)
    result = yield Hold(setup.current_for(setup.lower_K), rest, target=setup.lower_K, branch="reference")
    encoder_offset = hysteresis.y_lower - result.position if result is not None else 0.0
    if approach_waveform is not None:
        yield approach_waveform
    yield Hold(setup.current_for(rest_K), rest, target=rest_K, branch="arrive")
    if feedback is not None:
        _predict_approach(feedback, setup, approach_waveform, rest_K)

    def disturbance_at(t_s: float) -> float:
        return disturbance_K if quiet_s <= t_s < quiet_s + pulse_s else 0.0

    monitors = (
        SensorPlausibility(setup, hysteresis, state, "encoder" if feedback is None else "resistance"),
        DivergenceMonitor(DivergenceLimits(), _reach(setup, hysteresis)),
    )
    loop = loop or SetpointPI.for_model(setup, hysteresis)
    last_A = yield from _closed_loop(
        setup=setup,
        loop=loop,
        monitors=monitors,
        rest_K=rest_K,
        wanted=(setpoint, setpoint - encoder_offset),
        hold_s=hold_s,
        disturbance_at=disturbance_at,
        feedback=feedback,
    )
    yield from ramp_to_zero(setup, last_A)
    yield Hold(0.0, Elapsed(_COOL_TAUS * setup.tau_s), branch="cool")


def _predict_approach(
    feedback: ResistanceFeedback, setup: Setup, approach: Waveform | Hold | None, rest_K: float
) -> None:
    """Bring the observer to the state of the wire after the approach, whose samples a protocol does not see."""
    rest_s = _REST_TAUS * setup.tau_s
    feedback.predict(setup.current_for(setup.lower_K), rest_s)
    if isinstance(approach, Waveform):
        for current_A in approach.currents_A:
            feedback.predict(current_A, approach.period_s)
    elif approach is not None:
        feedback.predict(approach.current_A, rest_s)
    feedback.predict(setup.current_for(rest_K), rest_s)


def check_times(
    setup: Setup, hold_s: float, disturbance_K: float, quiet_s: float = QUIET_S, pulse_s: float | None = None
) -> None:
    """Raise UsageError for negative times, a hold shorter than a tick, or a disturbance that does not fit."""
    pulse_s = PULSE_TAUS * setup.tau_s if pulse_s is None else pulse_s
    pulse_s = pulse_s if disturbance_K else 0.0
    if hold_s > LONGEST_S:
        raise UsageError(
            f"A hold of {hold_s:g} s is longer than {LONGEST_S / 3600:g} h. Divide it into several holds."
        )
    if not (hold_s >= 0 and quiet_s >= 0 and pulse_s >= 0):
        raise UsageError(
            f"Times must not be negative: hold {hold_s:g}, quiet {quiet_s:g}, pulse {pulse_s:g} s."
        )
    if hold_s < setup.period_s:
        raise UsageError(f"A hold of {hold_s:g} s is shorter than a tick of this rig, {setup.period_s:g} s.")
    if pulse_s and not quiet_s + pulse_s < hold_s:
        raise UsageError(
            f"The disturbance ends {quiet_s + pulse_s:g} s after the loop is closed, the hold after {hold_s:g} s. "
            "Give a longer hold_s."
        )


def check_saturation(setup: Setup, hysteresis: Everett, start: StartState) -> None:
    """Raise UsageError if a rig's limits do not reach the saturation in which a path starts: its output is unknown."""
    h, span = hysteresis, abs(hysteresis.everett(hysteresis.upper, hysteresis.lower))
    low = abs(span - h.everett(h.upper, max(setup.lower_K, h.lower)))
    high = abs(span - h.everett(min(setup.upper_K, h.upper), h.lower))
    for name, output_missed, reached_K, required_K in (
        ("negative", low, setup.lower_K, h.lower),
        ("positive", high if start == "descending" else 0.0, setup.upper_K, h.upper),
    ):
        if output_missed > OUTPUT_WITHIN * span:
            raise UsageError(
                f"The path to the set-point starts in {name} saturation, at {required_K:.4g} K. This rig's limits "
                f"reach {reached_K:.4g} K only, so {100 * output_missed / span:.1f} % of the output range is unknown."
            )


def _reach(setup: Setup, hysteresis: Everett) -> tuple[float, float]:
    high, low = Preisach(hysteresis, "negative").simulate([setup.upper_K, setup.lower_K])
    return float(low), float(high)


def _approach_to_state(
    setup: Setup,
    hysteresis: Everett,
    setpoint: float,
    within: float,
    start: StartState,
    rest: Settled | Elapsed,
) -> tuple[Waveform | Hold | None, State, dict[str, Any]]:
    """The command from negative saturation to the start of the last move, the state at rest after that move, and the
    facts for the record.
    """
    psi = Psi(hysteresis)
    if start == "diagonal":
        ell = float(psi.right_inverse(setpoint))
        found = plan_approach(setup, hysteresis, ell, within, OUTPUT_WITHIN)
        y = float(psi(ell))
        return found.waveform(), State((ell,), (y,), ell, y, True), _psi_facts(psi) | _planned_facts(found, y)
    if start not in ("ascending", "descending"):
        raise UsageError(f"Unknown start '{start}'. Give diagonal, ascending or descending.")
    up = start == "ascending"
    outer = Preisach(hysteresis, "negative" if up else "positive")
    outer.step(outer.inverse(setpoint))
    saturate = Hold(setup.current_for(setup.upper_K), rest, target=setup.upper_K, branch="saturate")
    return None if up else saturate, outer.state, _psi_facts(psi)


def _psi_facts(psi: Psi) -> dict[str, Any]:
    """The plane and ψ on it, so that the record can be drawn without the model."""
    ell, y = psi.curve
    thin = slice(None, None, max(1, ell.size // _PSI_POINTS))
    return {
        "lower_K": psi.lower,
        "upper_K": psi.upper,
        "psi_ell_K": [*ell[thin].tolist(), float(ell[-1])],
        "psi": [*y[thin].tolist(), float(y[-1])],
    }


def _planned_facts(plan_: ApproachPlan, output: float) -> dict[str, Any]:
    """The predictions for the approach to B_ℓ; areas in K²."""
    return {
        "ell_K": plan_.ell,
        "output": output,
        "predicted_distance_K2": plan_.predicted_distance,
        "area_K2": plan_.area,
        "predicted_output_error_share": plan_.output_error,
        "cycles": plan_.cycles,
        "wave_s": plan_.wave_s,
        "approach_s": plan_.duration_s,
        "predicted_boundary": [list(point) for point in plan_.plane.points(plan_.predicted_boundary)],
    }


def _closed_loop(
    setup: Setup,
    loop: SetpointController,
    monitors: tuple[SensorPlausibility, DivergenceMonitor],
    rest_K: float,
    wanted: tuple[float, float],
    hold_s: float,
    disturbance_at: Callable[[float], float],
    feedback: ResistanceFeedback | None,
) -> Generator[Command, Any, float]:
    """The loop, one tick at a time; marks record changes of the disturbance. Returns the last current.

    ``wanted``: the set-point on the model's scale, and on that of the encoder.
    """
    sensor_plausibility, divergence_monitor = monitors
    loop.start(rest_K)
    used = {} if feedback is None else {"feedback": "resistance", "wanted_observed": wanted[0]}
    yield Mark(SETPOINT_LOOP_CLOSED, {"wanted_position": wanted[1]} | used)
    source_K, pushed_K = rest_K, 0.0
    current_A = setup.current_for(rest_K)
    for k in range(round(hold_s / setup.period_s)):
        pushed_before_K, pushed_K = pushed_K, disturbance_at(k * setup.period_s)
        if pushed_K != pushed_before_K:
            yield Mark(SETPOINT_DISTURBED, {"source_K": pushed_K})
        commanded_K = min(max(source_K + pushed_K, setup.lower_K), setup.upper_K)
        current_A = limited_current(setup, setup.current_for(commanded_K), current_A)
        sample: Sample | None = yield Drive(current_A)
        if sample is not None and (feedback is not None or not sample.quality & Quality.STALE):
            position = sample.position if feedback is None else feedback.observe(sample)
            error = (wanted[1] if feedback is None else wanted[0]) - position
            sensor_plausibility.check(source_K, position, error)
            if not pushed_K:  # a disturbed loop does not diverge
                divergence_monitor.check(sample.t_s, error)
            source_K = loop.step(error)
        if feedback is not None:
            yield from feedback.blocks()
    if feedback is not None:
        yield from feedback.blocks(last=True)
    yield Mark(SETPOINT_LOOP_OPENED)
    return current_A
