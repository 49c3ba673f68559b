"""Runs with loops of simulated wires, as they come from imported files."""

import numpy as np

from identification.material.simulated_wires import noise
from smarig.identification import identify_material
from smarig.record import run_of_arrays


def isobaric_run(wire, stress, rng=None, *, unit="%", n=100, shift=0.0):
    """A loop over temperature; strain in % or 1, from a zero that is shifted."""
    T, _, strain = wire.isobaric(stress, n)
    run = _run(f"{stress:g} MPa", T, _with_noise(strain, rng) + shift, unit)
    conditions = {"stress": {"mean": float(stress), "unit": "MPa"}}
    return run.with_meta(input={"quantity": "temperature", "unit": "degC"}, conditions=conditions)


def isothermal_run(wire, temperature, rng=None, *, unit="%", n=100):
    """A loop over stress above A_f."""
    _, stress, strain = wire.isothermal(temperature, n=n)
    run = _run(f"{temperature:g} degC", stress, _with_noise(strain, rng), unit)
    conditions = {"temperature": {"mean": float(temperature), "unit": "degC"}}
    return run.with_meta(input={"quantity": "stress", "unit": "MPa"}, conditions=conditions)


def _with_noise(strain, rng):
    return strain if rng is None else strain + noise(rng, strain.size)


def _run(name, u, strain, unit):
    run = run_of_arrays(u, strain * (100.0 if unit == "%" else 1.0), unit=unit)
    return run.with_meta(output={"quantity": "strain", "unit": unit}, name=name)


def seeded(seed):
    """A generator."""
    return np.random.default_rng(seed)


def fitted(runs, actuator=None):
    """The material of runs, without the predictions of loads left out."""
    return identify_material(runs, actuator, leave_out=False)
