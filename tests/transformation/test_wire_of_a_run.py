"""Temperatures of a rig's run whose heat loss is not linear, and which no thermometer measured."""

from dataclasses import replace

import numpy as np
import pytest

import smarig
from smarig.plant import effects_from_arguments
from smarig.rig import TwinSettings
from smarig.transformation import run_figures

NAMES = ("A_s", "A_f", "M_s", "M_f")
STRESS_MPa = 19.61 / (np.pi / 4 * 0.3**2)


def strain(temperature, martensite):
    """Brinson's wire with the constants of the actuator file: elastic, transformation and thermal strain."""
    modulus_MPa = 35917 + martensite * (16800 - 35917)
    expansion = 11e-6 + martensite * (6.6e-6 - 11e-6)
    return STRESS_MPa / modulus_MPa + 0.0261 * martensite + expansion * (temperature - 22)


def tangents(start, finish):
    """(lower, upper) corner in °C of a cosine law from a start to a finish temperature, in closed form."""
    t = np.linspace(22.0, 122.0, 4001)
    low, high = sorted((start, finish))
    y = -strain(t, 0.5 + 0.5 * np.cos(np.pi * np.clip((t - low) / (high - low), 0, 1)))
    slope = np.gradient(y, t)
    k = int(np.argmax(slope))
    plateaus = [np.polyfit(t[rows], y[rows], 1) for rows in (t < low - 0.5, t > high + 0.5)]
    return [float((b - y[k] + slope[k] * t[k]) / (slope[k] - a)) for a, b in plateaus]


def true_degC():
    a_s, a_f = tangents(33 + STRESS_MPa / 8, 60 + STRESS_MPa / 8)
    m_f, m_s = tangents(27 + (STRESS_MPa - 50) / 8, 27 + (STRESS_MPa - 274) / 8)
    return {"A_s": a_s, "A_f": a_f, "M_s": m_s, "M_f": m_f}


TRUE_DEGC = true_degC()


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    out = tmp_path_factory.mktemp("cycles") / "cycles.run.sqlite"
    return smarig.run("constant_force_cycles", rig="one_wire_thermomechanical", out=out, seed=3, cycles=1)


def without(run, *columns):
    """The run without readings of some channels."""
    return replace(run, columns=run.columns | {name: np.full(len(run), np.nan) for name in columns})


def ends_degC(found, name):
    low, high = found.means[name].ci95
    return found.degC(low), found.degC(high)


def test_voltage_and_current_tell_the_temperatures_of_the_wire(run):
    found = run_figures(run)
    for name, true in TRUE_DEGC.items():
        assert found.degC(found.means[name].value) == pytest.approx(true, abs=0.5), name
        low, high = ends_degC(found, name)
        assert low <= true <= high, name
    assert any("voltage and current" in note for note in found.notes)


def test_the_current_alone_tells_them_with_the_error_of_its_heat_loss(run):
    """By 4 to 13 K they are wrong, and the intervals say so."""
    found = run_figures(without(run, "voltage_V"))
    assert found.degC(found.means["A_s"].value) == pytest.approx(58.5, abs=1.0)
    for name, true in TRUE_DEGC.items():
        low, high = ends_degC(found, name)
        assert low <= true <= high, name
    assert any("heating model" in note for note in found.notes)


def test_the_heat_loss_moves_all_temperatures_together(run):
    """So their differences, and their changes from run to run, are known better than each of them."""
    found = run_figures(run)
    above = {name: found.means[name] for name in NAMES}
    share = {n: np.std(d.draws) / d.value for n, d in above.items()}
    assert share["A_f"] == pytest.approx(0.05, abs=0.01)
    assert np.corrcoef(above["A_s"].draws, above["A_f"].draws)[0, 1] > 0.95
    width = found.means["width"]
    assert np.std(width.draws) / width.value == pytest.approx(0.05, abs=0.01)


def test_a_twin_is_exact_only_without_effects(tmp_path):
    def figures(name, **twin):
        settings = TwinSettings(seed=1, **twin)
        with smarig.Session("one_wire_twin", twin=settings) as session:
            out, asked = tmp_path / f"{name}.run.sqlite", {"cycles": 1, "points": 20}
            return run_figures(smarig.load_run(session.run("constant_force_cycles", asked, out)))

    exact = figures("plain")
    bent = figures("bent", effects=effects_from_arguments(["convection=0.15"]))
    assert any("heated by that model" in note for note in exact.notes)
    assert not any("heated by that model" in note for note in bent.notes)
    low, high = bent.means["A_f"].ci95  # the heat loss of the effect moves the value by 12 K
    assert abs(bent.means["A_f"].value - exact.means["A_f"].value) > 10
    assert low <= exact.means["A_f"].value <= high


def test_a_settled_run_whose_actuator_file_is_gone_has_temperatures_without_their_error(run):
    """As of an earlier version, which recorded the name of the file alone."""
    lost = replace(
        without(run, "voltage_V"), meta=run.meta | {"actuator": "./gone.toml", "actuator_values": {}}
    )
    found = run_figures(lost)
    assert any("Its error is not in the intervals" in note for note in found.notes)
    assert np.ptp(found.means["A_s"].ci95) < 2
