"""One or two repeats determine no noise: two equal readings would make every model poor, two unlike ones any good."""

import numpy as np
import pytest

from diagnosis.measured.independent_wire import as_run
from smarig.identification import identify, noise_floor, verify


def visited_twice(apart):
    """A run whose inner loop is passed twice in steps of another size: its turn at 20 is the state that repeats."""
    way = (
        (0.0, 90.0, 12),
        (90.0, 0.0, 13),
        (0.0, 41.0, 9),
        (41.0, 20.0, 7),
        (20.0, 40.0, 11),
        (40.0, 20.0, 9),
    )
    way += ((20.0, 91.0, 17), (91.0, -1.0, 15))
    u = np.concatenate([np.linspace(a, b, rows, endpoint=False) for a, b, rows in way])
    y = np.tanh((u - 45.0) / 15.0)
    y[np.flatnonzero(u == 20.0)[1:]] += apart
    return as_run("few", u, y, noise=(0.0, 0.0))


def test_they_are_counted_and_determine_nothing():
    run = visited_twice(0.05)
    floor = noise_floor(run)
    assert 0 < floor.n_pairs < 3
    assert floor.known is None


@pytest.mark.parametrize("apart", [0.0, 0.05])
def test_a_verdict_does_not_depend_on_them(apart):
    run = visited_twice(apart)
    found = verify(identify(run, "positive").model, run).runs[0]
    assert found.noise_floor is None
    assert "the noise is unknown" in found.verdict.text
