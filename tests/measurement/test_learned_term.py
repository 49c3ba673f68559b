"""Learned terms: each form changes a record as its equation says, outside its knots too, and survives its file."""

import numpy as np
import pytest

from smarig.core import DataError
from smarig.measurement import (
    InputRecord,
    LearnedTerm,
    MeasurementPart,
    learned_input,
    learned_output,
    shared_variables,
    variable_of,
)

U = np.array([0.0, 4.0, 8.0, 10.0, 8.0, 4.0, 0.0])
T = np.array([0.0, 2.0, 4.0, 5.0, 15.0, 35.0, 55.0])  # 2 per second up, 0.2 per second down


def record(u=U, t=T, *, clock=True, conditions=None):
    n = np.arange(u.size)
    return InputRecord("a", u, u, t, clock, n / (u.size - 1) + 3.0, conditions or {}, n, input_unit="degC")


def term(variable="time", form="output", knots=(0.0, 50.0), values=(0.0, 5.0), centre=0.0):
    return LearnedTerm(variable, form, knots, values, centre)


def test_variables_are_those_of_the_branch_and_start_with_the_run():
    found = record(conditions={"stress": 70.0})
    assert np.allclose(variable_of(found, "rate"), np.log10([2, 2, 2, 2, 0.2, 0.2, 0.2]))
    assert variable_of(found, "cycle")[0] == 0
    assert variable_of(found, "history")[-1] == 10.0
    assert variable_of(found, "time_since_reversal").tolist() == [0, 2, 4, 5, 10, 30, 50]
    assert variable_of(found, "stress").tolist() == [70.0] * U.size
    assert "rate" not in shared_variables([found, record(clock=False)])


@pytest.mark.parametrize("variable", ["rate", "stress"])
def test_a_run_without_the_variable_is_refused(variable):
    with pytest.raises(DataError, match="does not state"):
        learned_input(record(clock=False), U, [term(variable, "input")])


def test_terms_at_the_output_are_clamped_beyond_their_knots():
    added = learned_output(record(), U, [term(values=(1.0, 6.0))])
    assert np.allclose(added, [1.0, 1.2, 1.4, 1.5, 2.5, 4.5, 6.0])
    scaled = learned_output(record(), U, [term(form="output_gain", centre=4.0)])
    assert np.allclose(scaled, np.minimum(T, 50.0) / 10 * (U - 4.0))
    assert np.allclose(learned_output(record(), U, [term("level", knots=(4.0, 8.0))])[:4], [0, 0, 5, 5])


def test_terms_at_the_input_shift_or_scale_it():
    assert np.allclose(learned_input(record(), U, [term(form="input")]), U + np.minimum(T, 50.0) / 10)
    scaled = learned_input(record(), U, [term("rate", "input_gain", (-1.0, 1.0), (0.5, 0.5), 2.0)])
    assert np.allclose(scaled, U + 0.5 * (U - 2.0))
    assert not learned_output(record(), U, [term(form="input")]).any()


def test_a_play_follows_behind_and_a_negative_one_leads():
    behind = learned_input(record(), U, [term("rate", "play", (-1.0, 1.0), (1.0, 1.0))])
    assert np.allclose(behind, [-1, 3, 7, 9, 9, 5, 1]), "9 is kept until the input is 2 below its peak"
    ahead = learned_input(record(), U, [term("rate", "play", (-1.0, 1.0), (-1.0, -1.0))])
    assert np.allclose(ahead, [1, 5, 9, 11, 7, 3, -1])


def test_the_functions_of_a_term_are_those_of_its_values():
    empty = term(knots=(0.0, 10.0, 50.0), values=(0.0, 0.0, 0.0))
    free = np.array([2.0, -3.0])
    assert np.allclose(empty.functions(T) @ free, empty.with_values(free).at(T))


def test_a_term_survives_its_file_and_a_damaged_one_is_refused():
    part = MeasurementPart((), learned=(term("rate", "play", (-1.0, 0.0, 1.0), (0.0, 1.0, 3.0)),))
    stored = part.to_json()
    assert stored["learned"][0]["name"] == "learned"
    assert MeasurementPart.from_json(stored).learned == part.learned
    for change in (
        {"form": "nonsense"},
        {"knots": [0.0, 0.0, 1.0]},
        {"values": [1.0]},
        {"values": [0.0, float("nan"), 1.0]},
        {"values": [0.0, 1e308, 1.0]},
        {"centre": "0"},
        {"variable": "level"},
    ):
        with pytest.raises(DataError, match="damaged"):
            MeasurementPart.from_json(stored | {"learned": [stored["learned"][0] | change]})
