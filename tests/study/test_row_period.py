"""The rows have the period that a file states where no column is a clock, and a column of row numbers is no output."""

import numpy as np
import pytest

from smarig.exchange import find_tables, import_file
from smarig.record import load_run
from smarig.study import guess_table, mapping_draft
from study.known_data import displacements, temperatures

V = temperatures() / 10
X = displacements(10 * V)


@pytest.mark.parametrize(
    ("head", "period"),
    [
        (
            [
                "# SAMPLE_TIME = 0.02",
                "# NAME1 = Control Voltage of Chan 3",
                "# NAME2 = Position of axis 1",
                "# END",
            ],
            0.02,
        ),
        (["Sampling interval [ms]: 5", "Voltage [V] Position [um]"], 0.005),
        (["Voltage [V] Position [um]"], None),
    ],
)
def test_the_period_is_that_of_the_file(tmp_path, head, period):
    path = tmp_path / "a.dat"
    path.write_text("\n".join([*head, *(f"{v:.4f} {x:.5f}" for v, x in zip(V, X))]) + "\n")
    (table,) = find_tables(path)
    guess = guess_table(table)
    assert [c.quantity for c in (*guess.of_role("input"), *guess.of_role("output"))] == [
        "voltage",
        "displacement",
    ]
    assert not guess.doubts
    run = imported(path, guess)
    assert run.has("t_s") == (period is not None)
    if period is not None:
        np.testing.assert_allclose(run["t_s"], np.arange(V.size) * period)


def test_the_columns_of_an_oscilloscope(tmp_path):
    path = tmp_path / "a.csv"
    lines = [f"{k},{v:.3f},{x:.4f},," for k, (v, x) in enumerate(zip(V, X))]
    path.write_text(
        "\n".join(["X,CH1,CH2,Start,Increment,", "Sequence,Volt,Volt,-1.0e+00,2.0e-03,", *lines]) + "\n"
    )
    (table,) = find_tables(path)
    guess = guess_table(table)
    assert {guess.first(role).name for role in ("input", "output")} == {"CH1", "CH2"}
    np.testing.assert_allclose(imported(path, guess)["t_s"], np.arange(V.size) * 0.002)


def imported(path, guess):
    """The run that the draft imports."""
    mapping = path.with_suffix(".toml")
    mapping.write_text(mapping_draft(guess, "m"), encoding="utf-8")
    out = path.with_suffix(".run.sqlite")
    return load_run(import_file(path, format="csv", out=out, mapping=str(mapping)).run)
