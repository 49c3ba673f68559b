"""The load on a single wire: forces over time, stresses, and what is refused."""

import math

import numpy as np
import pytest

from smarig.config import load_rig, with_load
from smarig.core import ConfigError, DataError, SmarigError, UsageError
from smarig.plant import Actuator, Load, PowerTemperature, ThermomechanicalPlant, load_of

SECTION_MM2 = math.pi / 4 * 0.3**2


def loaded(text, rig="one_wire_thermomechanical"):
    file = with_load(load_rig(rig), text)
    return load_of(file, Actuator.named(file.actuator))


def test_a_number_is_a_weight_and_its_stress_is_force_over_section():
    load = loaded("15")
    assert not load.changes
    assert load.stress_MPa([0.0, 9.0]) == pytest.approx([15 / SECTION_MM2] * 2)


def test_without_a_load_a_rig_has_the_weight_of_its_actuator():
    file = load_rig("one_wire_thermomechanical")
    assert load_of(file, Actuator.named(file.actuator)).force_N == 19.61
    assert load_of(load_rig("one_wire_twin"), Actuator.named("gorbet_one_wire")) is None


def test_a_formula_and_a_file_are_forces_over_time(tmp_path):
    path = tmp_path / "load.csv"
    path.write_text("time_s,force_N\n10,20\n20,30\n")
    t = [0.0, 10.0, 15.0, 20.0, 99.0]
    assert loaded(str(path)).stress_MPa(t) * SECTION_MM2 == pytest.approx([20, 20, 25, 30, 30])
    assert loaded("20 + 2*sin(t)").stress_MPa(t) * SECTION_MM2 == pytest.approx(20 + 2 * np.sin(t))
    for text in ("15", "20 + 2*sin(t)", str(path)):
        load = loaded(text)
        assert Load.from_json(load.to_json()) == load


def test_the_file_of_a_rig_lies_beside_it(tmp_path):
    (tmp_path / "load.csv").write_text("time_s,force_N\n0,20\n20,30\n")
    rig = tmp_path / "rig.toml"
    rig.write_text(
        'name = "r"\nkind = "twin"\nbase = "one_wire_thermomechanical"\nactuator = "thermomechanical_one_wire"\n'
        '[load]\nfile = "load.csv"\n'
    )
    file = load_rig(str(rig))
    assert load_of(file, Actuator.named(file.actuator)).force()(10.0) == 25.0


@pytest.mark.parametrize(
    ("text", "rig", "words"),
    [
        ("15", "two_wire_thermomechanical", "load each other"),
        ("15", "one_wire_twin", "is a Preisach operator"),
        ("15", "one_wire_serial", "is a Preisach operator"),
        ("80", "one_wire_thermomechanical", "1132 MPa"),
        ("-1", "one_wire_thermomechanical", "more than 0"),
        ("nan", "one_wire_thermomechanical", "more than 0|not plausible|contains"),
        ("5*u", "one_wire_thermomechanical", "contains 'u'"),
        ("-3 + t", "one_wire_thermomechanical", "only pulls"),
        ("missing.csv", "one_wire_thermomechanical", "missing"),
    ],
)
def test_a_load_that_cannot_be_is_refused_in_a_sentence(text, rig, words):
    with pytest.raises(SmarigError, match=words):
        loaded(text, rig)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("t,F\n0,1\n", "header time_s,force_N"),
        ("time_s,force_N\n0,20\n", "two rows"),
        ("time_s,force_N\n0,20\n0,21\n", "increasing times"),
        ("time_s,force_N\n0,20\n1,x\n", "line 3"),
        ("time_s,force_N\n0,20\n1,-4\n", "at t = 1 s"),
    ],
)
def test_a_damaged_file_of_a_load_is_refused(tmp_path, rows, words):
    path = tmp_path / "load.csv"
    path.write_text(rows)
    with pytest.raises((DataError, UsageError), match=words):
        loaded(str(path))


def test_exactly_one_key_describes_a_load(tmp_path):
    rig = tmp_path / "rig.toml"
    rig.write_text(
        'name = "r"\nkind = "twin"\nbase = "one_wire_thermomechanical"\nactuator = "thermomechanical_one_wire"\n'
        '[load]\nforce_N = 20.0\nformula = "t"\n'
    )
    with pytest.raises(ConfigError, match="exactly one"):
        load_rig(str(rig))


def test_the_temperature_of_the_measured_power_is_that_of_the_wire():
    """The wire has heat capacity, latent heat and phases that the temperature by its power does not know."""
    actuator = Actuator.named("thermomechanical_one_wire")
    plant, wire = ThermomechanicalPlant(actuator, 0.1, 22.0, 24.0), PowerTemperature(actuator)
    for current_A in (0.4, 0.6, 0.75, 0.5, 0.3):
        for _ in range(1500):
            plant.step(current_A)
        power_W = current_A**2 * plant.resistance_ohm(current_A)
        assert wire.steady_K(power_W, 22.0) == pytest.approx(plant.wire_K[0], abs=5e-3)
        assert abs(actuator.input_for(current_A) - plant.wire_K[0]) > 2.0, (
            "the heating model is another scale"
        )


def test_a_constant_heat_loss_gives_the_temperature_of_the_heating_model():
    actuator = Actuator.named("gorbet_one_wire")
    power_W = 0.6**2 * actuator.resistance_ohm
    wire, dt_s = PowerTemperature(actuator), np.full(200, 0.1)
    assert wire.steady_K(power_W, 22.0) == pytest.approx(actuator.input_for(0.6), rel=1e-9)
    along = wire.along(np.full(200, power_W), dt_s, np.full(200, 22.0))
    decay = np.exp(-20.0 / actuator.tau_s)
    assert along[-1] == pytest.approx(actuator.input_for(0.6) * (1 - decay), rel=1e-6)
