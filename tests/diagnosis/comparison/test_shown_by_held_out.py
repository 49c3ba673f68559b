"""What only held-out runs show goes with a variable of all runs; what they refute says nothing of it."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from benchmarks.boxes import write_box
from smarig.diagnosis.comparison.commanded.commanded_evidence import likeliest_variable
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.compared_runs import subject_of
from smarig.diagnosis.comparison.commanded.effect_trials import fitted_with
from smarig.diagnosis.comparison.commanded.extension import extension_of, gain_with, held_out_shares
from smarig.diagnosis.comparison.commanded.shown_by_held_out import variable_of_all_runs
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.verdict_rules import VerdictEvidence
from smarig.diagnosis.comparison.weights import weigh
from smarig.identification import identify
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.record import load_run
from tests.diagnosis.short_boxes import short_box

SETTLING, CONVECTION = Part("effect", "settling"), Part("effect", "convection")
TIME, LEVEL = Part("variable", "time"), Part("variable", "level")


@pytest.mark.long("takes three seconds", cases=("hidden1-None",))
@pytest.mark.parametrize(
    ("hidden", "variable"), [({"fan_turned_on": {"share": 0.05, "at_h": 0.559}}, "time"), ({}, None)]
)
def test_a_fan_turned_on_between_the_runs_is_a_dependence_on_time(hidden, variable):
    with TemporaryDirectory() as folder:
        runs = [
            load_run(path)
            for path in write_box(short_box(3, hidden, runs=("congruency", "fod")), Path(folder)).train
        ]
        first, second = sorted(runs, key=lambda run: float(run["t_s"][0]))
        subject = subject_of(identify([first], "positive").model, [first], [second])
        assert variable_of_all_runs(subject, [first, second]) == variable


def test_an_effect_that_held_out_runs_refute_says_nothing_of_the_variable():
    causes = {SETTLING: 0.8, LEVEL: 0.2}
    some = dict.fromkeys(causes, 0.1)
    evidence = VerdictEvidence(causes, 0.0, some, 1.0, 0.1, 0.01, 20, acts_through={SETTLING: (TIME,)})
    assert likeliest_variable(evidence) == "time"
    assert likeliest_variable(replace(evidence, held_out={SETTLING: 1.2})) == "level"


def test_a_variable_that_is_itself_likely_is_it_whatever_effects_act_through():
    level, gain = Part("variable", "level"), Part("effect", "amplifier_gain")
    causes = {TIME: 0.97, gain: 0.99}
    sizes = dict.fromkeys(causes, 0.1)
    evidence = VerdictEvidence(causes, 0.0, sizes, 1.0, 0.1, 0.01, 20, acts_through={gain: (level,)})
    assert likeliest_variable(evidence) == "time"
    assert likeliest_variable(replace(evidence, causes={TIME: 0.4, gain: 0.99})) == "level"


@pytest.mark.long("takes three seconds")
def test_what_one_effect_of_a_pair_removes_of_held_out_errors_says_nothing_of_the_other():
    with TemporaryDirectory() as folder:
        box = short_box(3, {"walking": {"percent_per_cycle": 0.6}}, runs=("congruency", "fod"))
        runs = sorted(map(load_run, write_box(box, Path(folder)).train), key=lambda run: float(run["t_s"][0]))
        first, second = runs
        subject = subject_of(identify([first], "positive").model, [first], [second])
        walking, slip = effects_from_pairs(["walking=0.6", "slip=0.05"])
        alone = fitted_with(subject, subject.base, [walking])
        assert alone is not None
        pair = fitted_with(subject, alone[1], [walking, slip])
        assert pair is not None
        found = SearchedHypotheses(
            (pair[0],), {h.parts: fitted for h, fitted in (alone, pair)} | {(): subject.base}, ()
        )
        extension = extension_of(subject, found, weigh(found.hypotheses))
        gain = gain_with(subject, extension, [first], [second])
        shares = held_out_shares(subject, found, extension, gain, [first], [second])
    assert shares[Part("effect", "walking")] < 0.3
    assert shares[Part("effect", "slip")] > 0.8
