"""Headings of columns: which of their brackets is the unit, and what is a remark or a name."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.exchange import FoundColumn, convert
from smarig.study import guess_table
from study.known_data import displacements, table_of, temperatures

U = temperatures()
X = displacements(U)
T = np.arange(U.size) * 0.5


@pytest.mark.parametrize(
    ("drive", "out", "units"),
    [
        ("Temperatur (Kanal 3) [°C]", "Weg (Analog 2) [µm]", ("degC", "um")),
        ("204 <Twire> (C)", "207 <Rprobe> (OHM)", ("degC", "ohm")),
        ("Temp, °C (LGR S/N: 2044, LBL: wire)", "Voltage, mV (LGR S/N: 2044, LBL: NTC)", ("degC", "mV")),
        ("Temperature (K)", "Resistivity Ch2 (Ohm-m)", ("K", "ohm m")),
        ("Temperature (K)", "rho (µΩ·cm)", ("K", "uohm cm")),
    ],
)
def test_the_last_bracket_is_the_unit(drive, out, units):
    shift = 273.15 if units[0] == "K" else 0.0
    guess = guess_table(table_of(**{"Time (s)": T, drive: U + shift, out: 2 - X}))
    found = {role: (c.name, c.unit) for role in ("input", "output") for c in guess.of_role(role)}
    assert found == {"input": (drive, units[0]), "output": (out, units[1])}
    assert not guess.doubts


def test_a_resistivity_is_converted():
    assert convert(np.array([2.0]), "uohm cm", "ohm m") == pytest.approx([2e-8])


def test_a_voltage_that_leads_the_temperature_heats():
    heating = np.repeat(np.tile([2.0, 6.0], 6), 40)
    warmed = np.full(heating.size, 25.0)
    for k in range(1, warmed.size):
        warmed[k] = warmed[k - 1] + 0.05 * (20 + 10 * heating[k] - warmed[k - 1])
    t = np.arange(warmed.size) * 0.5
    guess = guess_table(table_of(**{"t (s)": t, "Voltage (V)": heating, "Temperature (°C)": warmed}))
    assert guess.heating_only
    assert [c.name for c in guess.of_role("input")] == ["Voltage (V)"]


@pytest.mark.parametrize(("unit", "factor"), [("s", 1.0), ("min", 60.0)])
def test_a_finer_time_is_the_clock_before_stamps_of_whole_seconds(unit, factor):
    t = np.arange(U.size) * 1.5
    stamps = FoundColumn("Datum", "", np.floor(t), "clock")
    table = table_of(**{f"Zeit relativ [{unit}]": t / factor, "Temperatur [°C]": U, "Weg [mm]": X})
    guess = guess_table(replace(table, columns=(stamps, *table.columns)))
    assert [c.name for c in guess.of_role("time")] == [f"Zeit relativ [{unit}]"]
    other = table_of(**{f"Zeit relativ [{unit}]": 1.2 * t / factor, "Temperatur [°C]": U, "Weg [mm]": X})
    guess = guess_table(replace(other, columns=(stamps, *other.columns)))
    assert [c.name for c in guess.of_role("time")] == [
        "Datum"
    ]  # another clock, which may not be that of the rows
