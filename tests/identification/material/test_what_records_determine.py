"""What the records cannot determine is stated, and records that cannot serve are refused in one sentence."""

from dataclasses import replace

import numpy as np
import pytest

from identification.material.material_runs import fitted, isobaric_run, isothermal_run, seeded
from identification.material.simulated_wires import Wire
from smarig.core import DataError, UsageError
from smarig.plant import Actuator


def loops(*loads, **more):
    return [isobaric_run(Wire(), load, seeded(int(load)), **more) for load in loads]


def test_constant_loads_do_not_determine_the_modulus_of_martensite():
    found = fitted(loops(30, 80, 150, 250))
    assert "modulus_martensite" not in found.parameters
    assert "isothermal record" in found.not_determined["modulus_martensite"]
    assert found.strain_is_sum
    wire = Wire()
    for stress, e in found.strains:
        assert e.ci95[0] <= wire.H(stress) + stress * wire.dS <= e.ci95[1]


def test_an_isothermal_loop_determines_both_moduli():
    found = fitted([*loops(30, 150), isothermal_run(Wire(), 95.0, seeded(1))])
    assert found.parameters["modulus_martensite"].value == pytest.approx(30e3, rel=0.05)
    assert found.parameters["modulus_austenite"].value == pytest.approx(70e3, rel=0.05)


@pytest.mark.long("takes three seconds")
def test_zeros_of_their_own_leave_the_modulus_of_austenite_open():
    runs = [
        isobaric_run(Wire(), load, seeded(load), shift=shift)
        for load, shift in ((50, 0.0), (100, -0.012), (150, 0.02))
    ]
    found = fitted(runs)
    assert found.own_zeros
    assert "zero of its own" in found.not_determined["modulus_austenite"]


def test_a_record_does_not_count_twice():
    first, second = loops(30, 80)
    with pytest.raises(UsageError, match="hold the same readings, which would count twice"):
        fitted([first, second, first])


def test_one_load_cannot_determine_the_slopes():
    with pytest.raises(UsageError, match="cannot determine C_A and C_M.*another load"):
        fitted(loops(100))


def test_one_load_with_the_slopes_of_an_actuator():
    found = fitted(loops(100), Actuator.named("flexinol_015"))
    assert "another load" in found.not_determined["slope_austenite"]
    assert found.law.slope_austenite == 8.0
    assert found.rms < 2e-4


def test_a_record_without_cooling_has_no_loop():
    run = loops(100)[0]
    half = replace(run, columns={k: v[:100] for k, v in run.columns.items()})
    with pytest.raises(DataError, match="no loop: cooling is missing"):
        fitted([half, *loops(50)])


def test_a_record_without_transformation():
    run = loops(100)[0]
    flat = replace(run, columns={**run.columns, "position": 1e-3 * run["input"]})
    with pytest.raises(DataError, match="shows no loop"):
        fitted([flat, *loops(50)])


@pytest.mark.parametrize(
    ("meta", "match"),
    [
        ({"conditions": {}}, "does not state its stress in MPa"),
        ({"conditions": {"stress": {"mean": 14.5, "unit": "ksi"}}}, "does not state its stress in MPa"),
        ({"output": {"quantity": "force", "unit": "N"}}, "needs a strain"),
        ({"input": {"quantity": "current", "unit": "A"}}, "temperature in °C or K, or over a stress in MPa"),
    ],
)
def test_wrong_units_are_named(meta, match):
    with pytest.raises(UsageError, match=match):
        fitted([loops(100)[0].with_meta(**meta), *loops(50)])


def test_a_strain_in_percent_that_is_declared_as_a_number():
    with pytest.raises(UsageError, match="which no wire does. Check its unit"):
        fitted([loops(100)[0].with_meta(output={"quantity": "strain", "unit": "1"}), *loops(50)])


@pytest.mark.long("takes five seconds")
def test_units_do_not_matter():
    """Percent, numbers, microstrain, and kelvin in place of °C give one material."""
    percent, number = fitted(loops(50, 120)), fitted(loops(50, 120, unit="1"))
    assert number.law.austenite_start == pytest.approx(percent.law.austenite_start, abs=0.02)
    kelvin = [
        replace(r, columns={**r.columns, "input": r["input"] + 273.15}).with_meta(
            input={"quantity": "temperature", "unit": "K"}
        )
        for r in loops(50, 120)
    ]
    assert fitted(kelvin).law.austenite_start == pytest.approx(percent.law.austenite_start, abs=0.02)


@pytest.mark.long("takes two seconds")
def test_noise_of_the_thermometer_makes_no_branches():
    runs = [
        replace(r, columns={**r.columns, "input": r["input"] + 0.2 * seeded(k).normal(size=len(r))})
        for k, r in enumerate(loops(50, 150))
    ]
    found = fitted(runs)
    assert all(len(r.record.branches) == 2 for r in found.records)
    assert np.isfinite(found.rms)
