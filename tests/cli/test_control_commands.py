"""``smarig certify``, ``track``, ``regulate`` and ``list controllers``: JSON objects, files and errors."""

import json

import numpy as np
import pytest

from control.model_files import model_file, model_of
from smarig.cli import run as cli
from smarig.control.controller_settings import (
    SETPOINT_CONTROLLERS,
    TRACKING_CONTROLLERS,
    VELOCITY_CONTROLLERS,
    default_numbers,
    documented_numbers,
    optional_numbers,
)
from smarig.control.tracking import tracking_protocol as loop
from smarig.core.catalogue import catalogue_entry, catalogue_names
from smarig.core.errors import UsageError
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.record import load_run
from smarig.replay.model_file import SignalDescription, load_model
from smarig.report.closed_loop.loop_result import closed_loop_result
from smarig.runner.run_control import RunControl

RAMPS = ("--reference", "ramps", "--set", "seconds=20", "--set", "every_s=5")
ON = ("--rig", "one_wire_twin", "--quiet")


def call(capsys, *words):
    status = cli([str(word) for word in words])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    assert "Internal error" not in err
    return status, out, err


@pytest.fixture
def one(tmp_path):
    return model_file(tmp_path, "one_e")


@pytest.fixture
def two(tmp_path):
    return model_file(tmp_path, "two_p")


# --- certify --------------------------------------------------------------------------------------------


def test_a_certificate_names_its_hypotheses(capsys, one):
    status, out, _ = call(capsys, "certify", one, "--json")
    found = json.loads(out)
    assert status == 0
    assert found["passive"] is True
    assert found["classes"] == {"M_PC": True, "M_P": False, "g_not_negative": True, "positive": False}
    assert found["storage"] == {"ground": "recoverable", "proved": True, "bias": 0.0, "unit": "mm·K"}
    assert found["breaking"] is None
    assert len(found["sha256"]) == 64
    assert found["data"][0]["rows"] == 7
    by_name = {c["name"]: c for c in found["controllers"]}
    assert set(by_name) == {"constant_gain", "lead_lag", "leaky_pi", "saturating_gain", "scheduled_gain"}
    assert by_name["leaky_pi"]["k_e"] == pytest.approx((400 + 100) / 100)  # k_p = 100, k_i/a = 300
    assert all(c["holds"] for c in by_name.values())


@pytest.mark.long("takes two seconds")
def test_where_passivity_fails_the_counterexample_is_printed(capsys, two):
    from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
    from smarig.theory.energy import energy_balance

    status, out, _ = call(
        capsys, "certify", two, "--controller", "constant_gain", "--set", "gain=4", "--json"
    )
    found = json.loads(out)
    assert status == 0
    assert found["passive"] is False
    assert [(c["name"], c["holds"], c["delta"]) for c in found["controllers"]] == [
        ("constant_gain", False, 4.0)
    ]
    assert found["controllers"][0]["k_e"] is None
    assert found["controllers"][0]["coverage"] == "not covered: passive, output follows input fail"
    start, low, high = found["breaking"]["way"]
    cycles = found["breaking"]["cycles_until_negative"]
    u = [start, low, high, *[low, high] * cycles]
    assert energy_balance(thesis_surface("two_p"), np.array(u), "anhysteretic").supplied[-1] < 0


def test_a_model_with_effects_is_certified_for_its_hysteresis_alone(capsys, tmp_path):
    (effect,) = effects_from_pairs(["backlash"])
    effects = ({"name": effect.kind.name, "parameters": dict(effect.values)},)
    model = model_file(tmp_path, "one_e", effects=effects)
    status, out, _ = call(capsys, "certify", model)
    assert status == 0
    assert "not its effects (backlash)" in out


def test_a_tables_certificate_uses_the_models_units(capsys, tmp_path):
    """A table of relays, or of anything, may not know its unit: the model file does."""
    nodes = np.array([0.0, 50.0, 100.0, 174.0])
    y = np.where(np.tri(4, dtype=bool), nodes[:, None] / 20 - 2 + nodes / 100, np.nan)
    nameless = FodTable.from_arrays(nodes, nodes, y)
    model = model_file(tmp_path, "one_e", hysteresis=nameless)
    status, out, _ = call(capsys, "certify", model, "--controller", "constant_gain", "--json")
    found = json.loads(out)
    assert status == 0
    assert (found["dissipativity"]["unit"], found["storage"]["unit"]) == ("mm·K", "mm·K")
    assert found["units"]["gain"] == "K·s/mm"


# --- track and regulate ---------------------------------------------------------------------------------


def test_a_tracked_run_is_reported_in_the_rigs_unit_and_in_counts(capsys, one, tmp_path):
    out_file = tmp_path / "t.run.sqlite"
    words = ("--controller", "pi", "--controller-set", "gain_share=10", "-o", out_file)
    status, out, _ = call(capsys, "track", one, *RAMPS, *words, *ON, "--json")
    found, run = json.loads(out), load_run(out_file)
    assert status == 0
    assert found["cause"] == "done"
    track = found["track"]
    assert track["rms_counts"] == pytest.approx(track["rms"] / run.meta["output"]["per_count"])
    assert track["rms"] < track["largest"] < 12.6
    assert run.meta["settings"]["gain_share"] == "10.0"
    assert run.meta["settings"]["model"] == one.name
    assert len(run.meta["settings"]["model_sha256"]) == 64
    loop = closed_loop_result(run).loop
    assert loop.t_s[-1] == pytest.approx(20.0)
    assert track["largest"] == pytest.approx(np.abs(loop.position - loop.wanted).max())


@pytest.mark.long("takes a second")
def test_a_set_point_is_held_and_its_figures_reported(capsys, one, tmp_path):
    out_file = tmp_path / "r.run.sqlite"
    words = ("--setpoint", 6, "--hold-s", 120, "--disturbance-K", 6, "-o", out_file)
    status, out, _ = call(capsys, "regulate", one, *words, *ON, "--json")
    found = json.loads(out)["regulate"]
    assert status == 0
    assert found["output"] == pytest.approx(6.0)
    assert found["reached_distance_K2"] == pytest.approx(found["predicted_distance_K2"], rel=0.1)
    assert abs(found["output_error"]) < 0.1
    assert 0.05 < found["transient"] < 1.0
    assert abs(found["last_error"]) < found["transient"]


def test_from_a_notebook(one, tmp_path):
    import smarig

    run = smarig.track(one, "ramps", rig="one_wire_twin", out=tmp_path / "t.run.sqlite", seconds=5)
    assert run.cause == "done"
    assert run.meta["closed_loop"]
    with pytest.raises(UsageError, match="start must be one of .*diagonal.*, not 'diagnal'"):
        smarig.regulate(one, 6.0, rig="one_wire_twin", out=tmp_path / "r.run.sqlite", start="diagnal")


@pytest.mark.long("takes two seconds")
def test_velocity_feedback_is_measured_against_its_k_e(capsys, one, tmp_path):
    from smarig.report.run_page import run_page

    out_file = tmp_path / "v.run.sqlite"
    words = (*LEAKY, "--controller-set", "gain=50", "--offset-K", 30, "-o", out_file)
    status, out, _ = call(capsys, "track", one, *RAMPS, *words, *ON, "--json")
    found, run = json.loads(out)["track"]["velocity"], load_run(out_file)
    assert status == 0
    assert (found["delta"], found["gamma"], found["k_e"]) == (50.0, 350.0, 8.0)
    assert (found["offset_K"], found["lead_in_s"], found["coverage"]) == (30.0, 20.0, "covered")
    assert 0 < found["ratio"] < found["rest_ratio"] < found["k_e"]
    assert found["ratio"] < found["raw_ratio"], "noise and quantum are in the unfiltered velocity"
    broken = [h["name"] for h in found["hypotheses"] if h["holds"] is False]
    assert set(broken) - {"input as commanded"} == {"no delay", "exact velocity"}
    assert ("input as commanded" in broken) == (found["clipped_share"] > 0)
    page = run_page(run, certified=(load_model(one), one.name, ""))
    for words in ("Measured ratio", "proved for the operator, not for this rig", "exact velocity", "350"):
        assert words in page
    assert page.count("<td>leaky_pi</td>") + page.count(">leaky_pi</th>") == 1, (
        "its certificate, and no other's"
    )
    assert "constant_gain" not in page
    assert "which was not run" not in page


def test_a_velocity_loop_is_read_again_from_its_samples(one, tmp_path):
    """The ratio of the record is the last point of the one that is drawn."""
    import smarig
    from smarig.report.closed_loop.velocity_result import VelocitySignals

    out_file = tmp_path / "v.run.sqlite"
    path = {"seconds": 20.0, "low": 2.0, "high": 8.0}
    run = smarig.track(
        one,
        "ramps",
        rig="one_wire_twin",
        out=out_file,
        controller="constant_gain",
        numbers={"gain": 1000},
        **path,
    )
    found = closed_loop_result(run)
    signals = VelocitySignals.of(found.reference, found.loop.t_s, found.loop.position, found.velocity)
    assert signals.ratio[-1] == pytest.approx(found.velocity.ratio, rel=1e-6)
    assert np.abs(np.diff(signals.rate)).max() > 0.01, "it turns"
    assert found.velocity.rest_ratio == pytest.approx(1.0)


def test_a_file_gives_the_reference(capsys, one, tmp_path):
    wanted = tmp_path / "wanted.csv"
    wanted.write_text("time_s,position_mm\n0,3\n10,6\n", encoding="utf-8")
    status, out, _ = call(capsys, "track", one, "--reference", wanted, *ON, "--dry-run", "--json")
    assert status == 0
    assert json.loads(out)["preview"]["duration_s"] > 10


def test_a_notebook_is_pointed_to_the_closed_loop_functions(tmp_path):
    import smarig

    with pytest.raises(UsageError, match=r"'track' is not a protocol .*smarig\.track\(model, …\)"):
        smarig.run("track", rig="one_wire_twin", out=tmp_path / "t.run.sqlite")


def test_a_protocol_of_ones_own_may_be_called_like_a_loop(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "track.py").write_text("def track(setup):\n    yield from ()\n")
    assert call(capsys, "run", "./track.py", *ON, "-o", "t.run.sqlite")[0] == 0


def test_a_stopped_loop_does_not_offer_a_resume(capsys, one, tmp_path, monkeypatch):
    look, ticks = RunControl.raise_if_stopped, iter(range(10**6))

    def stopped(self):
        if next(ticks) > 1500:  # of the preview's 890 and the run's
            self.stop("stopped by the operator")
        look(self)

    monkeypatch.setattr(RunControl, "raise_if_stopped", stopped)
    out_file = tmp_path / "t.run.sqlite"
    status, _, err = call(capsys, "track", one, *RAMPS, "-o", out_file, *ON)
    assert status == 130
    assert "Start it again" in err
    assert "smarig resume" not in err
    monkeypatch.undo()
    status, _, err = call(capsys, "resume", out_file, "--quiet")
    assert status == 2
    assert "closed loop" in err


def test_a_loop_that_diverges_ends_at_zero_with_status_3(capsys, one, tmp_path, monkeypatch):
    """An encoder that is half a minute late shows old positions; the preview does not include the injected
    effect."""
    monkeypatch.setattr(loop, "DivergenceLimits", lambda: IMPATIENT)
    out_file = tmp_path / "t.run.sqlite"
    far = (
        "--reference",
        "steps",
        "--set",
        "low=8",
        "--set",
        "high=9",
        "--set",
        "seconds=60",
        "--set",
        "every_s=60",
    )
    status, _, err = call(capsys, "track", one, *far, "--effect", "sensor_lag=30", "-o", out_file, *ON)
    run = load_run(out_file)
    assert status == 3
    assert "The loop diverges" in err
    assert "The current is at zero." in err
    assert run.cause.startswith("stopped: The loop diverges")


IMPATIENT = loop.DivergenceLimits(share=0.04, seconds=5.0)


LEAKY = ("--controller", "leaky_pi")
VELOCITY_STEPS = ("--reference", "steps", *LEAKY)
MISTAKES = [
    (2, ["certify", "nowhere.json"], "nowhere.json"),
    (2, ["certify", "ONE", "--controller", "leaky"], "did you mean leaky_pi"),
    (2, ["certify", "ONE", "--controller", "inverse"], "'inverse' is a position loop"),
    (2, ["certify", "ONE", "--set", "gain=1"], "--controller"),
    (2, ["certify", "ONE", "--controller", "leaky_pi", "--set", "gane=1"], "did you mean gain"),
    (2, ["certify", "ONE", "--controller", "leaky_pi", "--set", "gain=-1"], "positive"),
    (2, ["certify", "ONE", "--controller", "leaky_pi", "--set", "gain=nan"], "not finite"),
    (2, ["certify", "ONE", "--controller", "saturating_gain", "--set", "least=300"], "least ≤ most"),
    (2, ["certify", "ONE", "-o", "ONE", "--force"], "both input and output"),
    (4, ["certify", "BROKEN"], "not a model file"),
    (2, ["track", "ONE", *RAMPS, *ON], "-o"),
    (2, ["run", "track", "-o", "x", *ON], "'smarig track MODEL …' (see 'smarig track --help')"),
    (2, ["run", "regulate", "-o", "x", *ON], "'smarig regulate MODEL …'"),
    (2, ["check", "one_wire_twin", "--protocol", "regulate"], "'smarig regulate MODEL …'"),
    (2, ["track", "ONE", *RAMPS, "-o", "x", "--rig", "two_wire_twin"], "is of a one-wire rig"),
    (2, ["track", "ONE", *RAMPS, "--controller", "leaky_p", "-o", "x", *ON], "did you mean leaky_pi"),
    (2, ["track", "ONE", *VELOCITY_STEPS, "-o", "x", *ON], "which is infinite at the jumps of steps"),
    (2, ["track", "ONE", *RAMPS, *LEAKY, "--offset-K", "500", "-o", "x", *ON], "whole range, 174.1 K"),
    (2, ["track", "ONE", *RAMPS, *LEAKY, "--offset-K", "nan", "-o", "x", *ON], "not a finite number"),
    (2, ["track", "ONE", *RAMPS, "--offset-K", "5", "-o", "x", *ON], "'inverse' feeds back the position"),
    (2, ["track", "ONE", *RAMPS, *LEAKY, "--controller-set", "gane=1", "-o", "x", *ON], "did you mean gain"),
    (2, ["track", "ONE", "--reference", "STILL", *LEAKY, "-o", "x", *ON], "Nothing drives a loop"),
    (2, ["track", "DEGREES", *RAMPS, "-o", "x", *ON], "is in deg"),
    (2, ["track", "ONE", "--reference", "stepps", "-o", "x", *ON], "did you mean steps"),
    (2, ["track", "ONE", "--reference", "nowhere.csv", "-o", "x", *ON], "nowhere.csv"),
    (2, ["track", "ONE", "--reference", "BROKEN", "-o", "x", *ON], "time_s"),
    (2, ["track", "ONE", *RAMPS, "--set", "high=99", "-o", "x", *ON], "reaches from"),
    (2, ["track", "ONE", *RAMPS, "--set", "low=9", "--set", "high=2", "-o", "x", *ON], "low < high"),
    (2, ["track", "ONE", *RAMPS, "--set", "hihg=9", "-o", "x", *ON], "did you mean high"),
    (2, ["track", "ONE", *RAMPS, "--set", "seed=1.5", "-o", "x", *ON], "whole number"),
    (2, ["track", "ONE", *RAMPS, "--set", "speed=1e12", "-o", "x", *ON], "points"),
    (2, ["track", "ONE", *RAMPS, "--set", "seconds=inf", "-o", "x", *ON], "not finite"),
    (2, ["track", "ONE", *RAMPS, "--controller", "pid", "-o", "x", *ON], "did you mean pi"),
    (2, ["track", "ONE", *RAMPS, "--controller-set", "walk", "-o", "x", *ON], "key=value"),
    (2, ["track", "ONE", *RAMPS, "--controller-set", "walk=0", "-o", "x", *ON], "positive"),
    (2, ["track", "ONE", *RAMPS, "-o", "ONE", "--force", *ON], "both input and output"),
    (2, ["track", "ONE", *RAMPS, "-o", "BROKEN", *ON], "--force"),
    (2, ["regulate", "ONE", "--setpoint", "13", "-o", "x", *ON], "reaches from 0 to 12.54 mm"),
    (2, ["regulate", "ONE", "--setpoint", "nan", "-o", "x", *ON], "not finite"),
    (2, ["regulate", "ONE", "--setpoint", "6", "--within", "2", "-o", "x", *ON], "between 0 and 1"),
    (
        2,
        ["regulate", "ONE", "--setpoint", "6", "--within", "1e-7", "-o", "x", *ON],
        "Allow a larger distance",
    ),
    (2, ["regulate", "ONE", "--setpoint", "6", "--hold-s", "-1", "-o", "x", *ON], "negative"),
    (2, ["regulate", "ONE", "--setpoint", "6", "--hold-s", "1e12", "-o", "x", *ON], "into several holds"),
    (
        2,
        ["regulate", "ONE", "--setpoint", "6", "--hold-s", "9", "--disturbance-K", "3", "-o", "x", *ON],
        "longer",
    ),
    (2, ["regulate", "ONE", "--setpoint", "6", "--controller", "inverse", "-o", "x", *ON], "pi"),
    (2, ["regulate", "ONE", "--setpoint", "6", "--controller-set", "gain=0", "-o", "x", *ON], "positive"),
]


@pytest.mark.long("takes a second", cases=("2-words40-Allow a larger distance",))
@pytest.mark.parametrize(("status", "words", "says"), MISTAKES)
def test_a_mistake_gets_one_sentence_and_leaves_nothing(capsys, tmp_path, monkeypatch, status, words, says):
    monkeypatch.chdir(tmp_path)
    files = {
        "ONE": model_file(tmp_path, "one_e").name,
        "DEGREES": in_degrees(tmp_path).name,
        "BROKEN": "broken.json",
        "STILL": "still.csv",
    }
    (tmp_path / "still.csv").write_text("time_s,position_mm\n0,0\n10,0\n", encoding="utf-8")
    (tmp_path / "broken.json").write_text("{}", encoding="utf-8")
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    got, _, err = call(capsys, *(files.get(word, word) for word in words))
    assert got == status, err
    assert says in err
    assert err.strip().count("\n") == 0
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def in_degrees(folder):
    odd = model_of("one_e", output=SignalDescription(quantity="shaft angle", unit="deg"))
    return odd.save(folder / "degrees.model.json")


@pytest.mark.long("takes two seconds", cases=("0.06-False",))
@pytest.mark.parametrize(("setpoint", "warned"), [("0.02", True), ("0.06", False)])
def test_a_setpoint_within_a_count_of_the_cold_wire_is_remarked(capsys, one, setpoint, warned):
    """A count is 0.047 mm."""
    _, _, err = call(capsys, "regulate", one, "--setpoint", setpoint, *ON, "--dry-run")
    assert ("lies within one count (0.0471 mm) of the lower end of the range, 0 mm" in err) is warned


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "numbers0-does not overshoot and stays within a count",
        "numbers1-It may overshoot",
        "numbers3-dead time 2 s",
    ),
)
@pytest.mark.parametrize(
    ("numbers", "says"),
    [
        ((), "does not overshoot and stays within a count"),
        (("gain=0.3",), "It may overshoot"),
        (("gain=9",), "For this gain nothing is certified"),
        (("delay_s=2",), "dead time 2 s"),
    ],
)
def test_regulate_states_what_is_certified_of_its_integral_gain(capsys, one, numbers, says):
    settings = [word for pair in numbers for word in ("--controller-set", pair)]
    words = ("--setpoint", "6", "--controller", "integral", *settings, *ON, "--dry-run")
    status, _, err = call(capsys, "regulate", one, *words)
    assert status == 0
    assert says in err


@pytest.mark.long("takes two seconds")
def test_certify_prints_the_gain_that_regulate_takes(capsys, one):
    """The gain of the circle criterion, 1/(λ (dT + (T/2) coth(T/2τ))), with λ from a grid of branches."""
    status, out, _ = call(capsys, "certify", one, "--samples", "0", "--json")
    found = json.loads(out)["integral_action"]
    assert status == 0
    assert found["gain_unit"] == "K/(mm·s)"
    model, tau_s = load_model(one), 5.33
    F, h = model.hysteresis.everett, 0.05
    pairs = [(b, a) for a in np.arange(0.0, 170, 5.0) for b in np.arange(a, 174, 1.0)]
    rising = max((F(b + h, a) - F(b, a)) / h for b, a in pairs)
    falling = max((F(b, a) - F(b, a + h)) / h for b, a in pairs if a + h < b)
    steepest = max(rising, falling)
    lag_s = 0.1 + 0.05 / np.tanh(0.05 / tau_s)
    assert found["gain_any_state"] == pytest.approx(1 / (steepest * lag_s), rel=0.02)
    _, _, err = call(capsys, "regulate", one, "--setpoint", "6", "--controller", "integral", *ON, "--dry-run")
    assert f"Integral gain {found['gain_from_rest']:.4g} K/(mm·s);" in err
    _, text, _ = call(capsys, "certify", one, "--samples", "0")
    assert f"up to {found['gain_from_rest']:.4g} K/(mm·s) from rest" in text


def test_without_the_rig_of_the_model_there_is_no_gain(capsys, tmp_path):
    elsewhere = model_file(tmp_path, "one_e", rig="a_rig_of_others")
    found = json.loads(call(capsys, "certify", elsewhere, "--samples", "0", "--json")[1])["integral_action"]
    assert found["gain_from_rest"] is None
    assert found["gain_times_lag"] > 0


def test_an_integral_gain_is_recorded_with_its_limits(one):
    from smarig.app import ModelSource, regulation
    from smarig.config import load_rig

    loop = regulation(ModelSource.of(one), load_rig("one_wire_twin"), 6.0, controller="integral")
    s = loop.settings
    assert s["gain"] == s["certified_from_rest"] < s["certified_any_state"]
    assert s["delay_s"] == pytest.approx(0.1)


@pytest.mark.long("takes three seconds")
def test_a_model_whose_output_falls_has_no_integral_gain_of_its_own(capsys, two):
    words = ("--setpoint", "3", "--controller", "integral", "--rig", "two_wire_twin", "--quiet", "--dry-run")
    status, _, err = call(capsys, "regulate", two, *words)
    assert status == 2
    assert "no integral gain is certified" in err
    status, _, err = call(capsys, "regulate", two, *words, "--controller-set", "gain=0.01")
    assert "no convergence is certified with this model" in err


def test_regulate_points_to_track_for_the_velocity(capsys, one):
    words = ("--setpoint", "6", "--controller", "constant_gain", *ON, "--dry-run")
    status, _, err = call(capsys, "regulate", one, *words)
    assert status == 2
    assert "scheduled_gain its velocity: smarig track --controller" in err


# --- list -----------------------------------------------------------------------------------------------


def test_controllers_are_listed_with_their_numbers(capsys):
    status, out, _ = call(capsys, "list", "controllers", "--settings", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["controllers"]["inverse"].startswith("track: ")
    assert found["controllers"]["leaky_pi"].startswith("track, certify: ")
    assert found["controllers"]["pi (regulate)"].startswith("regulate: ")
    assert found["settings"]["pi (regulate)"] == {"gain": None, "band": None}
    assert found["controllers"]["integral"].startswith("regulate: ")
    assert found["settings"]["integral"] == {"gain": None, "delay_s": None}
    assert set(found["settings"]) == set(found["controllers"])
    assert found["settings"]["pi"] == default_numbers(TRACKING_CONTROLLERS, "pi")
    assert (
        found["settings"]["scheduled_gain"]
        == default_numbers(VELOCITY_CONTROLLERS, "scheduled_gain")
        == {"least": 50.0, "most": 200.0}
    )


def test_every_number_has_a_unit_and_a_meaning(capsys):
    documented = [(p, n) for p in (TRACKING_CONTROLLERS, VELOCITY_CONTROLLERS) for n in catalogue_names(p)]
    assert all(
        list(documented_numbers(catalogue_entry(p, n))) == list(default_numbers(p, n)) for p, n in documented
    )
    assert all(
        list(documented_numbers(catalogue_entry(SETPOINT_CONTROLLERS, n)))
        == list(optional_numbers(SETPOINT_CONTROLLERS, n))
        for n in catalogue_names(SETPOINT_CONTROLLERS)
    )
    assert call(capsys, "list", "controllers", "--settings")[0] == 0


MINE = '''
def mine(known, wanted, *, k=0.5, told_s=2.0):
    """Mine.

    told_s (s): a time
    """
    yield 0.0
'''


def test_a_listing_explains_the_numbers(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = call(capsys, "list", "controllers", "--settings")[1]
    assert "lead_s = 0.31 s (preview time of the reference)" in printed
    assert "walk = 0.022 unit/√s (" in printed
    assert "gain = set by the model, K/unit (kelvin" in printed
    assert "cooling_share = 1.7 (gain" in printed
    (tmp_path / "mine.py").write_text(MINE)
    printed = call(capsys, "list", "controllers", "./mine.py", "--settings")[1]
    assert [line.split() for line in printed.splitlines()] == [
        ["controllers:"],
        ["mine", "track:", "Mine."],
        ["k", "=", "0.5"],
        ["told_s", "=", "2", "s", "(a", "time)"],
    ]
