"""The latent heat from electrical power, of a wire whose balance is integrated here in its own way."""

from dataclasses import replace

import numpy as np
import pytest

from identification.material.material_runs import fitted, isobaric_run
from identification.material.simulated_wires import Wire
from smarig.plant import Actuator

WIRE = Wire()
BASE = Actuator.named("flexinol_015")
AMBIENT, L_J_PER_KG, HA, RATE_S = 22.0, 18_000.0, 0.008, 0.4


def heated_run(load):
    """A loop in time, with the power that its balance asks for: P = hA ΔT + C dT/dt − ρVL dξ/dt − σ V dε/dt."""
    run = isobaric_run(WIRE, load, n=400)
    T, strain = run["input"], run["position"] / 100
    wire = BASE.file.wire
    volume = np.pi / 4 * (wire.diameter.value * 1e-3) ** 2 * wire.active_length.value * 1e-3
    mass = wire.density.value * volume
    t = np.arange(T.size) * RATE_S
    elastic = load / WIRE.E_A + WIRE.alpha_A * (T - 22)
    whole = WIRE.H(load) + load * WIRE.dS + (WIRE.alpha_M - WIRE.alpha_A) * (T - 22)
    xi = (strain - elastic) / whole

    def rate(x):
        return np.gradient(x, t)

    power = HA * (T - AMBIENT) + mass * 837.0 * rate(T) - mass * L_J_PER_KG * rate(xi)
    power -= load * 1e6 * volume * rate(strain)
    columns = {
        **run.columns,
        "t_s": t,
        "temperature_degC": T,
        "ambient_degC": np.full(T.size, AMBIENT),
        "current_A": np.full(T.size, 0.1),
        "voltage_V": power / 0.1,
    }
    return replace(run, columns=columns)


def test_the_latent_heat_is_found():
    found = fitted([heated_run(60), heated_run(180)], BASE)
    assert found.latent_heat.value == pytest.approx(L_J_PER_KG, rel=0.03)


def test_without_power_the_reason_is_given():
    found = fitted([isobaric_run(WIRE, load) for load in (60, 180)], BASE)
    assert "no record has current, voltage" in found.latent_heat
