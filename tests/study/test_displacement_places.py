"""Of several displacements, that of the specimen is the output: not that of a frame, nor one that hardly moves."""

import numpy as np
import pytest

from smarig.study import guess_table
from study.known_data import displacements, table_of, temperatures

U = temperatures(2, 140)
MOVES = displacements(U, seed=2)
SMALL = 0.2 + 0.004 * (U - U.min()) / np.ptp(U) * np.ptp(MOVES)


def guess(**columns):
    return guess_table(table_of(**{"t [s]": 2.0 * np.arange(U.size), "T wire [°C]": U, **columns}))


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("names", [("LVDT 3 [mm]", "LVDT 7 [mm]"), ("pos a [µm]", "pos b [mm]")])
def test_what_moves_far_more_is_the_specimen(order, names):
    little = SMALL * (1000 if "µm" in names[0] else 1)
    both = {names[0]: little, names[1]: MOVES}
    found = guess(**{names[k]: both[names[k]] for k in order})
    assert found.first("output").name == names[1]
    assert not found.doubts


@pytest.mark.parametrize(
    "word", ["Rahmen", "load frame", "bâti", "Gestell", "sample holder", "upper grip", "clamp"]
)
def test_what_holds_the_specimen_is_not_the_output(word):
    held = MOVES.mean() + 0.4 * np.sin(U / 9) * np.ptp(MOVES)
    found = guess(**{f"displacement {word} [mm]": held, "displacement 2 [mm]": MOVES})
    assert found.first("output").name == "displacement 2 [mm]"
    assert not found.doubts


def test_two_displacements_that_move_alike_far_are_a_question():
    other = MOVES.mean() + 0.2 * np.cos(np.arange(U.size) / 9) * np.ptp(MOVES)
    found = guess(**{"LVDT 1 [mm]": MOVES, "LVDT 2 [mm]": other})
    assert found.doubts == ["output"]
    assert "'LVDT 1 [mm]', 'LVDT 2 [mm]'" in found.roles["LVDT 1 [mm]"].reason


def test_two_displacements_that_show_one_motion_are_none():
    found = guess(**{"LVDT 1 [mm]": MOVES, "LVDT 2 [mm]": 0.9 * MOVES + 0.3})
    assert found.first("output").name == "LVDT 1 [mm]"
    assert not found.doubts


def test_a_thermometer_at_a_grip_is_at_another_place():
    found = guess_table(table_of(**{"T upper grip [°C]": 30 + U / 4, "T 2 [°C]": U, "x [mm]": MOVES}))
    assert found.first("input").name == "T 2 [°C]"
