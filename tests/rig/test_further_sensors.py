"""Thermometers of wire and room, and a load cell, beside the two devices of a bench."""

import math

import pytest

from smarig.config import load_rig
from smarig.core import ConfigError, Quality, RigFault, own_files
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
from smarig.record import load_run
from smarig.report.components.run_description import conditions_text
from smarig.report.run_page import run_page
from smarig.rig import ForceStatistics
from smarig.runner import Session


@pytest.fixture(autouse=True)
def no_other_files():
    """Drivers of the same name in other folders are not known."""
    with own_files():
        yield


SENSORS = '''"""Sensors whose readings the test knows; the load cell has none at every third query."""
import math
from smarig.device import FunctionInput, Silent

count = iter(range(10**6))
forces = iter(10.0 + 0.5 * (k % 3) if k % 3 else math.nan for k in range(10**6))

def FILE(where, rig):
    if where.url == "dead":
        def read():
            raise OSError("cable")
        return FunctionInput("dead sensor", read)
    values = {
        "wire": lambda: 40.25,
        "room": lambda: 19.5,
        "none": lambda: None,
        "cell": lambda: next(forces),
        "torn": lambda: WRONG if 40 < (k := next(count)) < 60 else 10.0,
    }
    return FunctionInput(f"sensor {where.url}", values[where.url])
'''


def rig(folder, wrong_N=0.0, **links):
    (folder / "sensors.py").write_text(SENSORS.replace("FILE", "sensors").replace("WRONG", repr(wrong_N)))
    tables = "".join(
        f'[links.{name}]\ndriver = "./sensors.py"\nframing = "lines"\nurl = "{url}"\n'
        for name, url in links.items()
    )
    path = folder / "rig.toml"
    path.write_text(f'name = "rig"\nbase = "one_wire_serial"\n{tables}')
    return str(path)


def run_on(path, folder):
    with Session(path) as session:
        session.run("step_currents", {"temperatures_K": (5.0,)}, folder / "a.run.sqlite")
        identities = session.rig.identity()
    return load_run(folder / "a.run.sqlite"), identities


def test_their_readings_are_in_the_record(tmp_path):
    path = rig(tmp_path, thermometer="wire", room_thermometer="room", load_cell="cell")
    run, identities = run_on(path, tmp_path)
    assert identities[2:] == ["sensor wire", "sensor room", "sensor cell"]
    assert set(run["temperature_degC"]) == {40.25}
    assert set(run["ambient_degC"]) == {19.5}
    load, stress = run.info.conditions["load"], run.info.conditions["stress"]
    assert (load["min"], load["max"], load["unit"]) == (10.5, 11.0, "N")
    diameter_mm = load_wire_diameter_mm()
    assert stress["max"] == pytest.approx(11.0 / (math.pi / 4 * diameter_mm**2))


def load_wire_diameter_mm():
    from smarig.config import load_actuator

    return load_actuator(load_rig("one_wire_serial").actuator).wire.diameter.value


def test_a_sensor_without_a_reading_leaves_what_the_devices_measure(tmp_path):
    run, _ = run_on(rig(tmp_path, thermometer="none", room_thermometer="none", load_cell="none"), tmp_path)
    assert set(run["ambient_degC"]) != {19.5}
    assert not run.has("temperature_degC") or all(map(math.isnan, run["temperature_degC"]))
    assert "load" not in run.info.conditions


def test_a_sensor_that_fails_ends_the_run_at_zero(tmp_path):
    with pytest.raises(RigFault, match=r"dead sensor: reading failed \(OSError: cable\)"):
        run_on(rig(tmp_path, room_thermometer="dead"), tmp_path)
    run = load_run(tmp_path / "a.run.sqlite")
    assert "dead sensor" in run.cause


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("wrong_N", [1e300, -1e6, 2001.0 * math.pi / 4 * 0.3**2])
def test_a_force_that_no_wire_carries_is_suspect_and_in_no_mean(tmp_path, wrong_N):
    run, _ = run_on(rig(tmp_path, wrong_N, load_cell="torn"), tmp_path)
    load = run.info.conditions["load"]
    assert (load["min"], load["mean"], load["max"]) == (10.0, 10.0, 10.0)
    assert run.marked(Quality.SUSPECT)[0] >= 19
    assert not run["quality"][-1]
    warnings = [e.text for e in run.events if e.kind == "force"]
    assert len(warnings) == 1
    assert warnings[0].startswith(f"The load cell reads {wrong_N:.4g} N, but the wire breaks below 141 N ")


def test_a_driver_of_another_role_is_one_sentence(tmp_path):
    path = tmp_path / "rig.toml"
    link = '[links.thermometer]\ndriver = "./half.py"\nframing = "lines"\nurl = "x"\n'
    path.write_text(f'name = "rig"\nbase = "one_wire_serial"\n{link}')
    (tmp_path / "half.py").write_text("def half(where, rig):\n    return object()\n")
    with pytest.raises(
        ConfigError, match="lacks close, identity, temperature_degC, which a thermometer requires"
    ):
        run_on(str(path), tmp_path)


def test_the_mean_of_forces_is_that_of_the_finite_readings():
    forces = ForceStatistics()
    for value in (1.0, math.nan, 2.0, 6.0, math.inf):
        forces.add(value)
    assert (forces.n, forces.mean_N, forces.least_N, forces.largest_N) == (3, 3.0, 1.0, 6.0)
    forces.reset()
    assert forces.n == 0


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize(
    ("by_sensor", "links", "source"),
    [(True, {}, None), (False, {"room_thermometer": "room"}, None), (False, {}, "rig file")],
)
def test_an_ambient_temperature_that_nobody_measured_is_said_to_be_that_of_the_file(
    tmp_path, monkeypatch, by_sensor, links, source
):
    monkeypatch.setattr(SmarigEncoderDaq, "measures_ambient", by_sensor)
    run, _ = run_on(rig(tmp_path, **links), tmp_path)
    assert run.info.ambient_from == source
    text = next(part for part in conditions_text(run).split(", ") if part.startswith("ambient"))
    assert text.endswith(" °C by the rig file (not measured)" if source else " °C")
    assert ("rig file, not measured" in run_page(run)) == bool(source)
