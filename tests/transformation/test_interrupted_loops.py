"""Temperatures of loops that an inner loop interrupts, or that are cut in two: those of the uninterrupted loop."""

from functools import cache

import numpy as np
import pytest

from preisach.relay_reference import Relays
from smarig.core import UsageError
from smarig.transformation import run_figures
from transformation.known_loops import run_of

NAMES = ("A_s", "A_f", "M_s", "M_f")


def wire(path, seed=5):
    """A wire of 4000 relays that switch at normally distributed temperatures; readings every 0.25 K, with noise."""
    dice = np.random.default_rng(seed)
    up, down = np.sort(dice.normal([70.0, 45.0], 4.0, (4000, 2)), axis=1)[:, ::-1].T
    ends = np.asarray(path, float)
    u = np.concatenate(
        [[ends[0]], *(np.linspace(a, b, int(4 * abs(b - a)) + 1)[1:] for a, b in zip(ends, ends[1:]))]
    )
    relays = Relays(up, down, np.full(up.size, 0.001), np.zeros(up.size, bool), u[0])
    return u, relays.drive(u, 0.0) + dice.normal(0, 0.004, u.size)


def figures(path):
    return run_figures(run_of(*wire(path)))


@cache
def whole():
    """The figures of a loop that nothing interrupts."""
    return figures([20, 100, 20])


def assert_same_temperatures(found):
    for name in NAMES:
        assert found.means[name].value == pytest.approx(whole().means[name].value, abs=0.4), name


@pytest.mark.parametrize(
    ("path", "interrupted"),
    [
        ([20, 72, 52, 100, 20], {"heating": 1}),
        ([20, 100, 43, 66, 20], {"cooling": 1}),
        ([20, 68, 55, 74, 50, 62, 57, 100, 44, 60, 20], {"heating": 2, "cooling": 1}),  # a loop within a loop
    ],
)
def test_a_branch_goes_on_after_an_inner_loop(path, interrupted):
    found = figures(path)
    assert_same_temperatures(found)
    for direction, loops in interrupted.items():
        count = "an inner loop" if loops == 1 else f"{loops} inner loops"
        assert any(f"Cycle 1, {direction}: {count} interrupted" in note for note in found.notes)


def test_a_loop_that_is_whole_comes_before_one_that_is_interrupted():
    u, y = wire([20, 70, 50, 100, 20, 100, 20])
    found = run_figures(run_of(u, y))
    assert not any("interrupted" in note for note in found.notes)
    assert_same_temperatures(found)


def test_first_heating_and_last_cooling_are_a_loop():
    """From the hot end down into the loop and back, twice, before the last cooling."""
    found = figures([20, 100, 50, 100, 46, 100, 20])
    assert_same_temperatures(found)
    assert len(found.cycles) == 1


def test_inner_loops_alone_are_none():
    with pytest.raises(UsageError, match="contains no full loop"):
        figures([20, 100, 45, 70, 45, 100])
