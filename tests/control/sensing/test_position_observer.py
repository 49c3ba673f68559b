"""The observer against the twin's own position: better than the model alone, honest intervals, ambiguity stated."""

import math

import numpy as np
import pytest

from control.model_files import model_of
from smarig.control import (
    ONE_WIRE_TERMS,
    TWO_WIRE_TERMS,
    PositionObserver,
    ResistanceFeedback,
    ResistanceMap,
    SelfSensing,
    map_terms,
    regulate,
)
from smarig.control.sensing.resistance_map import WireCondition
from smarig.core import DataError, Drive, Elapsed, Hold, LimitExceeded, StepResult, StepVerdict, Waveform
from smarig.plant import Actuator, EffectContext, Stage
from smarig.preisach import thesis_surface
from smarig.protocols import Setup
from smarig.rig import Twin

R_M, R_A = 5.0, 4.5  # gorbet_one_wire
STROKE = thesis_surface("one_e").everett(thesis_surface("one_e").upper, 0.0)


class HotterWire:
    """R/hA larger than the model's by a factor, which an observer does not know."""

    def __init__(self, factor):
        self.factor = factor

    def hooks(self, context: EffectContext):
        del context
        return {Stage.SOURCE: lambda source, _now: source * self.factor}


def by_hand(**other):
    """Self-sensing of the one-wire twin from its constants, as an exact identification would give it."""
    coefficients = {"1": R_M, "y": (R_A - R_M) / STROKE, "T": 0.0, "yT": 0.0}
    fields = {
        "wires": (ResistanceMap(coefficients, {}, 0.002, 10.0, 1000),),
        "noise_V": 0.0022,
        "least_A": 0.05,
        "input_error_K": 4.0,
        "output_error": 0.03,
        "output_time_s": 10.0,
        "lag_error": 0.01,
        "interval_factor": 1.0,
        "reading_factor": 1.0,
        "stroke": STROKE,
    }
    return SelfSensing(**(fields | other))


def observer(sensing=None):
    actuator = Actuator.named("gorbet_one_wire")
    return PositionObserver(sensing or by_hand(), actuator, thesis_surface("one_e"), "negative", 0.1)


def along(twin, currents):
    """True positions (n,) and observations of the twin at these currents."""
    watched, true, seen = observer(), [], []
    for current_A in currents:
        sample = twin.step(float(current_A))[0]
        true.append(twin.specimen.plant.position)
        seen.append(watched.step(sample.voltage_V, sample.current_A))
    return np.array(true), seen


def holds(*currents, ticks=250):
    return np.repeat(currents, ticks)


def test_terms_and_resistance_are_the_same_function():
    rng = np.random.default_rng(1)
    for names, two_wire in ((ONE_WIRE_TERMS, False), (TWO_WIRE_TERMS, True)):
        wire = ResistanceMap(dict(zip(names, rng.normal(size=len(names)))), {}, 0.1, 1.0, 10)
        for y, T, xi, cold in rng.normal(size=(20, 4)):
            state = WireCondition(T, xi, cold)
            by_terms = map_terms([y], [state], two_wire=two_wire) @ [wire.coefficients[n] for n in names]
            assert wire.ohm(y, state) == pytest.approx(float(by_terms[0]))
            slope = (wire.ohm(y + 0.5, state) - wire.ohm(y - 0.5, state)) / 1.0
            assert wire.per_position(state) == pytest.approx(slope)


def test_resistance_corrects_a_model_with_the_wrong_heating():
    twin = Twin.named("one_wire_twin", seed=4, effects=(HotterWire(1.06),))
    true, seen = along(twin, holds(0.45, 0.55, 0.35, 0.5, 0.62, 0.4))
    error = np.array([o.position for o in seen]) - true
    alone = np.array([o.predicted for o in seen]) - true
    half = np.array([o.half for o in seen])
    assert np.sqrt(np.mean(error**2)) < 0.3 * np.sqrt(np.mean(alone**2))
    assert np.mean(np.abs(error) <= half) >= 0.95
    assert np.median(half) < 0.03 * STROKE


def test_two_wires_are_corrected_by_the_phase_of_the_heated_one():
    hysteresis = thesis_surface("two_e")
    stroke = hysteresis.everett(hysteresis.upper, hysteresis.lower)
    coefficients = dict.fromkeys(TWO_WIRE_TERMS, 0.0) | {"1": 2.105, "xi": 1.895 - 2.105}
    wire = ResistanceMap(coefficients, {}, 0.001, 10.0, 1000)
    sensing = by_hand(wires=(wire, wire), input_error_K=8.0, output_error=0.1, stroke=stroke)
    twin = Twin.named("two_wire_twin", seed=5, effects=(HotterWire(1.06),))
    watched = PositionObserver(sensing, twin.actuator, hysteresis, "anhysteretic", 0.1)
    error, alone = [], []
    for current_A in holds(0.6, 0.75, -0.65, -0.5, 0.7, -0.7, ticks=200):
        sample = twin.step(float(current_A))[0]
        found = watched.step(sample.voltage_V, sample.current_A)
        error.append((found.position - twin.specimen.plant.position, found.half))
        alone.append(found.predicted - twin.specimen.plant.position)
    miss, half = np.array(error).T
    assert np.sqrt(np.mean(miss**2)) < 0.5 * np.sqrt(np.mean(np.square(alone)))
    assert np.mean(np.abs(miss) <= half) >= 0.95


def test_without_current_the_interval_grows_and_nothing_is_read():
    twin = Twin.named("one_wire_twin", seed=6)
    watched = observer()
    lit = [watched.step(s.voltage_V, s.current_A) for s in (twin.step(0.5)[0] for _ in range(600))]
    before = lit[-1]
    dark = [watched.step(math.nan, 0.5) for _ in range(400)]
    assert np.isfinite(before.reading)
    assert not before.ambiguous
    halves = [o.half for o in dark]
    assert np.all(np.diff(halves) > 0)
    assert halves[-1] > 2 * before.half
    assert all(o.ambiguous and math.isnan(o.reading) for o in dark)
    assert watched.step(0.0, 0.0).ambiguous


def test_readings_at_a_small_current_are_ambiguous_and_those_at_a_large_one_are_not():
    twin = Twin.named("one_wire_twin", seed=7)
    _, seen = along(twin, holds(0.06, 0.5, ticks=400))
    assert all(o.ambiguous for o in seen[:400])
    assert not any(o.ambiguous for o in seen[-300:])


def test_a_resistance_without_slope_gives_no_position_and_says_so():
    flat = {"1": R_M, "y": 0.0, "T": 0.001, "yT": 0.0}  # depends on the temperature alone
    sensing = by_hand(wires=(ResistanceMap(flat, {}, 0.002, 10.0, 1000),), input_error_K=0.5)
    watched, twin = observer(sensing), Twin.named("one_wire_twin", seed=8)
    seen = [watched.step(s.voltage_V, s.current_A) for s in (twin.step(0.5)[0] for _ in range(300))]
    assert seen[-1].ambiguous


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"noise_V": -1.0}, "not positive"),
        ({"noise_V": 1e308}, "above 1e"),
        ({"stroke": float("nan")}, "not positive"),
        ({"wires": []}, "0 wires"),
        ({"stroke": "long"}, "incomplete or wrong"),
        ({"wires": [{"coefficients": {"1": 5.0}}]}, "incomplete or wrong"),
    ],
)
def test_a_damaged_part_of_a_model_file_is_refused(change, words):
    good = by_hand().to_json()
    assert SelfSensing.from_json(good) == by_hand()
    with pytest.raises(DataError, match=words):
        SelfSensing.from_json(good | change)


def feedback():
    return ResistanceFeedback(observer(), 0.1)


def samples(twin):
    return (twin.step(0.5)[0] for _ in range(100))


def observe_all(loop, found):
    for sample in found:
        loop.observe(sample)


def test_a_contact_that_opens_ends_the_run():
    twin, loop = Twin.named("one_wire_twin", seed=9), feedback()
    observe_all(loop, samples(twin))
    opened = (s._replace(voltage_V=s.voltage_V + 1.0 * s.current_A) for s in samples(twin))  # 1 ohm more
    with pytest.raises(LimitExceeded, match="standard deviations from what the model expects"):
        observe_all(loop, opened)


def test_a_wire_without_a_voltage_ends_the_run():
    twin, loop = Twin.named("one_wire_twin", seed=9), feedback()
    silent = (s._replace(voltage_V=math.nan) for s in samples(twin))
    with pytest.raises(LimitExceeded, match="without a voltage reading"):
        observe_all(loop, silent)


def test_regulation_by_resistance_never_looks_at_the_encoder():
    setup, twin = Setup.of("one_wire_twin"), Twin.named("one_wire_twin", seed=10)
    h = model_of("one_e").hysteresis
    protocol = regulate(setup, hysteresis=h, setpoint=6.0, within=0.03, hold_s=120.0, feedback=feedback())
    true, reply = [], None
    while True:
        try:
            command = protocol.send(reply)
        except StopIteration:
            break
        reply = None
        if isinstance(command, Drive):
            reply = twin.step(command.current_A)[0]._replace(position=math.nan, counts=0)
            true.append(twin.specimen.plant.position)
        elif isinstance(command, Hold | Waveform):
            if isinstance(command, Hold):
                assert isinstance(command.until, Elapsed)  # no settling without an encoder
                steps = [(command.current_A, command.until.seconds)]
            else:
                steps = [(current_A, command.period_s) for current_A in command.currents_A]
            for current_A, seconds in steps:
                for _ in range(round(seconds / 0.1)):
                    twin.step(current_A)
            reply = StepResult(0, StepVerdict.ELAPSED, math.nan, math.nan, math.nan, 1, 0.0, 1.0)
    held = np.array(true[600:1190])
    assert abs(float(held.mean()) - 6.0) < 0.01 * STROKE
    assert float(held.std()) < 0.01 * STROKE
