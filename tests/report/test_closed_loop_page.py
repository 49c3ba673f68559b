"""Pages of closed loops and certificates: figures show the record, and texts state what is proved."""

from dataclasses import replace

import numpy as np
import pytest

from control.model_files import model_of
from report.pages import Page, run_of, unpacked
from smarig.app.loop_model import ModelSource
from smarig.app.regulation_loop import regulation
from smarig.app.tracking_loop import tracking
from smarig.certificate.certify_hysteresis import certificate
from smarig.control.regulation.regulation_protocol import SETPOINT_DISTURBED
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import Event, load_run
from smarig.report.certificate.certificate_page import certificate_page, certified_model
from smarig.report.closed_loop.closed_loop_figures import clipped_text, error_half_range
from smarig.report.closed_loop.closed_loop_text import loop_assessment, loop_result_text
from smarig.report.closed_loop.hold_end import HoldEnd
from smarig.report.closed_loop.loop_result import closed_loop_result
from smarig.report.run_page import run_page
from smarig.runner.session import Session

COUNT_mm = 0.04712


@pytest.fixture(scope="module")
def closed_loop_model():
    return ModelSource(model_of("one_e"), "one_e.model.json", "1" * 64)


@pytest.fixture(scope="module")
def runs(tmp_path_factory, closed_loop_model):
    """Twenty seconds of steps, and a set-point held against a disturbance, in one session."""
    folder = tmp_path_factory.mktemp("loops")
    with Session("one_wire_twin", seed=2) as session:
        loops = {
            "track": tracking(closed_loop_model, session.file, "steps", {"seconds": 20, "every_s": 10}),
            "regulate": regulation(closed_loop_model, session.file, 6.0, hold_s=120.0, disturbance_K=6.0),
        }
        return {
            name: load_run(
                session.run(name, made.settings, folder / f"{name}.run.sqlite", protocol_factory=made.make)
            )
            for name, made in loops.items()
        }


@pytest.mark.long("takes a second")
def test_a_tracked_run_shows_wanted_and_measured_and_the_error_in_counts(runs):
    run = runs["track"]
    page, found = Page(run_page(run)), closed_loop_result(run)
    wanted, measured = page.traces("reference")[0], page.traces("measured")[0]
    np.testing.assert_allclose(unpacked(wanted["y"]), found.loop.wanted, rtol=1e-6)
    np.testing.assert_allclose(unpacked(measured["y"]), found.loop.position, atol=1e-6)
    error = next(t for t in page.traces() if t["name"] == "error")
    counts = (found.loop.position - found.loop.wanted) / COUNT_mm
    np.testing.assert_allclose(unpacked(error["y"]), counts, rtol=2e-4, atol=1e-3)
    band = page.traces("± 2 counts")[0]
    assert sorted(set(unpacked(band["y"]).tolist())) == [-2.0, 2.0]
    assert len([row for table in page.tables for row in table if row[0] in ("1", "2") and len(row) == 5]) == 2
    assert f"n = {found.measures.n}" in page.card("Error, rms")


def test_a_regulated_run_shows_where_it_went_in_the_plane(runs):
    run = runs["regulate"]
    page, found = Page(run_page(run)), closed_loop_result(run)
    psi = page.traces("ψ(ℓ)")[0]
    drawn = np.interp(found.setpoint_data["ell_K"], unpacked(psi["x"]), unpacked(psi["y"]))
    assert drawn == pytest.approx(6.0, abs=0.02)
    for name in ("reached", "predicted", "target, α = 2ℓ − β"):
        beta, alpha = (unpacked(page.traces(name)[-1][axis]) for axis in ("x", "y"))
        assert np.all(np.diff(beta) >= -1e-9)
        assert np.all(np.diff(alpha) <= 1e-9)
        assert np.abs(alpha + beta - 2 * found.setpoint_data["ell_K"])[alpha - beta < 40].max() < 30
    disturbance_shading = unpacked(page.traces("disturbance")[0]["x"])
    assert [disturbance_shading.min(), disturbance_shading.max()] == pytest.approx(found.disturbance_s)
    assert found.disturbance_s[0] == pytest.approx(60.0, abs=0.2)
    assert "predicted" in page.card("Distance from B")
    assert all(any(a["text"] == "TWIN" for a in plot["layout"]["annotations"]) for plot in page.plots)


def test_the_transient_is_the_largest_error_since_the_disturbance(runs):
    found = closed_loop_result(runs["regulate"])
    later = found.loop.t_s > found.disturbance_s[0]
    assert found.transient == np.abs(found.loop.position - found.loop.wanted)[later].max()
    assert found.zero == pytest.approx(6.0 - found.loop.wanted[0])


def test_the_end_is_the_mean_and_the_spread_of_the_last_quarter(runs):
    run = runs["regulate"]
    found = closed_loop_result(run)
    last = found.loop.t_s > 90.0
    off = found.loop.position - found.loop.wanted
    assert found.to_json()["last_error"] == pytest.approx(off[last].mean())
    assert found.to_json()["last_spread"] == pytest.approx(off[last].std())
    assert found.to_json()["last_verdict"] == "rests"
    page = Page(run_page(run))
    assert "mean of the last 30 s" in page.card("At the end")
    assert "of the readings" in page.card("Largest transient")
    assert "Largest transient after the disturbance" in loop_result_text(found, "mm")
    assert "at the end of the hold" not in page.visible


def moved(run, by):
    """The run with its readings since the loop was closed moved by ``by`` (of the time since then), in counts."""
    closed = next(e.t_s for e in run.events if e.text == "loop closed")
    position, t = run["position"].copy(), run["t_s"] - closed
    position[t > 0] += COUNT_mm * by(t[t > 0])
    return replace(run, columns={**run.columns, "position": position})


def test_a_loop_that_swings_or_rests_off_is_reported(runs):
    swinging = moved(runs["regulate"], lambda t: 5 * np.sin(t / 2))
    elsewhere = moved(runs["regulate"], lambda t: 0 * t + 13)
    for run, words in ((swinging, "The position oscillates"), (elsewhere, "counts) from the set-point")):
        assert words in loop_result_text(closed_loop_result(run), "mm")
        assert words in Page(run_page(run)).visible


def test_the_row_of_errors_reaches_as_far_as_the_errors(runs):
    """Also for a loop that is far off all the time; jumps of a reference are cut and reported."""
    elsewhere = moved(runs["regulate"], lambda t: 0 * t + 40)
    page = Page(run_page(elsewhere))
    ranges = [
        plot["layout"]["yaxis2"]["range"]
        for plot in page.plots
        if "range" in plot["layout"].get("yaxis2", {})
    ]
    assert ranges[0][1] > np.abs(closed_loop_result(elsewhere).loop.error).max() > 40
    assert "The axis ends" not in page.visible
    jumps = np.r_[np.full(97, 0.5), np.full(3, 80.0)]
    assert error_half_range(jumps) == 12.0
    assert error_half_range(jumps, 30.0) == pytest.approx(34.5)
    assert "3 % of the readings exceed it, up to 80.0 counts" in clipped_text(jumps, 12.0)
    assert error_half_range(np.full(9, 0.1)) == 4.0
    assert clipped_text(jumps, 92.0) == ""


def test_a_transient_before_the_disturbance_does_not_count(runs):
    """Half a millimetre before the push, in the readings themselves."""
    run = runs["regulate"]
    before = closed_loop_result(run)
    mark = next(e for e in run.events if e.kind == "mark" and e.text == SETPOINT_DISTURBED)
    position = run["position"].copy()
    position[run["t_s"] < mark.t_s - 1.0] += 0.5
    shifted = closed_loop_result(replace(run, columns={**run.columns, "position": position}))
    assert np.abs(shifted.loop.error).max() > 10
    assert shifted.transient == before.transient


def test_the_end_of_the_last_step_is_none(runs):
    """At its last time a held reference has its last position already: no wire jumps there within a tick."""
    run = runs["track"]
    found = closed_loop_result(run)
    assert found.loop.t_s[-1] < found.reference.duration_s - 1e-6
    assert found.loop.wanted[-1] == found.reference.position[-2]


def test_the_loops_page_has_the_certificate_and_states_when_it_is_of_another_model(runs, closed_loop_model):
    same = Page(
        run_page(
            runs["track"],
            certified=(closed_loop_model.model, closed_loop_model.name, closed_loop_model.sha256),
        )
    )
    other = Page(
        run_page(runs["track"], certified=(closed_loop_model.model, closed_loop_model.name, "2" * 64))
    )
    assert "Certificate of the model" in same.headings
    assert same.row("leaky_pi")[4:] == ["5", "covered"]
    assert same.visible.index("This certificate does not cover the loop") < same.visible.index(
        "Passive without bias"
    )
    assert "The loop fed back the position (controller inverse, which tracked steps)" in same.visible
    assert "This loop did not use" not in same.visible
    assert "This loop did not use" in other.visible
    assert "Certificate of the model" not in Page(run_page(runs["track"])).headings


@pytest.mark.long("takes two seconds", cases=("one_p-Not passive",))
@pytest.mark.parametrize(("name", "verdict"), [("one_c", "Passive without bias"), ("one_p", "Not passive")])
def test_the_page_of_a_certificate(name, verdict):
    model = model_of(name)
    found = certificate(model.hysteresis)
    page = Page(certificate_page(model, found, certified_model(model, f"{name}.model.json", "3" * 64)))
    assert page.visible.lstrip().startswith("TWIN")
    assert page.visible.count(verdict) == 1
    assert page.row("constant_gain")[-1] == ("covered" if name == "one_c" else "not covered: passive fails")
    assert page.row("Thm 8.1")[1:3] == ["ν ≥ 0", "holds"] if name == "one_c" else "gives back" in page.visible
    psi = page.traces("ψ(ℓ)")[0]
    assert unpacked(psi["y"])[0] == pytest.approx(thesis_surface(name).y_lower)
    assert f"{name}.model.json" in page.visible
    assert "f.run.sqlite" in page.visible


MARKED = {
    "reference": {"name": "ramps", "t_s": [0, 9], "position": [1, 2]},
    "start_s": 0.0,
    "controller": "pi",
}


@pytest.mark.parametrize(
    "mark",
    [
        Event(0.0, "info", "mark", "closed loop", {}),
        Event(0.0, "info", "mark", "closed loop", MARKED | {"reference": {"t_s": [3], "position": []}}),
        Event(0.0, "info", "mark", "closed loop", MARKED),
        Event(0.0, "info", "mark", "regulate", {"lower_K": None}),
        Event(0.0, "info", "mark", "regulate", {"lower_K": 0.0, "upper_K": 100.0}),
    ],
)
def test_incomplete_marks_cost_the_section_and_not_the_page(mark):
    odd = {
        "setpoint": 1,
        "rest_K": 2,
        "lower_K": 0.0,
        "upper_K": 1.0,
        "start": 5,
        "psi_ell_K": [0, 1],
        "psi": [0, 1],
    }
    assert closed_loop_result(run_of({}, (), (Event(0.0, "info", "mark", "regulate", odd),))) is not None, (
        "the least there is"
    )
    columns = {"t_s": [0.1], "position": [1.0], "input": [3.0], "current_A": [0.2]}
    for run in (run_of({}, (), (mark,)), run_of(columns, (), (mark,))):
        page = Page(run_page(run))
        assert "Closed loop" in page.headings
        assert "Provenance" in page.headings


# --- pass or fail ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settle", "rms", "words", "level"),
    [
        (
            (3.0, 4.0),
            9.0,
            "Pass: every step settled within 0.1 mm (2.0 counts), the slowest after 4 s",
            "good",
        ),
        ((3.0, np.inf), 0.1, "Fail: step 2 did not settle", "bad"),
        ((np.inf, np.inf, 1.0), 0.1, "Fail: 2 of 3 steps (first: 1) did not settle", "bad"),
        ((), 0.09, "Pass: the rms error is within the goal of 0.1 mm (2.0 counts)", "good"),
        ((), 0.3, "Fail: the rms error is 3 times the goal of 0.1 mm (2.0 counts)", "bad"),
    ],
)
def test_a_loop_passes_or_fails_by_its_figures(runs, settle, rms, words, level):
    run = runs["track"]
    found = closed_loop_result(run)
    measures = replace(found.measures, rms=rms, settle_s=settle, overshoot=(0.05,) * len(settle))
    other = replace(found, measures=measures, loop=replace(found.loop, count=0.05))
    assessed = loop_assessment(run, other)
    assert words in assessed.quality
    assert assessed.level == level


@pytest.mark.parametrize(
    ("mean", "std", "crossings", "words", "level"),
    [
        (0.0, 0.02, 0, "Pass: the position rests at its set-point, within 0.1 mm", "good"),
        (0.3, 0.02, 0, "Fail: The position settled 0.3 mm (6.0 counts) from the set-point.", "bad"),
        (0.0, 0.2, 5, "Fail: The position oscillates at the end of the hold", "bad"),
        (0.0, 0.2, 0, "Fail: The position still moves at the end of the hold", "bad"),
    ],
)
def test_a_set_point_is_held_or_not(runs, mean, std, crossings, words, level):
    run = runs["regulate"]
    end = HoldEnd(mean, std, 4 * std, (0.1, 0.2), 60.0, crossings, 0.05)
    assessed = loop_assessment(run, replace(closed_loop_result(run), end=end))
    assert words in assessed.quality
    assert assessed.level == level


def test_a_loop_without_an_end_is_not_judged(runs):
    assessed = loop_assessment(runs["regulate"], replace(closed_loop_result(runs["regulate"]), end=None))
    assert assessed.level == "warning"


@pytest.mark.parametrize("name", ["track", "regulate"])
def test_the_page_of_a_loop_opens_with_the_verdict(runs, name):
    page = Page(run_page(runs[name]))
    verdict = loop_assessment(runs[name], closed_loop_result(runs[name])).quality
    assert page.visible.index(verdict) < page.visible.index(page.captions[0])
