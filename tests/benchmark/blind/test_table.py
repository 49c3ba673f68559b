"""Figures of the blind benchmark, on answers written by hand."""

import numpy as np
import pytest

from benchmark.blind.records import ambiguous, parameter, record
from benchmarks.blind.score_table import GROUPS, VARIABLES, confusable, is_correct_variable, score_table
from benchmarks.boxes.box_effects import EFFECTS


def empty(alarms, of, category="empty"):
    """Empty boxes, some of which raised an alarm."""
    return [record(k, "walking" if k < alarms else "silent", category=category) for k in range(of)]


@pytest.mark.parametrize(
    ("alarms", "of", "upper"), [(0, 60, 0.0487), (0, 100, 0.0295), (8, 300, 0.0476), (5, 5, 1.0)]
)
def test_the_bound_on_false_alarms_is_clopper_and_pearsons_one_sided(alarms, of, upper):
    from scipy.stats import binom

    found = score_table(empty(alarms, of))["false_alarms"]
    assert (found["hits"], found["of"], found["rate"]) == (alarms, of, alarms / of)
    assert found["upper95"] == pytest.approx(upper, abs=5e-5)
    if alarms < of:
        assert binom.cdf(alarms, of, found["upper95"]) == pytest.approx(0.05)


def test_rates_have_clopper_and_pearsons_bounds_of_both_sides():
    from scipy.stats import binom

    low, high = score_table(empty(8, 300))["false_alarms"]["ci95"]
    assert (low, high) == (pytest.approx(0.0116, abs=5e-5), pytest.approx(0.0519, abs=5e-5))
    assert binom.sf(7, 300, low) == pytest.approx(0.025)
    assert binom.cdf(8, 300, high) == pytest.approx(0.025)
    assert score_table(empty(0, 10))["false_alarms"]["ci95"][0] == 0.0
    assert score_table(empty(10, 10))["false_alarms"]["ci95"][1] == 1.0


def test_hard_nulls_are_empty_and_counted_by_themselves_as_well():
    found = score_table([*empty(1, 4), *empty(2, 3, "hard_null")])
    assert (found["false_alarms"]["hits"], found["false_alarms"]["of"]) == (3, 7)
    assert (found["false_alarms_hard"]["hits"], found["false_alarms_hard"]["of"]) == (2, 3)


def test_without_boxes_there_are_no_figures():
    found = score_table([])
    assert found["false_alarms"] == {"hits": 0, "of": 0, "rate": None, "ci95": None, "upper95": None}
    assert found["parameter"]["median_error"] is None
    assert found["removable_share"] is None
    assert found["seconds"] == {"mean": None, "most": None}


def test_not_identifiable_is_no_alarm_and_unknown_is_one():
    found = score_table([record(0, "not_identifiable"), record(1, "unknown"), record(2, "silent")])[
        "false_alarms"
    ]
    assert (found["hits"], found["of"]) == (1, 3)


def test_detection_is_counted_by_how_much_is_visible():
    boxes = [
        record(0, "silent", {"walking": 0.05}),
        record(1, "walking", {"walking": 0.5}),
        record(2, "silent", {"walking": 0.7}),
        record(3, "unknown", {"walking": 1.0}),
        record(4, "slip", {"walking": 30.0}),
        record(5, "walking", {"walking": 9.0}, left_out="walking"),
    ]
    found = score_table(boxes)["detection"]
    assert (found["delta>=0.5"]["hits"], found["delta>=0.5"]["of"]) == (3, 4)
    assert (found["delta>=1"]["hits"], found["delta>=1"]["of"]) == (2, 2)
    bins = {(b["from"], b["to"]): (b["hits"], b["of"]) for b in found["by_delta"]}
    assert bins[0.0, 0.1] == (0, 1)
    assert bins[0.5, 1.0] == (1, 2)
    assert bins[1.0, 2.0] == (1, 1)
    assert bins[2.0, None] == (1, 1)
    assert sum(of for _, of in bins.values()) == 5


def test_names_are_scored_where_the_effect_is_large_and_an_alarm_was_raised():
    boxes = [
        record(0, "walking", {"walking": 3.0}),
        record(1, "slip", {"walking": 3.0}),
        record(2, "creep", {"walking": 3.0}),
        ambiguous((["creep"], 0.6), (["walking"], 0.4), number=3, hidden={"walking": 3.0}),
        record(4, "unknown", {"walking": 3.0}),
        record(5, "silent", {"walking": 3.0}),
        record(6, "walking", {"walking": 0.9}),
        record(7, "walking+slip", {"walking": 3.0}),
    ]
    found = score_table(boxes)["name"]
    assert {key: (found[key]["hits"], found[key]["of"]) for key in ("strict", "group", "set_covers")} == {
        "strict": (1, 6),
        "group": (3, 6),
        "set_covers": (3, 6),
    }
    assert found["mean_set_size"] == pytest.approx((1 + 1 + 1 + 2 + 2) / 5)


def test_what_the_channels_cannot_show_counts_for_no_name_and_against_one():
    hidden = {"dead_zone": 3.0}
    boxes = [
        record(0, "dead_zone", hidden, channels=["position"]),
        record(1, "silent", hidden, channels=["position"]),
        record(2, "dead_zone", hidden, channels=["position", "voltage"]),
        record(3, "walking", {"end_conduction": 3.0}),
    ]
    found = score_table(boxes)
    assert (found["name"]["strict"]["hits"], found["name"]["strict"]["of"]) == (1, 1)
    wrong = found["named_though_unidentifiable"]
    assert (wrong["hits"], wrong["of"]) == (2, 3)
    assert found["by_effect"]["dead_zone"] == {
        "boxes": 3,
        "delta>=1": 1,
        "detected": 1,
        "named": 1,
        "in_set": 1,
    }


def test_of_an_effect_that_is_left_out_only_its_variable_or_confusable_effects_are_right():
    hidden = {"walking": 3.0}
    boxes = [
        record(0, "unknown", hidden, left_out="walking", depends_on="cycle"),
        record(1, "unknown", hidden, left_out="walking", depends_on="level"),
        ambiguous((["slip"], 0.6), (["fatigue"], 0.4), number=2, hidden=hidden, left_out="walking"),
        ambiguous((["slip"], 0.6), (["creep"], 0.4), number=3, hidden=hidden, left_out="walking"),
        record(4, "slip", hidden, left_out="walking"),
        record(5, "silent", hidden, left_out="walking"),
    ]
    found = score_table(boxes)["left_out"]
    assert (found["alarms"]["hits"], found["alarms"]["of"]) == (5, 6)
    assert (found["unknown_right"]["hits"], found["unknown_right"]["of"]) == (1, 5)
    assert (found["or_group"]["hits"], found["or_group"]["of"]) == (2, 5)


def test_parameters_are_scored_by_relative_error_and_ninety_percent_intervals():
    """The truth is 2."""
    hidden = {"walking": 3.0}

    def box(number, value, half):
        return record(number, "walking", hidden, **parameter("walking", value, value - half, value + half))

    boxes = [
        box(0, 2.2, 1.0),
        box(1, 1.0, 0.9),
        box(2, 5.0, 1.0),
        record(3, "slip", hidden, **parameter("slip", 2.0, 1.0, 3.0)),
    ]
    found = score_table(boxes)["parameter"]
    assert found["median_error"] == pytest.approx(0.5)
    assert (found["coverage90"]["hits"], found["coverage90"]["of"]) == (1, 3)


def test_the_probability_of_the_truth_is_scored_where_it_is_visible_and_where_nothing_is_hidden():
    boxes = [
        record(0, "walking", {"walking": 3.0}, explanations=[[["walking"], 0.8], [["slip"], 0.2]]),
        record(1, "slip", {"walking": 3.0}, explanations=[[["slip"], 0.6], [["walking"], 0.4]]),
        record(2, "slip", {"walking": 0.1}, explanations=[[["slip"], 1.0]]),
        record(3, "silent", nothing=0.9),
    ]
    found = score_table(boxes)["probability"]
    assert found["mean"] == found["median"] == pytest.approx(0.6)
    assert found["log_score"] == pytest.approx(np.mean(np.log([0.8, 0.4, 0.9])))


def test_a_removable_share_is_the_median_where_the_name_is_right_and_runs_were_held_out():
    def box(number, share, answer="walking"):
        held_out = {"removable_share": share} if share != "none" else None
        return record(number, answer, {"walking": 3.0}, held_out=held_out)

    boxes = [box(0, 0.9), box(1, 0.5), box(2, 0.8), box(3, None), box(4, "none"), box(5, -4.0, "creep")]
    assert score_table(boxes)["removable_share"] == 0.8
    assert score_table(boxes[3:])["removable_share"] is None


def test_two_effects_must_be_named_both_and_only_count_where_both_are_visible():
    boxes = [
        record(0, "settling+walking", {"walking": 2.0, "settling": 0.5}),
        record(1, "walking", {"walking": 2.0, "settling": 0.7}),
        record(2, "walking", {"walking": 2.0, "settling": 0.1}),
        record(3, "walking+settling", {"walking": 2.0, "settling": 0.1}),
    ]
    found = score_table(boxes)["two"]
    assert (found["both"]["hits"], found["both"]["of"]) == (1, 2)
    assert (found["both_of_all"]["hits"], found["both_of_all"]["of"]) == (2, 4)


def test_boxes_that_failed_are_listed_with_their_reasons_and_enter_no_figure():
    failed = {"number": 7, "error": "The runs hold no settled steps.", "category": "empty", "left_out": ""}
    found = score_table([record(0), failed])
    assert found["boxes"] == 2
    assert found["failed"] == [[7, "The runs hold no settled steps."]]
    assert found["false_alarms"]["of"] == 1


def test_times_and_confusions():
    boxes = [
        record(0, "silent", seconds=4.0),
        record(1, "walking", {"walking": 3.0}, seconds=8.0),
        record(2, "slip", {"walking": 3.0}, seconds=6.0),
        record(3, "slip", {"walking": 3.0}, seconds=6.0),
        record(4, "unknown", {"walking": 3.0}, left_out="walking"),
        record(5, "settling+walking", {"walking": 3.0, "settling": 1.0}),
    ]
    found = score_table(boxes)
    assert found["seconds"] == {"mean": pytest.approx(44 / 6), "most": 10.0}
    assert found["confusion"] == {
        "nothing": {"silent": 1},
        "settling + walking": {"settling + walking": 1},
        "walking": {"slip": 2, "walking": 1},
        "without walking": {"unknown": 1},
    }
    assert found["by_effect"]["walking"] == {
        "boxes": 3,
        "delta>=1": 3,
        "detected": 3,
        "named": 1,
        "in_set": 1,
    }
    assert set(found["by_effect"]) == set(EFFECTS)


def test_the_order_of_records_does_not_matter():
    boxes = [
        record(0, "walking", {"walking": 3.0}),
        record(1, "slip", {"walking": 0.3}),
        *empty(1, 3),
        record(5, "settling+walking", {"walking": 2.0, "settling": 1.0}),
    ]
    assert score_table(boxes[::-1]) == score_table(boxes)


def test_effects_are_confusable_when_they_share_a_group():
    assert confusable("creep", "creep")
    assert confusable("creep", "settling")
    assert confusable("settling", "creep")
    assert confusable("settling", "accommodation")
    assert not confusable("creep", "accommodation")  # each shares a group with settling, and they none
    assert not confusable("creep", "walking")
    assert not confusable("", "walking")
    for group in GROUPS:
        assert all(confusable(a, b) for a in group for b in group)


@pytest.mark.parametrize(
    ("effect", "right", "wrong"),
    [
        ("walking", ("time", "cycle", "reversals"), ("level", "hold", None)),
        ("settling", ("hold", "rate", "time"), ("level",)),
        ("wire_lag", ("rate", "step"), ("time", "level")),
        ("stress_coupling", ("level", "history"), ("time", "rate", None)),
    ],
)
def test_a_variable_is_right_when_the_effect_depends_on_it(effect, right, wrong):
    assert all(is_correct_variable(effect, v) for v in right)
    assert not any(is_correct_variable(effect, v) for v in wrong)


def test_groups_and_variables_name_existing_effects():
    assert set().union(*GROUPS) <= set(EFFECTS)
    assert set(VARIABLES) <= set(EFFECTS)
