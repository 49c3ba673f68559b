"""The energy of a twin: V·i against the heat stored and lost, from its temperatures and the constants of the wire."""

import math

import numpy as np
import pytest

from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.plant.effects.resistance_phase import resistance_phase
from smarig.rig.twin import Twin, TwinSettings

RIGS = {"one_wire": "gorbet_one_wire", "two_wire": "gorbet_two_wire"}


def actuator_with(name, twin_heat):
    file = Actuator.named(name).file
    return Actuator(
        file.model_copy(update={"heating": file.heating.model_copy(update={"twin_heat": twin_heat})})
    )


def heat_capacity_J_per_K(actuator):
    wire = actuator.file.wire
    volume_m3 = math.pi / 4 * (wire.diameter.value / 1e3) ** 2 * wire.active_length.value / 1e3
    return wire.density.value * volume_m3 * wire.specific_heat.value


def energies(kind, twin_heat, seed, *effects, seconds=400):
    """Electrical energy from the twin's readings, and the heat stored and lost by the trapezoidal rule, in joules."""
    actuator = actuator_with(RIGS[kind], twin_heat)
    rig = replace_period(load_rig(f"{kind}_twin"), 0.05)
    twin = Twin(rig, actuator, TwinSettings(noise=False, effects=effects))
    dice = np.random.default_rng(seed)
    electrical, wires = 0.0, [list(twin.specimen.plant.heating.wire_K)]
    for _ in range(seconds // 20):
        current_A = dice.uniform(-1 if actuator.two_wire else 0, 1)
        for _ in range(400):
            (sample,) = twin.step(current_A)
            electrical += sample.voltage_V * sample.current_A * 0.05
            wires.append(list(twin.specimen.plant.heating.wire_K))
    T = np.array(wires)
    R_mean = (
        actuator.file.heating.resistance_martensite.value + actuator.file.heating.resistance_austenite.value
    )
    hA = R_mean / 2 * actuator.file.heating.reference_current.value**2
    hA /= actuator.file.heating.reference_temperature.value
    stored = heat_capacity_J_per_K(actuator) * float((T[-1] - T[0]).sum())
    lost = hA * float(np.trapezoid(T, dx=0.05, axis=0).sum())
    return electrical, stored + lost


def replace_period(rig, period_s):
    return rig.model_copy(update={"period_s": period_s})


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("kind", RIGS)
@pytest.mark.parametrize("seed", range(3))
def test_the_energy_balances_if_the_resistance_of_the_phase_heats(kind, seed):
    electrical, heat = energies(kind, "phase_resistance", seed)
    assert heat > 100
    assert electrical == pytest.approx(heat, rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "cold_ohm", "hot_ohm"), [("one_wire", 5.0, 4.5), ("two_wire", 2.105, 1.895)]
)
def test_the_voltage_is_that_of_the_phase(kind, cold_ohm, hot_ohm):
    rig = load_rig(f"{kind}_twin")
    twin = Twin(rig, actuator_with(RIGS[kind], "phase_resistance"), TwinSettings(noise=False))
    ohm = [s.voltage_V / s.current_A for s in (twin.step(1.0)[0] for _ in range(600))]
    assert ohm[0] == pytest.approx(cold_ohm, rel=1e-3)
    assert ohm[-1] == pytest.approx(hot_ohm, rel=3e-3)


@pytest.mark.parametrize("kind", RIGS)
def test_it_balances_with_an_effect_on_the_resistance_too(kind):
    electrical, heat = energies(kind, "phase_resistance", 3, resistance_phase(-10.0))
    assert electrical == pytest.approx(heat, rel=1e-3)


@pytest.mark.long("takes a second", cases=("two_wire",))
@pytest.mark.parametrize("kind", RIGS)
def test_the_twin_of_the_thesis_is_heated_by_the_mean_resistance(kind):
    """By default V·i differs from the heat, by no more than half the difference of both resistances."""
    differences = [np.divide(*energies(kind, "mean_resistance", seed, seconds=200)) - 1 for seed in range(3)]
    assert max(map(abs, differences)) > 0.005
    assert max(map(abs, differences)) < 0.053
