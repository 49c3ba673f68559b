"""Every row that an identification leaves out is counted with its reason, and drop-outs never enter a fit."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from identification.made_runs import PARTITION, driven_run, fod_inputs
from smarig.identification import identify, verify

T = triangles((90.0, 70.0, 90.0), rows=50)
STRAIN = RelayWire(1).strain(T)


def spoiled(run, **cells):
    """A run with other values in some rows of its columns: name=(rows, value)."""
    columns = {name: x.copy() for name, x in run.columns.items()}
    for name, (rows, value) in cells.items():
        columns[name][rows] = value
    return replace(run, columns=columns)


def test_missing_values_and_dropouts_are_counted_apart():
    run = spoiled(as_run("a", T, STRAIN), position=([3, 4], np.nan), input=([60, 61, 100], 0.0))
    (rows,) = identify(run, "positive").rows
    assert rows.left_out == {"missing values": 2, "drop-outs": 3}
    assert (rows.given, rows.used) == (len(T), len(T) - 5)
    assert "2 missing values, 3 drop-outs" in rows.text


@pytest.mark.long("takes five seconds")
def test_rows_before_the_first_reversal_have_an_unknown_memory_if_the_run_starts_half_way():
    half_way = as_run("late", T[25:], STRAIN[25:])
    whole, late = identify([as_run("whole", T, STRAIN), half_way], "positive").rows
    assert whole.left_out == {}
    assert late.left_out["unknown memory"] == 24
    assert late.used == late.given - 24


def test_a_surface_says_how_many_points_are_not_on_its_curves():
    inputs = fod_inputs(PARTITION["one"])
    run = driven_run("one_e", [*inputs, 40.0, 20.0, 30.0])
    (rows,) = identify(run, "exponential").rows
    assert rows.noun == "settled points"
    assert rows.given == len(inputs) + 3
    assert rows.used + rows.left_out["not on first-order curves"] == rows.given


def test_a_selection_is_a_reason():
    run = driven_run("one_e", fod_inputs(PARTITION["one"]))
    (rows,) = identify(run, "exponential", select="curve%2==0").rows
    assert set(rows.left_out) == {"not selected"}
    assert rows.to_json()["used"] == rows.given - rows.left_out["not selected"]


def test_the_error_of_a_falling_output_is_that_of_its_fit():
    run = as_run("a", T, STRAIN)
    found = identify(run, "positive")
    assert found.model.fit["rms"] == pytest.approx(verify(found.model, run).runs[0].settled.rms, rel=0.1)


def test_dropouts_change_neither_a_model_nor_its_verification():
    clean = as_run("a", T, STRAIN)
    lost = [60, 61, 100]
    model = identify(clean, "positive").model
    other = identify(spoiled(clean, input=(lost, 0.0)), "positive").model
    assert other.hysteresis.lower > 20.0, "0 °C is no input of this wire"
    found = verify(model, spoiled(clean, input=(lost, 0.0))).runs[0].settled
    assert found.n == len(T) - 3
    assert found.rms < 1.2 * verify(model, clean).runs[0].settled.rms
