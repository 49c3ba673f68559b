"""A value that was commanded is never used in place of the measured one of its quantity, in whatever words."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.study import guess_table
from study.known_data import displacements, table_of, temperatures

U = temperatures()
X = displacements(U)
T = np.arange(U.size) * 0.5
CURRENT = np.sqrt(np.clip(U - 15, 0, None)) / 4
NOISE = np.random.default_rng(3).normal(0, 1e-3, U.size)


@pytest.mark.parametrize(
    ("commanded", "measured"),
    [
        ("GVL.fVorgabeStrom", "GVL.fMessStrom"),
        ("rSollStrom", "rIstStrom"),
        ("HeaterCurrentSetpoint", "HeaterCurrent"),
        ("Courant consigne", "Courant"),
        ("CurrentTarget", "CurrentActual"),
        ("AO_CurrentCmd", "AI_Current"),
        ("Corriente consigna", "Corriente"),
    ],
)
def test_the_measured_current_is_the_input(commanded, measured):
    signals = {f"{commanded} [A]": CURRENT, f"{measured} [A]": CURRENT + NOISE}
    guess = guess_table(table_of(**{"time [s]": T}, **signals, **{"stroke [mm]": X}))
    assert [c.name for c in guess.of_role("input")] == [f"{measured} [A]"]
    assert [c.name for c in guess.of_role("command")] == [f"{commanded} [A]"]


@pytest.mark.parametrize("comment", ["Sollwert", "commanded value", "valeur de consigne"])
def test_a_comment_says_that_a_value_was_commanded(comment):
    table = table_of(**{"t [s]": T, "I1 [A]": CURRENT, "I2 [A]": CURRENT + NOISE, "stroke [mm]": X})
    columns = [replace(c, comment=comment) if c.name == "I1 [A]" else c for c in table.columns]
    assert [c.name for c in guess_table(replace(table, columns=tuple(columns))).of_role("input")] == [
        "I2 [A]"
    ]


def test_a_commanded_stroke_is_no_output():
    columns = {"time [s]": T, "T [°C]": U, "stroke command [mm]": X, "stroke [mm]": X + NOISE}
    assert [c.name for c in guess_table(table_of(**columns)).of_role("output")] == ["stroke [mm]"]


def test_a_supply_is_no_voltage_of_the_wire():
    columns = {"time [s]": T, "I [A]": CURRENT, "U link [V]": 48 + NOISE, "stroke [mm]": X}
    assert not guess_table(table_of(**columns)).of_role("voltage")


@pytest.mark.parametrize(
    "name", ["Position Error", "Following error", "Schleppfehler Weg", "Erreur de position"]
)
def test_what_a_controller_has_left_is_no_output(name):
    columns = {"time [s]": T, "T [°C]": U, f"{name} [mm]": 3 - X, "position [mm]": X}
    assert [c.name for c in guess_table(table_of(**columns)).of_role("output")] == ["position [mm]"]
