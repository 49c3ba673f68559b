"""The actuator file of a material: a thermomechanical twin runs it and follows the loops at its load."""

import numpy as np
import pytest

from identification.material.material_runs import fitted, isobaric_run, isothermal_run, seeded
from identification.material.simulated_wires import Wire
from smarig.config import ActuatorFile
from smarig.core import UsageError, load_toml
from smarig.plant import Actuator, Material, ThermomechanicalPlant, isobaric_loop

NARROW = Wire(A_s=70.0, A_f=80.0, M_s=56.0, M_f=46.0, k=0.03, n=(0.8, 0.8, 0.8, 0.8))


@pytest.fixture(scope="module")
def found():
    runs = [isobaric_run(NARROW, load, seeded(load)) for load in (60, 120, 180, 240)]
    return fitted([*runs, isothermal_run(NARROW, 100.0, seeded(9))], Actuator.named("flexinol_015"))


def test_the_twin_follows_the_loop_at_its_load(found, tmp_path):
    file = load_toml(ActuatorFile, found.write_actuator(tmp_path / "wire.toml"))
    assert file.name == "wire"
    stress = found.twin.stress_MPa
    T, _, strain = NARROW.isobaric(stress)
    twin = isobaric_loop(Material.of(file), stress, T)
    error = (twin - twin.mean()) - (strain - strain.mean())
    assert np.sqrt(np.mean(error**2)) < 0.03 * np.ptp(strain)


def test_the_twin_runs(found, tmp_path):
    file = load_toml(ActuatorFile, found.write_actuator(tmp_path / "wire.toml"))
    plant = ThermomechanicalPlant(Actuator(file), dt_s=0.1, ambient_degC=22.0)
    for _ in range(300):
        position_mm = plant.step(0.41)
    length_mm = file.wire.active_length.value
    assert position_mm / length_mm == pytest.approx(NARROW.H(found.twin.stress_MPa), rel=0.15)


def test_identified_constants_are_in_the_file_with_their_intervals(found):
    section = found.twin.file.thermomechanical
    assert section.modulus_martensite.value == pytest.approx(30e3, rel=0.05)
    assert "95 %" in section.modulus_martensite.source
    assert section.latent_heat.source.startswith("Dynalloy")


def test_without_an_actuator_there_is_no_file(tmp_path):
    found = fitted([isobaric_run(NARROW, load, seeded(load)) for load in (60, 180)])
    with pytest.raises(UsageError, match="--actuator"):
        found.write_actuator(tmp_path / "wire.toml")
