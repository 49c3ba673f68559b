"""The comparison on short sealed boxes: an effect is named, nothing stays silent, what is left out is no name."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from benchmarks.boxes import write_box
from smarig.diagnosis import CommandedComparison, compare_commanded
from smarig.diagnosis.comparison.commanded.discrepancy_kernels import _Geometry
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.identification import identify
from smarig.plant import LearnedShape, learned_effect_type
from smarig.record import load_run
from smarig.replay import predict
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


def test_values_of_a_named_effect_are_those_of_the_extended_model() -> None:
    found = compared("walking")
    (effect,) = found.effects
    assert effect.probability > 0.9
    low, high = effect.intervals95["percent_per_cycle"]
    assert low < effect.effect.values["percent_per_cycle"] < high
    assert [e["name"] for e in found.model.effects] == ["walking"]
    assert found.error.extended < 0.6 * found.error.base
    assert "wire_lag" in found.not_identifiable  # nothing in settled positions
    assert compared("").model is compared("").original


def test_unknown_cause_is_a_law_of_its_variable_in_the_model() -> None:
    found = compared("walking", ("walking",))
    assert found.learned is not None
    assert found.learned.kind.shape.variable == found.verdict.depends_on
    assert [e["name"] for e in found.model.effects] == ["learned"]
    assert found.effects == ()
    assert found.error.extended < 0.6 * found.error.base


@pytest.mark.parametrize(("place", "enters"), [("input", "input"), ("heat", "heat_loss")])
def test_kernel_is_what_a_small_law_changes(place: str, enters: str) -> None:
    subject = compared("").subject
    fitted = subject.base
    own = _Geometry.of(subject, fitted, subject.readings(fitted)[0])
    share = own.at_s / own.t_s.max()
    kernel = getattr(own, place)(np.outer(share, share))
    shape = LearnedShape("time", enters, (0.0, float(own.t_s.max())), "")
    kind, h = learned_effect_type(shape, 1.0), fitted.plant_model.hysteresis
    small = 0.1 if place == "input" else 0.1 / (h.upper - h.lower)  # K, at full heating
    with_law = predict(subject.timeline, fitted.plant_model, [kind(small)])
    change = (with_law.output - fitted.prediction.output) / fitted.plant_model.stroke / 0.1
    assert np.linalg.norm(kernel - np.outer(change, change)) < 0.1 * np.linalg.norm(kernel)
