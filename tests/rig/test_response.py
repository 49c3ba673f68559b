"""Heat without response is a warning: the wire would have moved far by its model, and the position stays."""

import pytest

from smarig.config import load_rig
from smarig.core import LimitExceeded
from smarig.identification import Calibration
from smarig.plant import Actuator
from smarig.preisach import thesis_surface
from smarig.rig import Guard, Plausibility, Twin
from smarig.rig.channel_checks import RigReadings
from smarig.rig.motion_model import Motion, MotionModel
from smarig.rig.response import UNIT_REMEDY, Response

FILE = load_rig("one_wire_twin")
WIRE = Actuator.named(FILE.actuator)


def warnings(factor, currents_A, tolerance=0.3):
    """The texts of the warnings on a bench that is not calibrated, with a position times a factor."""
    limits = FILE.limits.model_copy(update={"model_tolerance": tolerance})
    twin = Twin.named("one_wire_twin", noise=False)
    step = twin.step
    twin.step = lambda *a: tuple(s._replace(counts=round(factor * s.counts)) for s in step(*a))
    file = FILE.model_copy(update={"limits": limits})
    guard = Guard(twin, limits, WIRE, Plausibility(file, WIRE, RigReadings(noise=False)))
    for k, current_A in enumerate(currents_A):
        guard.step(current_A)
        if guard.tripped:
            raise LimitExceeded(f"tripped at {k}: {[alarm.kind for alarm in guard.alarms()]}")
    return [alarm.text for alarm in guard.alarms() if alarm.kind == "still"]


def loop(largest_A, ticks=900):
    rising = [largest_A * k / ticks for k in range(ticks)]
    return [*rising, *reversed(rising)] * 2


@pytest.mark.parametrize(("factor", "times"), [(1.0, 0), (0.2, 0), (0.05, 1)])
def test_a_loop_in_another_unit_warns_once(factor, times):
    texts = warnings(factor, loop(0.7))
    assert len(texts) == times
    assert all("the unit of the driver, and encoder.resolution" in text for text in texts)


def driven(guard, currents_A):
    for current_A in currents_A:
        guard.step(current_A)


def test_a_unit_that_is_too_small_ends_the_run_with_the_words_of_a_bring_up():
    """Micrometres, where the file says millimetres: the first motion is faster than any wire."""
    twin = Twin.named("one_wire_twin", noise=False)
    step = twin.step
    twin.step = lambda *a: tuple(s._replace(counts=1000 * s.counts) for s in step(*a))
    guard = Guard(twin, FILE.limits, WIRE, Plausibility(FILE, WIRE, RigReadings(noise=False)))
    says = rf"faster than the wire can \(its stroke is 266 counts\).*{UNIT_REMEDY}"
    with pytest.raises(LimitExceeded, match=says):
        driven(guard, loop(0.7))
    scale = MotionModel(WIRE, FILE, +1).scale(Motion(9000, True, 0), 30.0)
    assert UNIT_REMEDY in scale.observed


@pytest.mark.parametrize("factor", [1e-3, 0.0])
def test_a_loop_without_a_single_count_warns_and_then_ends_the_run(factor):
    """Every wire within the tolerance has moved by then."""
    with pytest.raises(LimitExceeded, match=r"\['still', 'frozen'\]"):
        warnings(factor, loop(0.7))


def test_a_loop_that_moves_the_model_little_says_nothing():
    assert warnings(0.0, loop(0.4)) == []


def test_after_a_zero_the_comparison_begins_anew():
    response = Response(FILE, WIRE)
    heated = [response.add(0, float(K), 10) for K in range(90)]
    assert sum(map(len, heated)) == 1
    response.forget()
    assert [response.add(0, 89.0, 10) for _ in range(50)] == [[]] * 50
    assert sum(len(response.add(0, 89.0 - K, 10)) for K in range(90)) == 1


def test_whose_hysteresis_is_compared_is_told(tmp_path):
    """That of the thesis's wire, until the file has its own."""
    (text,) = warnings(0.05, loop(0.7))
    assert "the hysteresis in gorbet_one_wire is still that of the thesis's wire" in text
    assert "smarig calibrate RUN --model MODEL" in text
    path = tmp_path / "own.toml"
    own = Calibration({}, {}).write_actuator(path, WIRE, hysteresis=thesis_surface("one_e"), force=True)
    response, wire = Response(FILE, Actuator.named(str(own))), 2 * WIRE.hysteresis.upper
    alarms = [alarm for k in range(600) for alarm in response.add(0, wire * k / 600, 10)]
    assert [alarm.text.endswith("the wire transforms later.") for alarm in alarms] == [True]
