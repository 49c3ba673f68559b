"""Of several strains, the one along the load is the output: by its name, or by its agreement with an elongation."""

import numpy as np
import pytest

from smarig.exchange import FoundColumn, FoundTable, convert, known_unit
from smarig.study import guess_table
from smarig.study.quantity_words import name_and_unit, quantity_of_name

K = np.arange(400)
T = 60 + 30 * np.sin(K / 20)
AXIAL = 0.02 - 0.02 * np.tanh(np.roll(T - 60, 4) / 9)
LATERAL = -0.45 * AXIAL


def guess_of(tmp_path, **columns):
    known = {"t [s]": K, "T [degC]": T} | columns
    found = tuple(FoundColumn(name, "", np.asarray(values, dtype=float)) for name, values in known.items())
    return guess_table(FoundTable(tmp_path / "a.csv", "csv", "", found, {"file": {"delimiter": "comma"}}, {}))


NAMES = [
    ("exx [1]", "eyy [1]", "Delta L / L0 [%]"),
    ("Strain X [1]", "Strain Y [1]", "Extensometer strain [%]"),
    ("e_xx", "e_yy", "dL/L0 [%]"),
]


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_the_strain_that_agrees_with_the_elongation(tmp_path, names, order):
    values = dict(zip(names, (LATERAL, AXIAL, 100 * AXIAL + 0.3)))  # of another zero
    guess = guess_of(tmp_path, **{names[k]: values[names[k]] for k in order})
    assert guess.first("output").name in names[1:]
    assert not guess.doubts


@pytest.mark.parametrize("names", [("Strain 1", "Strain 2"), ("exx", "eyy"), ("SG left", "SG right")])
def test_strains_that_nothing_tells_apart_are_a_question(tmp_path, names):
    guess = guess_of(tmp_path, **dict(zip(names, (LATERAL, AXIAL))))
    assert guess.doubts == ["output"]


@pytest.mark.parametrize(
    "names",
    [("Lateral strain", "Strain"), ("Querdehnung", "Dehnung"), ("Strain 1", "Axial strain"), ("exy", "eyy")],
)
@pytest.mark.parametrize("turned", [1, -1])
def test_a_name_that_says_it_counts(tmp_path, names, turned):
    columns = list(zip(names, (LATERAL, AXIAL)))[::turned]
    guess = guess_of(tmp_path, **dict(columns))
    assert guess.first("output").name == names[1]
    assert not guess.doubts


def test_strains_that_agree_are_no_question(tmp_path):
    guess = guess_of(tmp_path, **{"Strain [%]": 100 * AXIAL, "True strain [%]": 100 * np.log1p(AXIAL)})
    assert guess.first("output").name == "Strain [%]"
    assert not guess.doubts


@pytest.mark.parametrize("unit", ["pixel", "px", "foo"])
def test_a_stress_in_a_unit_that_is_not_known_is_no_load(tmp_path, unit):
    columns = {f"sigma [{unit}]": 0.01 + 1e-4 * np.cos(K), "Load [N]": 120 + np.cos(K), "Strain": AXIAL}
    guess = guess_of(tmp_path, **columns)
    assert [c.name for c in guess.of_role("condition")] == ["Load [N]"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("dL/Lo/*10^-3", "1e-3"),
        ("dL/L0/*1E-03", "1e-3"),
        ("ΔL/L0/e-6", "ppm"),
        ("dL/L0 [E-03]", "1e-3"),
        ("ΔL/L0/10⁻³", "1e-3"),
        ("dL/L0 /10^-6", "ppm"),
        ("dL/L0/ppm", "ppm"),
        ("dL/L0/%", "%"),
        ("dL/L0 (x 10^-3)", "1e-3"),
        ("delta L/L0 [‰]", "1e-3"),
        ("dL/L0", "mm/mm"),
    ],
)
def test_a_quotient_of_lengths_is_a_strain(tmp_path, name, unit):
    factor = {"1e-3": 1e3, "ppm": 1e6, "%": 100, "mm/mm": 1}[unit]
    guess = guess_of(tmp_path, **{name: factor * AXIAL})
    out = guess.first("output")
    assert (out.quantity, out.unit) == ("strain", unit)
    assert not guess.doubts


def test_a_strain_in_a_unit_that_is_not_known_is_a_question(tmp_path):
    assert guess_of(tmp_path, **{"dL/L0 [foo]": AXIAL}).doubts == ["unit dL/L0 [foo]"]


@pytest.mark.parametrize("name", ["Kraft/N", "rig/T", "dB/dt", "sigma/MPa"])
def test_other_strokes_are_as_before(name):
    assert quantity_of_name(name_and_unit(name)[0])[0] != "strain"


@pytest.mark.parametrize("unit", ["m/m", "%", "µstrain", "in"])
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_an_extensometer_comes_before_what_moves_the_grip(tmp_path, unit, order):
    columns = {"Actuator position [in]": AXIAL, f"Extensometer 632 [{unit}]": AXIAL}
    names = list(columns)
    guess = guess_of(tmp_path, **{names[k]: columns[names[k]] for k in order})
    assert guess.first("output").name == names[1]
    assert guess.first("output").quantity == ("displacement" if unit == "in" else "strain")


@pytest.mark.parametrize(
    ("unit", "newtons"), [("lbf", 4.448222), ("kgf", 9.80665), ("kip", 4448.222), ("gf", 9.80665e-3)]
)
def test_units_of_force_of_testing_machines_are_known(unit, newtons):
    assert convert(1.0, known_unit(unit), "N") == pytest.approx(newtons, rel=1e-3)
