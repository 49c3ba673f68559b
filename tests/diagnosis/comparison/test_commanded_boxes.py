"""The comparison on short sealed boxes: an effect is named, nothing stays silent, what is left out is no name."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from benchmarks.boxes import write_box
from smarig.diagnosis.comparison.commanded.commanded_comparison import CommandedComparison, compare_commanded
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.identification import identify
from smarig.record import load_run
from tests.diagnosis.short_boxes import short_box

NUMBER = 3
WALKING = {"walking": {"percent_per_cycle": 0.6}}


@cache
def compared(name: str, without: tuple[str, ...] = ()) -> CommandedComparison:
    with TemporaryDirectory() as folder:
        box = short_box(NUMBER, WALKING if name else {})
        train = [load_run(path) for path in write_box(box, Path(folder)).train]
        return compare_commanded(identify(train, "positive").model, train, without=without)


def test_hidden_effect_is_the_first_cause() -> None:
    found = compared("walking")
    assert next(iter(found.causes)) == Part("effect", "walking")
    assert found.causes[Part("effect", "walking")] > 0.9
    assert found.verdict.word == "named"
    assert found.verdict.names[0] == "walking"


def test_strength_is_right_and_inside_its_interval() -> None:
    found = compared("walking")
    assert found.parameters["walking.percent_per_cycle"] == pytest.approx(0.6, rel=0.15)
    low, high = found.intervals95["walking.percent_per_cycle"]
    assert low < found.parameters["walking.percent_per_cycle"] < high


def test_wire_with_nothing_hidden_is_silent() -> None:
    found = compared("")
    assert found.verdict.word == "silent"
    assert found.verdict.names == ()
    assert found.extended is found.base


def test_effect_out_of_the_catalogue_leaves_a_variable_or_a_relative() -> None:
    found = compared("walking", ("walking",))
    assert found.weights.nothing < 0.1
    assert found.verdict.word in ("unknown", "ambiguous", "named")
    assert "walking" not in found.verdict.names
    likely = next(iter(found.causes)).name
    assert likely in {"cycle", "time", "reversals", "fatigue", "slip", "creep", "ambient_drift"}


def test_extended_model_predicts_what_it_was_fitted_to_better() -> None:
    found = compared("walking")
    nothing = next(h for h in found.found.hypotheses if not h.parts)
    best = found.weights.best_with(Part("effect", "walking"))
    assert best.best.squares.sum() < 0.5 * nothing.best.squares.sum()
