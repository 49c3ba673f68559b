"""A load held at several levels in turn is a condition, whatever the output could follow besides the temperature."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.study import StudyOptions, study
from smarig.study.held_quantities import held_levels
from smarig.study.table_guess import guess_table
from smarig.study.understanding import understand
from study.known_data import displacements, table_of, temperatures

CYCLE = temperatures(1, 150)
NAMES = {"Oe": "Magnetic Field (Oe)", "MPa": "Stress [MPa]", "N": "Kraft [N]"}


def record(levels, senses, output="Moment (emu)", unit="Oe", status=()):
    """A cycle of temperature at each level, in which the output rises (1) or falls (-1) on heating."""
    noise = np.random.default_rng(7).normal(0, 0.3, CYCLE.size)
    y = [5 + sense * displacements(CYCLE, seed=k, noise=0.005) for k, sense in enumerate(senses)]
    level = np.repeat(levels, CYCLE.size) + np.tile(noise, len(levels))
    u = np.tile(CYCLE, len(levels)) + 273.15
    return {
        "Time (s)": np.arange(u.size) * 2.0,
        "Temperature (K)": u,
        NAMES[unit]: level,
        output: np.concatenate(y),
    } | dict.fromkeys(status, np.ones(u.size))


def written(tmp_path, columns):
    path = tmp_path / "sweeps.csv"
    rows = (",".join(f"{x:.5f}" for x in row) for row in zip(*columns.values()))
    path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    return path


@pytest.mark.parametrize(
    ("unit", "levels"), [("Oe", (500.0, 20_000.0)), ("Oe", (0.0, 5e3, 1e4)), ("MPa", (50.0, 150.0))]
)
def test_a_load_held_in_turn_is_no_input(unit, levels):
    output = "Moment (emu)" if unit == "Oe" else "Strain [%]"
    guess = guess_table(table_of(**record(levels, [1] * len(levels), output, unit)))
    assert guess.first("input").name == "Temperature (K)"
    assert guess.first("output").name == output


def test_a_field_that_steps_while_the_temperature_rests_stays_the_input():
    h = np.repeat(3000 * np.sin(np.linspace(0, 4 * np.pi, 60)), 8)
    u = 300 + 6 * np.random.default_rng(1).random(h.size)
    guess = guess_table(
        table_of(**{"Temperature (K)": u, "Magnetic Field (Oe)": h, "Moment (emu)": np.tanh(h / 900)})
    )
    assert guess.first("input").name == "Magnetic Field (Oe)"
    field, warm = (
        next(c for c in guess.columns if c.quantity == q) for q in ("magnetic field", "temperature")
    )
    assert held_levels(field, warm) == []


def test_the_status_of_a_field_is_no_field_that_was_held(tmp_path):
    """Constant as it is, it does not make one record of several fields."""
    path = written(tmp_path, record((500.0, 20_000.0), (1, 1), status=["Field Status (code)", "Feldstatus"]))
    guesses = understand([path], StudyOptions()).guesses
    assert [g.table.name for g in guesses] == ["500 Oe part 1", "20000 Oe part 2"]
    assert guesses[0].roles["Field Status (code)"].role == "ignored"


def test_opposite_senses_at_two_fields_are_said(tmp_path):
    path = written(tmp_path, record((500.0, 20_000.0), (1, -1)))
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert [len(t.run) for t in result.tables] == [CYCLE.size] * 2
    said = (
        "The output rises with the input in 01_sweeps_500_Oe_part_1 and falls in 02_sweeps_20000_Oe_part_2: "
    )
    assert any(r.startswith(said) for r in result.reasons)
    assert any("magnetic field differs: 20000 Oe in the held-out data" in r for r in result.reasons)


def test_an_output_that_turns_its_sense_for_an_unknown_reason_does_move_with_the_input(tmp_path):
    columns = record((500.0, 20_000.0), (1, -1))
    del columns["Magnetic Field (Oe)"]
    with pytest.raises(DataError, match="rises with the input on some branches of .* and falls on others"):
        study([written(tmp_path, columns)], tmp_path / "out", StudyOptions(diagnose=False))
