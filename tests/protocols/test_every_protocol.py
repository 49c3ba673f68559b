"""The contract of every protocol: no side effects, within limits, documented, ends cold, can be previewed."""

import os

import pytest

from smarig.config import load_rig
from smarig.core.catalogue import catalogue_names, catalogue_summary
from smarig.core.command import Hold, Waveform
from smarig.core.errors import UsageError
from smarig.protocols._settings import build_protocol, parse_pairs, setting_texts
from smarig.protocols._setup import Setup
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.preview import preview
from smarig.runner.runner import Runner

LONG = bool(os.environ.get("SMARIG_LONG"))
RIGS = ("one_wire_twin", "two_wire_twin")
if LONG:  # another plant behind the same commands
    RIGS += ("one_wire_thermomechanical", "two_wire_thermomechanical")
ALL = catalogue_names("smarig.protocols")
# Without noise, whole runs on one wire; short runs elsewhere; whole ones where there is time (SMARIG_LONG).
SHORT = {
    "adaptive_fod": {"longest_h": "0.5"},
    "congruency": {"points_per_branch": "2"},
    "constant_force_cycles": {"cycles": "1", "points": "10"},
    "first_order_ascending": {"partition_K": "20,60,120"},
    "first_order_descending": {"partition_K": "20,60,120"},
    "isothermal_loading": {"lead_s": "30", "duration_s": "200", "points": "20"},
    "second_order_transition": {"partition_K": "20,60,120"},
    "step_currents": {"profile": "sine", "points": "6"},
    "validation": {"points": "6"},
    "wiping_out": {"points_per_branch": "2"},
}


def settings_of(name, whole=False):
    """Those of a short run, or the default ones."""
    return {} if LONG or whole else SHORT.get(name, {})


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "adaptive_fod-one_wire_twin",
        "constant_force_cycles-one_wire_twin",
        "second_order_transition-one_wire_twin",
    ),
)
@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("name", ALL)
def test_it_can_be_costed_and_stays_within_the_limits(rig, name):
    cost = preview(name, load_rig(rig), settings_of(name, whole=rig == "one_wire_twin"))
    assert 0 < cost.duration_s < 6 * 3600
    assert cost.steps > 0
    assert 0 < cost.peak_current_A <= 1.001 or (name, rig) == ("initialise", "one_wire_twin")
    assert cost.timed_out == 0
    assert name in cost.sentence()


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("name", ALL)
def test_it_runs_on_the_noisy_twin_settles_and_ends_at_zero(rig, name):
    twin = Twin.named(rig, seed=1)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 1.0, [CallbackListener(on_step=results.append)]
    )
    runner.run(build_protocol(name, Setup.of(rig), settings_of(name)))
    assert twin.output_A == 0.0
    assert not [r for r in results if r.verdict == "timed_out"]


@pytest.mark.parametrize("name", ALL)
def test_it_is_inert_documented_and_refuses_unknown_settings(name):
    build_protocol(name, Setup.of("one_wire_twin"))  # nothing happens: no rig is there
    assert catalogue_summary("smarig.protocols", name).endswith(".")
    assert all(key.replace(".", "").isidentifier() for key, _ in setting_texts(name))
    with pytest.raises(UsageError, match=f"'{name}' has no setting 'nonsense'"):
        build_protocol(name, Setup.of("one_wire_twin"), {"nonsense": "1"})


def targets(name, rig="one_wire_twin", **settings):
    """The inputs of a protocol in order; nothing is run, since no results are needed."""
    return [c.target for c in build_protocol(name, Setup.of(rig), settings) if isinstance(c, Hold)]


def test_golden_first_order_descending():
    asked = targets("first_order_descending", partition_K=(0, 50, 100, 174.1))
    assert asked == [0, 0, 50, 0, 100, 50, 0, 174.1, 100, 50, 0]


@pytest.mark.parametrize(("rig", "curves"), [("one_wire_twin", 10), ("two_wire_twin", 11)])
def test_number_of_curves_and_points_follow_from_the_partition(rig, curves):
    labels = [
        c.branch for c in build_protocol("first_order_descending", Setup.of(rig)) if isinstance(c, Hold)
    ]
    assert len({b for b in labels if b.startswith("fod")}) == curves
    points = sum(b.startswith(("fod", "rise")) for b in labels)
    assert points == curves * (curves + 3) // 2


def test_golden_first_order_ascending_is_the_mirror():
    asked = targets("first_order_ascending", partition_K=(0, 50, 100, 174.1))
    assert asked == [0, 174.1, 100, 174.1, 50, 100, 174.1, 0, 50, 100, 174.1]


def test_wiping_out_segments_are_identical():
    steps = [c for c in build_protocol("wiping_out", Setup.of("one_wire_twin")) if isinstance(c, Hold)]
    a, b = ([c.target for c in steps if c.branch.startswith(s) and "peak" not in c.branch] for s in "AB")
    assert a == b
    assert len(a) == 20


def test_congruency_loops_visit_the_same_inputs():
    steps = [c for c in build_protocol("congruency", Setup.of("two_wire_twin")) if isinstance(c, Hold)]
    by = {
        label: [c.target for c in steps if c.branch == label]
        for label in ("A down", "A up", "B down", "B up")
    }
    assert by["A down"] == by["B down"]
    assert by["A up"] == by["B up"]
    assert max(by["A up"]) < max(c.target for c in steps)


def test_golden_constant_force_cycles():
    visited = targets("constant_force_cycles", cycles=2, points=10, lower_K=20.0, upper_K=120.0)
    up = [30.0 + 10 * k for k in range(10)]
    down = [110.0 - 10 * k for k in range(10)]
    assert visited == pytest.approx([20.0, *up, *down, *up, *down])
    whole = targets("constant_force_cycles", cycles=1, points=10)
    assert (min(whole), max(whole)) == pytest.approx((0.0, 174.1)), "the rig's range by default"


def test_validation_follows_its_seed():
    assert targets("validation", seed=3) == targets("validation", seed=3)
    assert targets("validation", seed=3) != targets("validation", seed=4)


def test_profiles_from_lists_and_files(tmp_path):
    assert targets("step_currents", temperatures_K="10, 20,15") == [10, 20, 15]
    assert targets("step_currents", currents_A=(0.5, 1.0)) == pytest.approx([43.525, 174.1])
    file = tmp_path / "profile.csv"
    file.write_text("temperature_K\n5\n60\n")
    assert targets("step_currents", file=str(file)) == [5, 60]


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("first_order_descending", {"partition_K": "0,50,40,100"}, "must increase: 40 follows 50"),
        ("first_order_descending", {"partition_K": "0,100"}, "at least 3"),
        ("first_order_descending", {"partition_K": "0,50,300"}, "outside the rig's range"),
        ("first_order_ascending", {"partition_K": "0,x,300"}, "partition_K"),
        ("step_currents", {"profile": "zigzag"}, "setting profile"),
        ("step_currents", {"file": "nowhere.csv"}, "nowhere.csv"),
        ("step_currents", {"points": "1"}, "between 2 and"),
        ("constant_force_cycles", {"points": "5"}, "points must lie between 10"),
        ("constant_force_cycles", {"upper_K": "300"}, "upper_K: 300 K is outside"),
        ("constant_force_cycles", {"lower_K": "90", "upper_K": "80"}, "lower_K must be below upper_K"),
        ("validation", {"points": "ten"}, "setting points"),
        ("congruency", {"low": "0.8"}, "low < high < peak"),
        ("minor_loops", {"loops": "0"}, "loops"),
        ("initialise", {"method": "magic"}, "setting method"),
        ("wiping_out", {"settle.window": "3"}, "settle.window"),
        ("wiping_out", {"settle.window_s": "-3"}, "Settling needs"),
    ],
)
def test_bad_settings_get_one_sentence(name, settings, message):
    with pytest.raises(UsageError, match=message) as caught:
        list(build_protocol(name, Setup.of("one_wire_twin"), settings))
    assert "\n" not in str(caught.value)


def test_profile_file_errors_name_the_line(tmp_path):
    file = tmp_path / "p.csv"
    file.write_text("temperature_K\n5\nsix\n")
    with pytest.raises(Exception, match=r"line 3: 'six'"):
        list(build_protocol("step_currents", Setup.of("one_wire_twin"), {"file": str(file)}))


def test_pairs_must_be_pairs():
    assert parse_pairs(("a=1", "b = x=y")) == {"a": "1", "b": "x=y"}
    with pytest.raises(UsageError, match="'oops'"):
        parse_pairs(("oops",))


def test_initialise_thesis_uses_the_printed_formula():
    import math

    waves = [
        c
        for c in build_protocol("initialise", Setup.of("two_wire_twin"), {"method": "thesis"})
        if isinstance(c, Waveform)
    ]
    current = waves[0].currents_A[249]  # t = 25 s
    expected = (180 - 25) / 180 * 185 * math.sin(0.2 * math.pi * 25)
    assert math.isclose(math.copysign(185 * current**2, current), expected, abs_tol=1e-6)
    assert len(waves[0].currents_A) == 1800


def test_a_decimal_comma_in_a_list_is_refused_and_not_split():
    setup = Setup.of("one_wire_twin")
    for text in ("0.2;0.4", "0.2,0.4", "0.2, 0.4"):
        steps = [
            c.current_A
            for c in build_protocol("step_currents", setup, {"currents_A": text})
            if isinstance(c, Hold)
        ]
        assert steps[-2:] == [0.2, 0.4]
    with pytest.raises(
        UsageError, match=r"'0,2; 0,4' has commas and semicolons\. Write decimals with a point"
    ):
        build_protocol("step_currents", setup, {"currents_A": "0,2; 0,4"})


@pytest.mark.parametrize(
    ("limits", "largest_A"), [("current_max_A = 0.5", 0.5), ("temperature_max_K = 90", 0.717)]
)
def test_minor_loops_follow_the_limits_of_the_rig(tmp_path, limits, largest_A):
    """By default up to three quarters of what is allowed, with a margin of 0.5 K below the temperature."""
    path = tmp_path / "small.toml"
    path.write_text(f'name = "small"\nbase = "one_wire_twin"\n[limits]\n{limits}\n')
    rig = load_rig(str(path))
    protocol = build_protocol("minor_loops", Setup.of(str(path)))
    (loops,) = [command for command in protocol if isinstance(command, Waveform)]
    assert max(loops.currents_A) == pytest.approx(0.75 * largest_A, abs=1e-3)
    assert preview("minor_loops", rig).peak_current_A <= rig.limits.current_max_A
