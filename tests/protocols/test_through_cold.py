"""Under a limit of stress, one wire cools before the other is heated, and nothing else changes."""

import numpy as np
import pytest

from smarig.config import load_rig
from smarig.core import Elapsed, Hold, Mark, Settled, Waveform
from smarig.plant import Actuator
from smarig.protocols import Setup, build_protocol
from smarig.protocols._through_cold import BRANCH, through_cold
from smarig.rig import Guard, Twin, TwinSettings, stress_limit
from smarig.runner import Runner, preview

SETUP = Setup.of("two_wire_twin")
PAUSE = Hold(0.0, Elapsed(3 * SETUP.tau_s), branch=BRANCH)


def limited():
    file = load_rig("two_wire_twin")
    return file.model_copy(update={"limits": file.limits.model_copy(update={"stress_max_MPa": 300.0})})


def commands(*given):
    """What becomes of these commands, and what the protocol receives."""
    received = []

    def protocol():
        for command in given:
            received.append((yield command))

    wrapped, found, reply = through_cold(protocol(), SETUP), [], None
    while True:
        try:
            found.append(wrapped.send(reply))
        except StopIteration:
            return found, received
        reply = f"result {len(found)}"


def test_a_pause_comes_between_the_wires():
    first, second = Hold(0.5, Elapsed(1.0)), Hold(-0.5, Elapsed(1.0))
    found, received = commands(first, Mark("x"), second, first)
    assert found == [first, Mark("x"), PAUSE, second, PAUSE, first]
    assert received == ["result 1", "result 2", "result 4", "result 6"]


@pytest.mark.parametrize("cold", [Hold(0.0, Settled()), Hold(0.0, Elapsed(3 * SETUP.tau_s))])
def test_a_wire_that_has_cooled_needs_no_pause(cold):
    first, second = Hold(0.5, Elapsed(1.0)), Hold(-0.5, Elapsed(1.0))
    assert commands(first, cold, second)[0] == [first, cold, second]


def test_a_short_time_at_zero_is_no_pause():
    first, second, short = Hold(0.5, Elapsed(1.0)), Hold(-0.5, Elapsed(1.0)), Hold(0.0, Elapsed(1.0))
    assert commands(first, short, second)[0] == [first, short, PAUSE, second]


def test_a_waveform_is_cut_where_its_sign_changes():
    wave = Waveform((0.1, 0.2, 0.0, -0.1, -0.2, 0.3), 0.1, "decay")
    found, received = commands(wave)
    cut = [Waveform(part, 0.1, "decay") for part in ((0.1, 0.2, 0.0), (-0.1, -0.2), (0.3,))]
    assert found == [cut[0], PAUSE, cut[1], PAUSE, cut[2]]
    assert received == ["result 5"]


LONG = pytest.mark.long("takes three seconds")


@pytest.mark.long("takes two seconds", cases=("initialise", "wiping_out"))
@pytest.mark.parametrize(
    "name",
    [
        *("initialise", "wiping_out", "minor_loops"),
        *(pytest.param(name, marks=LONG) for name in ("congruency", "first_order_descending", "validation")),
    ],
)
def test_every_protocol_runs_under_the_limit_of_the_template(name):
    assert load_rig("bench_two_wire").limits.stress_max_MPa == 300.0
    preview(name, limited())


def settled_positions(file):
    actuator = Actuator.named(file.actuator)
    twin = Twin(file, actuator, TwinSettings(noise=False))
    guard = Guard(twin, file.limits, actuator, stress=stress_limit(file, actuator))
    rows = []

    class Rows:
        def sample(self, *_):
            pass

        def event(self, *_, **__):
            pass

        def step(self, result, *, branch, target):
            if target is not None:
                rows.append((target, result.position))

    runner = Runner(guard, twin.position_per_count, [Rows()])
    setup = Setup(actuator, file.limits, file.period_s)
    runner.run(build_protocol("validation", setup, {"points": "9"}))
    return np.array(rows)


@pytest.mark.long("takes a second")
def test_the_memory_of_the_hysteresis_is_the_same():
    """The input passes zero on its way: the settled points are those without a limit."""
    plain, paused = settled_positions(load_rig("two_wire_twin")), settled_positions(limited())
    assert plain[:, 0] == pytest.approx(paused[:, 0])
    assert np.ptp(plain[:, 1]) > 10
    assert np.abs(plain[:, 1] - paused[:, 1]).max() < 0.36  # two counts; settling itself allows one
