"""A position that fails in mid-motion, read through the doubles of other makes: marked, then the current is off.

The doubles share the wire of the simulators, whose position is changed from a moment on; drivers, bench and guard are
those of a run.
"""

import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import pytest

from device.labjack.boxes import link_of
from device.labjack.boxes import rig as labjack_file
from device.ni import stub_nidaqmx as stub
from device.ni.test_ni import CURRENT, LASER, _Importing
from device.ni.test_ni import rig as ni_file
from simulators.labjack import LabJackServer
from simulators.labjack_wire import LabJackWire
from simulators.wire_by_clock import WireByClock
from simulators.wire_quantities import WireQuantities
from smarig.config import RigFile, load_rig
from smarig.core import Quality, SmarigError
from smarig.device.drivers import _ni
from smarig.plant import Actuator
from smarig.rig import Guard, Plausibility, RigReadings, TwinSettings, open_rig

SPEED = 5.0  # device seconds per second: at 20, a busy host reads too rarely for the first of the two checks
BEGINS_MM = 3.0  # of 12.6: the wire is moving at its fastest
SOUND_S = 70.0  # a bench that starts does not know how hot its wire is until it has rested
LEASE_S = 40.0  # of device time: a busy machine must not expire it
HOT_A, HOT_S, COLD_S = 0.95, 20.0, 50.0
LONGEST_S = 2 * (HOT_S + COLD_S)
FAULTS: dict[str, tuple[Callable[[float, float], float], float]] = {  # with seconds until the current is off
    "stuck": (lambda _x, start: start, 25.0),
    "jump": (lambda x, _start: x + 3.0, 40.0),
    "lost": (lambda _x, _start: 0.0, 25.0),
    "wrong sign": (lambda x, start: 2 * start - x, 25.0),
}


@dataclass
class Double:
    """A double: its rig file, its wire, and the current that its output drives."""

    file: RigFile
    wire: WireQuantities
    flows_A: Callable[[], float]


@contextmanager
def labjack(_tmp_path) -> Iterator[Double]:
    """A T7 with a laser at an analogue input."""
    wired = LabJackWire(labjack_file(lease_s=LEASE_S), TwinSettings(seed=1))
    server = LabJackServer(wired, SPEED).start()
    try:
        yield Double(labjack_file(server.url, lease_s=LEASE_S), wired._wire, lambda: wired.box.dac_V[0])
    finally:
        server.close()


@contextmanager
def visa(tmp_path) -> Iterator[Double]:
    """A laboratory supply and a meter at a laser."""
    pytest.importorskip("pyvisa_py", reason="the extra visa is not installed")
    from device.visa.supplies import bench_of

    path = tmp_path / "visa.toml"
    bench = bench_of("keysight_n6700", path, LEASE_S, SPEED)
    try:
        yield Double(load_rig(str(path)), bench.wire, lambda: bench.supply.flows_A)
    finally:
        bench.close()


@contextmanager
def ni(_tmp_path) -> Iterator[Double]:
    """A card with an external amplifier and a laser; the world of the stub has a wire here."""
    file = ni_file(
        "encoder_daq", "ni_position", {**LASER, "minimum": -20.0, "maximum": 40.0}, lease_s=LEASE_S
    )
    output = ni_file("amplifier", "ni_output", CURRENT | {"watchdog": True})
    assert file.links is not None
    links = file.links.model_copy(update={"amplifier": link_of(output, "amplifier")})
    file = file.model_copy(update={"links": links})
    by_clock = WireByClock(file, TwinSettings(seed=1), SPEED)

    class Wired(stub.World):
        def ai(self, channel):
            by_clock.drive(stub.A_PER_V * self.ao_V)
            name = {"ai0": "current", "ai1": "voltage", "ai2": "position"}[channel.split("/")[1]]
            return by_clock.quantity(name) / (LASER["input"]["scale"] if name == "position" else 1.0)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_ni, "importlib", _Importing())
        patch.setattr(stub, "WORLD", Wired())
        patch.setattr(stub, "SPEED", [SPEED])
        yield Double(file, by_clock.wire, lambda: stub.WORLD.ao_V)


DOUBLES = {"labjack": labjack, "visa": visa, "ni": ni}
REAL_TIME = pytest.mark.long("a minute of real time")
FIVE_SECONDS = pytest.mark.long("takes five seconds; tried on the shipped devices")
NAMES = [pytest.param("labjack", marks=REAL_TIME), "visa", pytest.param("ni", marks=REAL_TIME)]


def fail(wire: WireQuantities, change: Callable[[float, float], float]) -> list[float]:
    """Change the position from the moment at which it passes BEGINS_MM the next time. The list then has it."""
    true, start = wire.quantity, []

    def quantity(name: str) -> float:
        value = true(name)
        if name != "position":
            return value
        sound = wire.specimen.tick * wire.file.period_s < SOUND_S
        if not sound and not start and value >= BEGINS_MM:
            start.append(value)
        return change(value, start[0]) if start else value

    wire.quantity = quantity
    return start


def ended(double: Double, began: Callable[[], bool]) -> tuple[float, float, str]:
    """Seconds from the fault until a sample is marked and until the run ends, and its sentence."""
    file, actuator = double.file, Actuator.named(double.file.actuator)
    with open_rig("test", file, actuator, TwinSettings(seed=1)) as rig:
        readings = RigReadings(counter=not getattr(rig, "timed_by_host", False))
        guard = Guard(rig, file.limits, actuator, Plausibility(file, actuator, readings))
        began_s = marked_s = math.nan
        begin_s, now_s = None, 0.0
        while now_s < LONGEST_S:
            current_A = HOT_A if now_s % (HOT_S + COLD_S) < HOT_S else 0.0
            try:
                for s, _ in guard.step(current_A):
                    begin_s = s.t_s if begin_s is None else begin_s
                    now_s = s.t_s - begin_s
                    if began() and math.isnan(began_s):
                        began_s = now_s
                    if began() and s.quality & Quality.SUSPECT and math.isnan(marked_s):
                        marked_s = now_s
                guard.raise_if_tripped()
            except SmarigError as cause:  # the guard, or a driver whose reading is out of range
                assert not guard.tripped or double.flows_A() == 0.0
                return marked_s - began_s, now_s - began_s, str(cause)
    return marked_s - began_s, math.nan, ""


@pytest.mark.parametrize(
    "fault", [pytest.param(name, marks=[] if name == "stuck" else FIVE_SECONDS) for name in FAULTS]
)
@pytest.mark.parametrize("double", NAMES)
def test_a_failing_position_switches_the_current_off(double, fault, tmp_path):
    change, limit_s = FAULTS[fault]
    with DOUBLES[double](tmp_path) as bench:
        start = fail(bench.wire, change)
        marked_s, ended_s, cause = ended(bench, lambda: bool(start))
        assert re.search("The position|no position|did not move", cause)
        assert math.isnan(marked_s) or marked_s <= ended_s
        assert ended_s <= limit_s
        assert bench.flows_A() == 0.0


@pytest.mark.long("takes ten seconds")
@pytest.mark.parametrize("double", NAMES)
def test_a_sound_position_does_not(double, tmp_path):
    with DOUBLES[double](tmp_path) as bench:
        assert ended(bench, lambda: False)[2] == ""
