"""A charge that is the integral of the measured current is no output beside the voltage of a sensor."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.study import guess_table
from study.known_data import table_of

K = np.arange(400)
VOLTS = 0.6 * np.sin(K / 30)
BENDS = 1.2 + 0.3 * np.sin(K / 30 - 0.5) ** 3
AMPERES = 2e-3 * np.cos(K / 30)
LINE = "tip displacement on AUX 2 (1 V = 0.5 mm)"


def guess(header=(), sensor="AUX 2 [V]", current=AMPERES, **more):
    columns = {"t [s]": 0.1 * K, "E [V]": VOLTS, "I [A]": current, "Q [C]": 0.1 * np.cumsum(AMPERES), **more}
    return guess_table(replace(table_of(**columns, **{sensor: BENDS}), header=dict(header)))


def test_the_sensor_that_a_line_names_is_the_output():
    found = guess({"Remark": LINE})
    assert (found.first("input").name, found.first("output").name) == ("E [V]", "AUX 2 [V]")
    assert not found.doubts


@pytest.mark.parametrize("header", [{}, {"Remark": "tip displacement"}, {"Remark": "AUX 2 recorded"}])
def test_without_such_a_line_it_is_a_question(header):
    found = guess(header)
    assert (found.first("input").name, found.first("output").name) == ("E [V]", "AUX 2 [V]")
    assert found.doubts == ["output"]
    assert "'AUX 2 [V]' or 'Q [C]'" in found.roles["AUX 2 [V]"].reason


def test_a_charge_that_was_measured_stays_the_output():
    found = guess(current=1e-3 * np.random.default_rng(3).standard_normal(K.size))
    assert found.first("output").name == "Q [C]"
    assert not found.doubts


@pytest.mark.parametrize("sensor", ["Monitor [V]", "E counter [V]"])
def test_another_electrode_is_no_sensor(sensor):
    found = guess(sensor=sensor)
    assert found.first("output").name == "Q [C]"


def test_a_copy_of_the_input_is_no_sensor():
    columns = {"t [s]": 0.1 * K, "E [V]": VOLTS, "I [A]": AMPERES, "Q [C]": 0.1 * np.cumsum(AMPERES)}
    found = guess_table(table_of(**columns, **{"Input 1 [V]": 10 * VOLTS}))
    assert found.first("output").name == "Q [C]"
