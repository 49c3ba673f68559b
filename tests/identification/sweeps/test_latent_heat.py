"""Latent heat and free convection in sweeps: of a thermomechanical wire, and of an equation written here."""

from functools import cache

import numpy as np
import pytest

from identification.sweeps.relay_wire import TAU_S, swept_run
from smarig.identification.sweeps.heating_of_sweeps import heating_of_sweeps
from smarig.identification.sweeps.sweep_heat import SweepHeat, convection_exponent, heated_along
from smarig.plant import Actuator
from smarig.record import load_run
from smarig.rig import TwinSettings
from smarig.runner import Preview, Session

TRUE_TAU_S, TRUE_LATENT_K = (
    6.44,
    24.4,
)  # of the rig's file by Churchill and Chu; 28.8 K of true scale 57.8/49.1
NO_PREVIEW = Preview("continuous_reversal_curves", 0.0, 0, 0.0, 0.0, 0, 0)


@pytest.fixture(scope="module")
def heating(tmp_path_factory):
    out = tmp_path_factory.mktemp("sweeps") / "fast.run.sqlite"
    with Session("one_wire_thermomechanical", twin=TwinSettings(seed=3)) as session:
        run = load_run(session.run("continuous_reversal_curves", {}, out, expected=NO_PREVIEW))
    return heating_of_sweeps([run])


@pytest.mark.long("takes five seconds")
def test_tau_of_a_thermomechanical_wire_is_that_without_transformation(heating):
    tau = heating.parameters["tau"]
    assert tau.value == pytest.approx(TRUE_TAU_S, rel=0.03)
    assert tau.ci95[0] < TRUE_TAU_S < tau.ci95[1]


@pytest.mark.long("takes five seconds")
def test_its_latent_heat_is_found_and_stated(heating):
    latent = heating.parameters["latent_heat"]
    assert latent.unit == "K"
    assert latent.value == pytest.approx(TRUE_LATENT_K, rel=0.15)
    assert heating.to_json()["convection_exponent"] == pytest.approx(0.125, abs=0.01)
    assert any("A constant τ leaves" in warning for warning in heating.warnings)
    assert heating.swept.major_rms < 0.5 * heating.swept.constant_rms


@cache
def plain():
    return heating_of_sweeps([swept_run({"curves": 8})])


@pytest.mark.long("takes three seconds")
def test_a_wire_with_a_constant_tau_gets_no_latent_heat():
    assert "latent_heat" not in plain().parameters
    assert plain().swept.heat.is_constant_tau


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize("tau", [0.8, 1.25])
def test_a_resistance_that_falls_while_the_wire_transforms_does_not_move_tau(tau):
    """By the current alone it is 3 % less, ten of its half intervals."""
    found = heating_of_sweeps([swept_run({"curves": 8}, tau=tau, by_power=True)])
    low, high = found.parameters["tau"].ci95
    assert low < tau * TAU_S < high
    assert high - low < 0.02 * tau * TAU_S
    assert found.to_json()["heats_by"] == "electrical power"
    assert "latent_heat" not in found.parameters


def test_inputs_obey_the_equation_of_the_wire():
    """Against the equation's own derivative, and its steady state."""
    t = np.arange(3000) * 0.01
    source, y = 60 + 40 * np.sin(t / 3), 5 + 5 * np.sin(t / 4)
    heat = SweepHeat(latent_K_per_unit=2.0, exponent=0.12, resistances_ohm=(5.0, 4.5), ends=(0.0, 10.0))
    theta, u = heated_along(heat, 6.0, source, np.full(t.size, 0.01), y, 60.0, 50.0)
    rho = (5.0 - 0.05 * y) / 4.75
    lost = 50.0 * (theta / 50.0) ** 1.12
    rate = np.gradient(theta + 2.0 * y, t)
    assert rate[5:-5] == pytest.approx(((rho * source - lost) / 6.0)[5:-5], abs=0.02)
    assert u == pytest.approx(lost / rho)
    still = heated_along(heat, 6.0, np.full(9000, 80.0), np.full(9000, 0.1), np.full(9000, 3.0), 20.0, 50.0)
    assert still[1][-1] == pytest.approx(80.0)


def test_without_latent_heat_and_convection_it_is_the_heating_law():
    source, dt = np.array([10.0, 50.0, 90.0, 20.0]), np.full(4, 0.7)
    u = heated_along(SweepHeat(), 5.0, source, dt, np.zeros(4), 0.0, 50.0)[1]
    expected, value = [], 0.0
    for s in source:
        value = s + (value - s) * np.exp(-0.7 / 5.0)
        expected.append(value)
    assert u == pytest.approx(expected)


def test_the_exponent_is_that_of_published_correlations_for_thin_wires():
    """Between 1/16 of the limit of a thin wire and 1/4 of a laminar boundary layer."""
    for name in ("flexinol_015", "flexinol_031", "gorbet_one_wire"):
        assert 0.06 < convection_exponent(Actuator.named(name), 150.0) < 0.25
