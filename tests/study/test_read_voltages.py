"""A voltage beside a temperature is read, unless it rises and falls with a current that heats."""

import numpy as np
import pytest

from smarig.study import guess_table
from study.known_data import table_of

K = np.arange(400)


@pytest.mark.parametrize("current", [0.05 + 1e-6 * np.sin(K), 0.2 + 0.01 * (K % 37) / 37])
def test_a_voltage_that_no_current_moves_is_read_and_does_not_heat(current):
    u = 60 - 35 * np.cos(K / 31)
    taps = 2e-3 * (1 - 0.1 * np.tanh((u - 60 - 8 * np.sign(np.sin(K / 31))) / 9))
    found = guess_table(table_of(**{"t [s]": 2.0 * K, "T [°C]": u, "taps [V]": taps, "I 2 [A]": current}))
    assert (found.first("input").name, found.first("output").name) == ("T [°C]", "taps [V]")


def test_a_voltage_that_moves_with_its_current_heats():
    current = 0.5 - 0.5 * np.cos(K / 31)
    columns = {"t [s]": 2.0 * K, "T [°C]": 25 + 60 * current**2, "U [V]": 3 * current, "I [A]": current}
    assert guess_table(table_of(**columns)).first("output") is None
