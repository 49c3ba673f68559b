"""References as functions of time, and the error messages of invalid reference files."""

import numpy as np
import pytest

from smarig.control.tracking.reference import Reference, reference, reference_from_csv
from smarig.core.errors import UsageError


def test_ramps_are_straight_and_steps_are_held():
    ramp = Reference("r", (0.0, 10.0, 20.0), (1.0, 3.0, 2.0))
    held = Reference("s", (0.0, 10.0, 20.0), (1.0, 3.0, 2.0), held=True)
    assert [ramp.at(t) for t in (-1.0, 0.0, 5.0, 10.0, 15.0, 20.0, 99.0)] == [
        1.0,
        1.0,
        2.0,
        3.0,
        2.5,
        2.0,
        2.0,
    ]
    assert [held.at(t) for t in (-1.0, 0.0, 9.9, 10.0, 19.9, 20.0, 99.0)] == [
        1.0,
        1.0,
        1.0,
        3.0,
        3.0,
        3.0,
        3.0,
    ]


@pytest.mark.parametrize("shape", ["steps", "ramps", "multisine"])
def test_a_shape_stays_in_its_bounds_and_follows_from_its_seed(shape):
    one, again, other = (reference(shape, 2.0, 8.0, seconds=100.0, seed=s) for s in (1, 1, 2))
    assert one == again != other
    at = np.array([one.at(t) for t in np.linspace(0, 100, 500)])
    assert 2.0 <= at.min() < at.max() <= 8.0
    assert Reference.of(one.as_data()) == one


def test_a_file(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time_s,position_mm\n0,1\n5,2.5\n", encoding="utf-8")
    assert reference_from_csv(path, "mm").at(2.5) == 1.75


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time_s,position_deg\n0,1\n1,2\n", "no column 'position_mm'"),
        ("time_s,position_mm\n0,1\n", "at least two times"),
        ("time_s,position_mm\n0,1\n0,2\n", "increase"),
        ("time_s,position_mm\n1,1\n2,2\n", "start at 0"),
        ("time_s,position_mm\n0,x\n1,2\n", "not a reference"),
        ("time_s,position_mm\n0,1\n1\n", "not a reference"),
        ("time_s,position_mm\n0,nan\n1,2\n", "finite"),
        ("time_s,position_mm\n0,1\n1e9,2\n", "more than"),
        ("", "is empty"),
        ("\x00\xff", "no column"),
    ],
)
def test_a_file_that_is_none_gets_a_sentence(tmp_path, text, said):
    path = tmp_path / "r.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=said):
        reference_from_csv(path, "mm")


def test_shapes_that_are_none():
    with pytest.raises(UsageError, match="did you mean ramps"):
        reference("ramp", 2.0, 8.0)
    with pytest.raises(UsageError, match="low < high"):
        reference("ramps", 8.0, 2.0)
    with pytest.raises(UsageError, match="more than 400000 points"):
        reference("multisine", 2.0, 8.0, seconds=80_000.0, speed=2.0)


def test_a_file_too_large_is_not_read(tmp_path):
    path = tmp_path / "r.csv"
    with path.open("w") as file:
        file.truncate(20_000_001)
    with pytest.raises(UsageError, match="larger than 20 MB"):
        reference_from_csv(path, "mm")


NOT_NUMBERS = [
    ((0.0, 1.0), (1.0,)),
    ((0.0, 1.0), ("1", "2")),
    (("0", "1"), (1.0, 2.0)),
    ((0.0, 1.0), (1.0, None)),
    (None, (1.0, 2.0)),
]


@pytest.mark.parametrize(("t_s", "position"), NOT_NUMBERS)
def test_a_reference_has_as_many_numbers_as_times(t_s, position):
    with pytest.raises(UsageError, match="needs the same number of times and positions, all of them numbers"):
        Reference("r", t_s, position)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None])
def test_a_seed_is_a_whole_number(seed):
    with pytest.raises(UsageError, match="seed must be an integer ≥ 0"):
        reference("steps", 2.0, 8.0, seed=seed)


@pytest.mark.parametrize("key", ["low", "high", "seconds", "every_s", "speed"])
@pytest.mark.parametrize("value", [np.nan, "3", None])
def test_a_shape_takes_numbers(key, value):
    with pytest.raises(UsageError, match=f"The reference's {key} must be a finite number"):
        reference(**({"shape": "steps", "low": 2.0, "high": 8.0} | {key: value}))


def test_bounds_too_far_apart_are_refused():
    with pytest.raises(UsageError, match="differ too much"):
        reference("steps", -1e308, 1e308)
