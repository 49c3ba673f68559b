"""Instruments of PyMeasure and QCoDeS drive a run: a supply and a position sensor of each, on the wire of a twin."""

import numpy as np
import pytest

from device.polled.wire_by_time import SPEED, WIRE, WireByTime
from smarig.core import Settled
from smarig.record import load_run
from smarig.runner import Session

RIG = f"""name = "theirs"
base = "bench_one_wire"
wire = "twin-of-a-test"
encoder.resolution = 0.01
[links.amplifier]
driver = "./LIBRARY_supply.py"
framing = "lines"
url = "SUPPLY"
[links.encoder_daq]
driver = "./LIBRARY_laser.py"
framing = "lines"
url = "LASER"
[simulator]
start = false
speed = {SPEED}
"""
PYMEASURE = '''
from pymeasure.adapters import Adapter
from pymeasure.instruments import Instrument
from device.polled.wire_by_time import WIRE


class WireAdapter(Adapter):
    """What the instrument would send and receive over GPIB."""

    level, on = 0.0, False

    def _write(self, command, **kwargs):
        name, _, value = command.partition(" ")
        if name == "CURR":
            self.level = float(value)
        elif name == "OUTP":
            self.on = value == "1"
        WIRE[0].drive(self.level * self.on)
        self.answer = {"CURR?": self.level, "OUTP?": int(self.on), "MEAS:CURR?": self.level * self.on,
                       "MEAS:VOLT?": WIRE[0].voltage_V, "MEAS:POS?": WIRE[0].position_mm}.get(command)

    def _read(self, **kwargs):
        return str(self.answer)


class Supply(Instrument):
    current_setpoint = Instrument.control("CURR?", "CURR %g", "Set current in A.")
    output_enabled = Instrument.control("OUTP?", "OUTP %d", "Output.", values={True: 1, False: 0}, map_values=True)
    current = Instrument.measurement("MEAS:CURR?", "Current in A.")
    voltage = Instrument.measurement("MEAS:VOLT?", "Voltage in V.")


class Laser(Instrument):
    position = Instrument.measurement("MEAS:POS?", "Position in mm.")
'''
DRIVERS = {
    "pymeasure_supply": PYMEASURE
    + """
from smarig.device import FunctionOutput

def pymeasure_supply(where, rig):
    supply = Supply(WireAdapter(), "supply", includeSCPI=False)
    return FunctionOutput(
        identity=supply.name,
        set_current_A=lambda value: setattr(supply, "current_setpoint", value),
        setting_A=lambda: supply.current_setpoint,
        switch_on=lambda: setattr(supply, "output_enabled", True),
        switch_off=lambda: setattr(supply, "output_enabled", False),
        is_on=lambda: supply.output_enabled,
        current_A=lambda: supply.current,
        voltage_V=lambda: supply.voltage,
        close_all=supply.shutdown,
    )
""",
    "pymeasure_laser": PYMEASURE
    + """
from smarig.device import FunctionInput

def pymeasure_laser(where, rig):
    laser = Laser(WireAdapter(), "laser", includeSCPI=False)
    laser.adapter._write = lambda command, **kwargs: setattr(laser.adapter, "answer", WIRE[0].position_mm)
    return FunctionInput(laser.name, lambda: laser.position, "mm")
""",
    "qcodes_supply": """
from qcodes.parameters import Parameter
from device.polled.wire_by_time import WIRE
from smarig.device import FunctionOutput

def qcodes_supply(where, rig):
    wire = WIRE[0]
    current = Parameter("current", unit="A", get_cmd=lambda: wire.current_A, set_cmd=wire.drive)
    voltage = Parameter("voltage", unit="V", get_cmd=lambda: wire.voltage_V, set_cmd=False)
    return FunctionOutput("supply", set_current_A=current, setting_A=current, current_A=current, voltage_V=voltage)
""",
    "qcodes_laser": """
from qcodes.parameters import Parameter
from device.polled.wire_by_time import WIRE
from smarig.device import FunctionInput

def qcodes_laser(where, rig):
    return FunctionInput("laser", Parameter("position", unit="mm", get_cmd=lambda: WIRE[0].position_mm), "mm")
""",
}


@pytest.mark.long("takes a second", cases=("pymeasure",))
@pytest.mark.filterwarnings("default")  # of packages that are not ours
@pytest.mark.parametrize(
    "library", ["pymeasure", pytest.param("qcodes", marks=pytest.mark.long("takes five seconds"))]
)
def test_their_instruments_drive_a_run(library, tmp_path):
    pytest.importorskip(library, reason=f"{library} is not installed")
    for name in ("supply", "laser"):
        (tmp_path / f"{library}_{name}.py").write_text(DRIVERS[f"{library}_{name}"])
    (tmp_path / "rig.toml").write_text(RIG.replace("LIBRARY", library))
    WIRE[0] = WireByTime()
    settle = {"settle": Settled(window_s=25.0, timeout_s=120.0)}
    with Session(str(tmp_path / "rig.toml")) as session:
        session.run("step_currents", {"temperatures_K": (60.0, 100.0)} | settle, tmp_path / "a.run.sqlite")
    run = load_run(tmp_path / "a.run.sqlite")
    assert run.cause == "done"
    assert run.meta["has_lease"] is False
    heated = [step for step in run.steps if step.target and step.target > 0]
    assert [step.target for step in heated] == [60.0, 100.0]
    assert 6.0 < heated[0].position < heated[1].position < 13.0, "as the twin moves"
    assert np.ptp(run["position"] / 0.01 - run["counts"]) < 1e-6, "counts are steps of 0.01 mm"
    assert WIRE[0].current_A == 0.0
