"""Rows and windows of steps, compared with a search through all samples."""

from pathlib import Path

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from smarig.record import Run, Step
from smarig.record.schema import SAMPLE_COLUMNS

PERIOD_S = 0.1


def step(index, n=0, start_s=0.0, end_s=None):
    return Step(index, 0, False, "rise", 1.0, start_s, end_s, "settled", 1.0, n)


def run_of(numbers, t_s=None):
    """A run whose samples bear these step numbers, NaN for none."""
    columns = {name: np.full(len(numbers), np.nan) for name in SAMPLE_COLUMNS}
    columns["step"] = np.array(numbers, dtype=float)
    columns["t_s"] = PERIOD_S * np.arange(1, len(numbers) + 1) if t_s is None else np.array(t_s)
    return Run(Path("made"), {}, columns, (), ())


@st.composite
def segments(draw):
    """(step number or NaN, samples) of segments in which no number occurs twice."""
    numbers = draw(st.lists(st.integers(-1, 9) | st.none(), max_size=8, unique=True))
    return [(np.nan if k is None else k, draw(st.integers(1, 6))) for k in numbers]


@given(parts=segments(), index=st.integers(-2, 10), n=st.integers(-2, 8))
@example(parts=[], index=0, n=1)
@example(parts=[(0, 3), (np.nan, 2), (1, 4)], index=1, n=9)
def test_rows_and_window_as_a_search_finds_them(parts, index, n):
    numbers = [k for k, count in parts for _ in range(count)]
    run, every = run_of(numbers), np.arange(len(numbers))
    expected = [row for row, number in enumerate(numbers) if number == index]
    if index == -1 and expected and expected[0] > 0 and np.isnan(numbers[expected[0] - 1]):
        return  # calibration points right after samples of no step: not told apart
    assert every[run.rows(step(index))].tolist() == expected
    assert every[run.window(step(index, n))].tolist() == (expected[-n:] if n > 0 else [])


@given(counts=st.lists(st.integers(1, 6), min_size=1, max_size=6))
def test_by_the_clock_they_are_the_same_where_steps_begin_a_tick_before_their_first_sample(counts):
    run = run_of(np.repeat(np.arange(len(counts)), counts))
    ends = PERIOD_S * np.cumsum(counts)
    steps = [step(k, 1, end - PERIOD_S * count, end) for k, (count, end) in enumerate(zip(counts, ends))]
    assert run.rows_by_clock(steps) == [run.rows(s) for s in steps]


@given(
    t_s=st.lists(st.integers(0, 50), unique=True, max_size=20).map(sorted),
    start=st.integers(0, 50),
    length=st.integers(0, 20) | st.none(),
)
def test_by_the_clock_they_lie_after_the_start_and_up_to_the_end(t_s, start, length):
    end = None if length is None else float(start + length)
    s = step(0, 1, float(start), end)
    run = run_of([np.nan] * len(t_s), [float(t) for t in t_s])
    (rows,) = run.rows_by_clock([s])
    assert np.array(t_s)[rows].tolist() == [t for t in t_s if start < t <= s.end_s]


def test_a_number_that_stands_in_two_segments_is_the_last():
    run = run_of([0, 0, 1, 0])
    assert run.step_rows == {0: slice(3, 4), 1: slice(2, 3)}


def test_a_step_without_an_end_ends_where_it_starts():
    assert (step(0, 1, 3.0).end_s, step(0, 1, 3.0).duration_s) == (3.0, 0.0)
    assert (step(0, 1, -1.0, 0.0).end_s, step(0, 1, -1.0, 0.0).duration_s) == (0.0, 1.0)
