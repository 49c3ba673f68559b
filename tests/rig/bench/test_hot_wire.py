"""A session on a wire that another session left hot: the prediction starts where the wire is, and its limits trip.

The devices run in lock-step and outlive every host. Their trace gives the true current of every tick, and so the true
temperature.
"""

import signal

import pytest

from rig.bench.mortal import SimulatedDevices, host
from smarig.core.errors import Interrupted, LimitExceeded, SmarigError
from smarig.plant.actuator import Actuator
from smarig.plant.heating import JouleHeating
from smarig.record import load_run, load_wire_history
from smarig.runner.listener import CallbackListener
from smarig.runner.resume.resume_run import resume_in, session_for
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session

LEASE_S = 0.5
SETTINGS = {"temperatures_K": "160,20", "settle.window_s": "600", "settle.timeout_s": "1200"}
HOT_TICKS = 1500  # the wire is cooled first, and is then above 150 K
HOT_K = 150.0
NEAR_K = 1.0  # noise of the measured current


@pytest.fixture
def devices(tmp_path):
    devices = SimulatedDevices(tmp_path, 0.0, LEASE_S)
    yield devices
    devices.close()


def true_K(devices):
    """The temperature of the wire by the current that has flowed."""
    heating = JouleHeating(Actuator.named("gorbet_one_wire"), devices.period_s)
    for driven_uA in devices.driven():
        heating.step(driven_uA / 1e6)
    return heating.input_K


def recorded_input_K(out):
    """The last input that was committed; 0 without one."""
    try:
        return float(load_run(out)["input"][-1])
    except (SmarigError, IndexError):
        return 0.0


def stop_after(ticks, control):
    """Stop after this many samples."""
    seen = []

    def count(sample, _step, _input_K):
        seen.append(sample)
        if len(seen) == ticks:
            control.stop("enough")

    return CallbackListener(on_sample=count)


def left_hot(devices, out):
    """A session that is stopped while the wire is hot."""
    control = RunControl()
    with Session(str(devices.rig), control=control) as session, pytest.raises(Interrupted):
        session.run("step_currents", SETTINGS, out, listeners=[stop_after(HOT_TICKS, control)])


@pytest.mark.long("takes five seconds")
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_run_that_is_resumed_at_once_starts_as_hot_as_its_wire(devices, tmp_path):
    out = tmp_path / "killed.run.sqlite"
    words = [word for pair in SETTINGS.items() for word in ("--set", "=".join(pair))]
    run = host("run", "step_currents", *words, "--rig", str(devices.rig), "-o", str(out))
    while recorded_input_K(out) < HOT_K:
        assert run.poll() is None, run.communicate()
    run.send_signal(signal.SIGKILL)
    run.communicate()
    control, before = RunControl(), load_run(out)
    with session_for(before, rig=str(devices.rig), control=control) as session:
        hot_K = true_K(devices)
        assert hot_K > HOT_K
        with pytest.raises(Interrupted):
            resume_in(session, before, listeners=[stop_after(3, control)])
    begin_K = float(load_run(out)["input"][len(before)])
    assert begin_K > hot_K * 0.95 - NEAR_K, "a tick of cooling"
    assert begin_K <= session.file.limits.temperature_max_K


@pytest.mark.long("takes three seconds")
def test_a_new_session_starts_as_hot_as_the_last_one_ended(devices, tmp_path):
    left_hot(devices, tmp_path / "first.run.sqlite")
    control, out = RunControl(), tmp_path / "second.run.sqlite"
    with Session(str(devices.rig), control=control) as session:
        hot_K = true_K(devices)
        assert session.guard.input_K == pytest.approx(hot_K, abs=NEAR_K)
        with pytest.raises(Interrupted):
            session.run("step_currents", SETTINGS, out, listeners=[stop_after(3, control)])
    run = load_run(out)
    assert run.events[0].data["wire_K"] == pytest.approx([hot_K, 0.0], abs=NEAR_K)
    assert run["input"][0] > hot_K - 5.0, "a tick or two of cooling"
    assert load_wire_history(session.wire, twin=True).cycles == 1, "heated once"


def test_its_limit_trips_at_the_first_sample_of_a_current_that_heats_further(devices, tmp_path):
    left_hot(devices, tmp_path / "first.run.sqlite")
    text = devices.rig.read_text("utf-8")
    devices.rig.write_text(text + "limits.temperature_max_K = 155.0\n", "utf-8")
    with Session(str(devices.rig)) as session:
        session.guard.step(0.98)
        assert "exceeds the limit temperature_max_K = 155" in session.guard.tripped
        with pytest.raises(LimitExceeded):
            session.guard.step(0.0)


@pytest.mark.long("takes three seconds")
def test_a_wire_that_has_cooled_meanwhile_starts_cold(devices, tmp_path):
    left_hot(devices, tmp_path / "first.run.sqlite")
    for _ in range(50):  # 75 s of the devices' time
        devices.wait()
    with Session(str(devices.rig)) as session:
        assert true_K(devices) < 0.1
        assert session.guard.input_K == 0.0
