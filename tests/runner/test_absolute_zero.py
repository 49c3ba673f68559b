"""A run on an absolute sensor is resumed by its zero, which survives a restart. The zero of other sensors is lost."""

from contextlib import contextmanager

import numpy as np
import pytest

from device.polled.wire_by_time import WireByTime
from rig.bench.instruments import FakeClock
from runner.interrupted import cut
from smarig.core import DataError
from smarig.device import Electrical, HostClock, PolledPosition, PolledSource
from smarig.identification import identify, verify
from smarig.record import load_run
from smarig.rig import Bench
from smarig.runner import Session, resume

OWN_ZERO_MM = -41.7  # of the sensor, far from that of the run
RIG = """name = "absolute"
base = "laboratory_supply"
wire = "{wire}"
encoder.resolution = 0.01
encoder.noise_counts = 0.0
links.amplifier.url = "TCPIP0::192.0.2.1::9::SOCKET"
links.encoder_daq.url = "TCPIP0::192.0.2.2::9::SOCKET"
simulator.start = false
"""


class Wire(WireByTime):
    """Its time is that of the test."""

    def __init__(self, clock):
        super().__init__()
        self.clock, self.begin_s = clock, clock()

    def look(self):
        due = int((self.clock() - self.begin_s) / self.file.period_s + 1e-6)
        while self.specimen.tick < due:
            self.specimen.advance(self.current_A)


class Box:
    """Drives the wire and sees its end: from a place of its own, or from where it is when the box is opened."""

    unit, has_lease, tripped = "mm", True, ""

    def __init__(self, wire, identity, absolute):
        self.wire, self.identity, self.absolute = wire, identity, absolute
        self.begin_mm = OWN_ZERO_MM if absolute else wire.position_mm

    def arm(self):
        self.off()

    def set_current(self, current_A):
        self.wire.drive(current_A)

    def measure(self):
        return Electrical(self.wire.current_A, self.wire.voltage_V)

    def off(self):
        self.wire.drive(0.0)
        return ""

    def position(self):
        return self.wire.position_mm - self.begin_mm

    def close(self):
        pass


@pytest.fixture
def bench(monkeypatch):
    """What every later session opens: the same wire, seen by this sensor."""
    wire, sensor = Wire(FakeClock()), {"identity": "laser 42", "absolute": True}

    @contextmanager
    def opened(rig, file, actuator, settings, **_):
        box, clock = Box(wire, **sensor), wire.clock
        position = PolledPosition(box, file, HostClock(file, clock))
        bench = Bench(file, actuator, PolledSource(box), position, clock=clock, sleep=clock.sleep)
        yield bench
        bench.safe()

    monkeypatch.setattr("smarig.runner.session.open_rig", opened)
    return sensor


def rig_file(tmp_path):
    path = tmp_path / "absolute.toml"
    path.write_text(RIG.format(wire=tmp_path.name), encoding="utf-8")
    return str(path)


PROTOCOL = """
from smarig.core import Hold, Settled, Zero

def zeroed_steps(setup):
    '''Zero the cold wire, then hold.'''
    for temperature_K in (0, 60, 110, 80):
        yield Hold(setup.current_for(temperature_K), Settled(), target=float(temperature_K))
        if temperature_K == 0:
            yield Zero()
"""


@pytest.fixture(scope="module")
def protocol(tmp_path_factory):
    path = tmp_path_factory.mktemp("protocol") / "zeroed_steps.py"
    path.write_text(PROTOCOL, encoding="utf-8")
    return str(path)


@pytest.fixture
def ended(bench, protocol, tmp_path):
    """A run, and a copy as its killed process would have left it; its only cold state is from before the zero."""

    def made(**sensor):
        bench.update(sensor)
        with Session(rig_file(tmp_path)) as session:
            run = load_run(session.run(protocol, {}, tmp_path / "whole.run.sqlite"))
        return run, cut(run.path, tmp_path / "killed.run.sqlite", int(run["tick"][int(0.8 * len(run))]))

    return made


def test_the_counts_continue_from_the_zero_of_the_sensor(ended, tmp_path):
    whole, killed = ended()
    run = resume(killed, rig=rig_file(tmp_path))
    positions = [np.array([s.position for s in r.settled[1:]]) for r in (run, whole)]
    assert np.ptp(positions[1]) > 2.0, "mm: the wire has moved"
    assert np.abs(positions[0] - positions[1]).max() < 0.1
    assert run.meta["shift"]["counts"] == pytest.approx(-4170, abs=20), "the run was zeroed at the cold wire"


def test_a_zero_of_the_session_before_the_run_counts_too(bench, tmp_path):
    with Session(rig_file(tmp_path)) as session:
        session.run("initialise", {}, tmp_path / "i.run.sqlite")
        settings = {"temperatures_K": "0,60,110,80"}
        whole = load_run(session.run("step_currents", settings, tmp_path / "whole.run.sqlite"))
    run = resume(
        cut(whole.path, tmp_path / "killed.run.sqlite", int(whole["tick"][int(0.8 * len(whole))])),
        rig=rig_file(tmp_path),
    )
    positions = [np.array([s.position for s in r.settled]) for r in (run, whole)]
    assert np.abs(positions[0] - positions[1]).max() < 0.1
    assert [e for e in run.events if e.kind == "shift"] == [], "no state had to be found again for it"


@pytest.mark.parametrize("then", [{"absolute": False}, {"identity": "laser 43"}])
def test_a_sensor_that_counts_from_0_or_another_one_has_lost_it(ended, bench, then, tmp_path):
    _, killed = ended(absolute=then.get("absolute", True))
    bench.update(then)
    with pytest.raises(DataError, match="The zero of the encoder is lost"):
        resume(killed, rig=rig_file(tmp_path))


LOOPS = {"low_A": 0, "high_A": 0.5, "loops": 1, "loop_s": 200}


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "then0-known",
        "then1-fitted",
        "then2-known",
    ),
)
@pytest.mark.parametrize(
    ("then", "zero"), [({}, "known"), ({"identity": "laser 43"}, "fitted"), ({"absolute": False}, "known")]
)
def test_a_model_is_verified_on_runs_of_other_sessions(bench, then, zero, tmp_path):
    """An absolute sensor has the same zero in all; others are at zero when a cold wire is switched on."""
    bench.update(absolute=then.get("absolute", True))
    runs = []
    for name in ("first", "later"):
        with Session(rig_file(tmp_path)) as session:
            runs.append(session.run("minor_loops", LOOPS, tmp_path / f"{name}.run.sqlite"))
        bench.update(then)
    model = identify(runs[0], "positive").model
    found = verify(model, runs[1]).runs[0]
    stroke = float(np.ptp(found.measured))
    assert found.offset_kind == zero
    assert found.settled.rms < 0.03 * stroke
