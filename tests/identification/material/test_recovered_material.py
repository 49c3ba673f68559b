"""Parameters of simulated wires are found again, and their intervals hold them as often as they should."""

from dataclasses import replace

import numpy as np
import pytest

from identification.material.material_runs import fitted, isobaric_run, isothermal_run, seeded
from identification.material.simulated_wires import Wire, random_wire, with_slopes_at

LOADS = (20, 60, 120, 200, 300)
EXPONENTS = (
    "exponent_cooling_start",
    "exponent_cooling_finish",
    "exponent_heating_finish",
    "exponent_heating_start",
)
TRUE = {
    "modulus_austenite": "E_A",
    "modulus_martensite": "E_M",
    "strain_least": "H_min",
    "strain_saturated": "H_sat",
    "strain_rate": "k",
    "strain_stress": "stress_crit",
    "austenite_start": "A_s",
    "austenite_finish": "A_f",
    "martensite_start": "M_s",
    "martensite_finish": "M_f",
    "slope_austenite": "C_A",
    "slope_martensite": "C_M",
    "expansion_austenite": "alpha_A",
    "expansion_martensite": "alpha_M",
}


def true_value(wire, name, reference_stress):
    wire = with_slopes_at(wire, reference_stress)
    return wire.n[EXPONENTS.index(name)] if name in EXPONENTS else getattr(wire, TRUE[name])


def records_of(wire, rng):
    return [
        *(isobaric_run(wire, load, rng) for load in LOADS),
        *(isothermal_run(wire, wire.A_f + above, rng) for above in (15, 30)),
    ]


def inside(found, wire):
    """For each determined parameter, whether its interval holds the truth."""
    stress = found.law.reference_stress
    return {
        name: e.ci95[0] <= true_value(wire, name, stress) <= e.ci95[1] for name, e in found.parameters.items()
    }


def test_parameters_are_recovered_from_exact_loops():
    """Against roots of the transformation functions, which share no code with the fit."""
    wire = Wire()
    found = fitted(records_of(wire, None))
    assert found.rms < 5e-6
    for name in TRUE:
        if name in ("strain_stress",):
            continue
        truth = true_value(wire, name, found.law.reference_stress)
        assert getattr(found.law, name) == pytest.approx(truth, rel=0.02, abs=1e-7), name
    assert not found.two_parts


@pytest.mark.long("takes five seconds")
def test_a_wire_that_shows_no_strain_below_a_stress():
    """H_min = 0 and σ_crit > 0: the other branch of the strain law."""
    wire = Wire(H_min=0.0, stress_crit=40.0, k=0.015)
    found = fitted([isobaric_run(wire, load, seeded(3)) for load in (60, 90, 130, 200, 300)])
    assert found.law.strain_least == 0.0
    assert found.law.strain_stress == pytest.approx(40.0, abs=8.0)


@pytest.mark.long("takes fifteen seconds")
def test_intervals_hold_the_truth():
    """Two wires; the long test counts twenty."""
    hits = [h for seed in (21, 22) for h in _hits(seed)]
    assert len(hits) > 30
    assert 0.85 <= np.mean(hits) <= 1.0


@pytest.mark.long("twenty wires are fitted")
def test_intervals_hold_the_truth_of_twenty_wires():
    hits = [h for seed in range(20) for h in _hits(seed)]
    assert 0.90 <= np.mean(hits) <= 0.97


def _hits(seed):
    rng = seeded(seed)
    wire = random_wire(rng)
    return inside(fitted(records_of(wire, rng)), wire).values()


@pytest.mark.long("takes five seconds")
def test_a_material_of_two_widths_is_recognised():
    """Half of the material transforms over six times the range: one width does not do."""
    narrow, wide = Wire(), replace(Wire(), A_s=22.0, A_f=118.0, M_s=97.5, M_f=-4.5)
    runs = []
    for load in (50, 100, 150, 250):
        run, other = isobaric_run(narrow, load, n=150), wide
        T, s = run["input"], np.full(len(run), float(load))
        strain = 0.5 * narrow.follow(T, s, martensite=True) + 0.5 * other.follow(T, s, martensite=True)
        columns = {**run.columns, "position": 100 * strain + 0.002 * seeded(load).normal(size=T.size)}
        runs.append(replace(run, columns=columns))
    found = fitted(runs)
    assert found.two_parts
    assert found.parameters["wide_share"].value == pytest.approx(0.5, abs=0.1)
    assert found.parameters["wide_factor"].value == pytest.approx(6.0, rel=0.25)
