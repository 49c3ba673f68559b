"""Comparison of closed loops: only loops with the same reference are compared, with the figures of their
records."""

from dataclasses import replace

import numpy as np
import pytest

from control.model_files import model_of
from report.pages import Page, run_of, step, unpacked
from smarig.app.loop_model import ModelSource
from smarig.app.regulation_loop import regulation
from smarig.app.tracking_loop import tracking
from smarig.core.errors import UsageError
from smarig.record import Event, load_run
from smarig.report.closed_loop.loop_result import closed_loop_result
from smarig.report.components.numbers import number
from smarig.report.components.style import COMPARED
from smarig.report.run_comparison_page import comparison_page
from smarig.runner.session import Session

HELD = {"hold_s": 120.0, "disturbance_K": 6.0}
STEPS = {"seconds": 20, "every_s": 10}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Two controllers along steps, one along ramps, a set-point from two states, another one undisturbed."""
    folder = tmp_path_factory.mktemp("loops")
    closed_loop_model = ModelSource(model_of("one_e"), "one_e.model.json", "1" * 64)
    with Session("one_wire_twin", seed=2) as session:
        rig = session.file
        loops = {
            "inverse": tracking(closed_loop_model, rig, "steps", STEPS),
            "pi": tracking(closed_loop_model, rig, "steps", STEPS, "pi"),
            "ramps": tracking(closed_loop_model, rig, "ramps", STEPS, "pi"),
            "diagonal": regulation(closed_loop_model, rig, 6.0, **HELD),
            "ascending": regulation(closed_loop_model, rig, 6.0, start="ascending", **HELD),
            "elsewhere": regulation(closed_loop_model, rig, 4.0, hold_s=40.0),
        }
        return {
            name: load_run(
                session.run(
                    loop.protocol, loop.settings, folder / f"{name}.run.sqlite", protocol_factory=loop.make
                )
            )
            for name, loop in loops.items()
        }


def page_of(runs, *names, **more):
    return Page(comparison_page({name: runs[name] for name in names} | more))


def table_of(page, column):
    """Rows by name of the first table with a column of this name, each a dictionary."""
    rows = next(table for table in page.tables if any(cell.startswith(column) for cell in table[0]))
    return {row[0]: dict(zip(rows[0], row)) for row in rows[1:]}


def row_of(page, name, column):
    """The one row of a run in the tables that have a column of this name."""
    (row,) = [row for table in page.tables if column in table[0] for row in table[1:] if row[0] == name]
    return row


def plot_of(page, words):
    """The traces by name and row of the first plot one of whose axes has these words."""
    titled = (
        p
        for p in page.plots
        if words in str(p["layout"].get("yaxis2", p["layout"]["yaxis"])["title"]["text"])
    )
    return {(t["name"], t.get("yaxis", "y")): t for t in next(titled)["data"]}


@pytest.mark.long("takes three seconds")
def test_controllers_along_one_reference_are_in_one_table(runs):
    page = page_of(runs, "inverse", "pi")
    table = table_of(page, "Controller")
    assert list(table) == ["inverse", "pi"]
    for name, row in table.items():
        f, count = closed_loop_result(runs[name]).measures, closed_loop_result(runs[name]).loop.count
        settled = [s for s in f.settle_s if np.isfinite(s)]
        assert row["Controller"] == name
        assert row["Error, rms (mm)"] == number(f.rms)
        assert row["rms (counts)"] == number(f.rms / count)
        assert row["Largest (counts)"] == number(f.largest / count)
        assert row["Steps settled"] == f"{len(settled)} of 2"
        assert row["Settled after (s), median"] == number(np.median(settled))
        assert row["Overshoot (counts), largest"] == number(max(f.overshoot) / count)
        assert (row["Energy (J)"], row["Peak temperature (K)"]) == (number(f.energy_J), number(f.peak_K))
    assert "Steps in common" not in page.visible
    assert "different references" not in page.visible


@pytest.mark.long("takes three seconds")
def test_positions_errors_and_what_was_wanted_are_drawn_over_each_other(runs):
    page = page_of(runs, "inverse", "pi")
    drawn = plot_of(page, "Error (counts)")
    for name in ("inverse", "pi"):
        loop = closed_loop_result(runs[name]).loop
        np.testing.assert_allclose(unpacked(drawn[name, "y"]["y"]), loop.position, atol=1e-6)
        np.testing.assert_allclose(unpacked(drawn[name, "y2"]["y"]), loop.error, rtol=1e-5, atol=1e-4)
        np.testing.assert_allclose(unpacked(drawn[name, "y3"]["y"]), loop.current_A, atol=1e-6)
    wanted, follow = drawn["reference", "y"], closed_loop_result(runs["pi"]).reference
    assert unpacked(wanted["x"]).tolist() == [0.0, 10.0, 10.0, 20.0]
    assert unpacked(wanted["y"]).tolist() == [follow.position[k] for k in (0, 0, 1, 1)]
    assert all(words.strip(" .") for caption in page.captions for words in caption.split(": "))


def test_different_lead_times_are_reported(runs):
    assert "(lead_s) differ: inverse 0.31 s, pi 0 s." in page_of(runs, "inverse", "pi").visible
    again = {"again": replace(runs["pi"], meta=dict(runs["pi"].meta))}
    assert "preview times" not in page_of(runs, "pi", **again).visible


def test_different_references_are_reported_and_not_drawn_in_one_figure(runs):
    page = page_of(runs, "inverse", "pi", "ramps")
    assert "tracked 2 different references" in page.visible
    assert list(table_of(page, "Steps settled")) == ["inverse", "pi"]
    assert row_of(page, "ramps", "Controller")[1] == "pi"
    drawn = [{t["name"] for t in plot["data"]} for plot in page.plots]
    assert {"± 2 counts", "inverse", "pi", "reference"} in drawn
    assert {"± 2 counts", "ramps", "reference"} in drawn


def test_set_points_have_their_transients_in_one_figure(runs):
    page = page_of(runs, "diagonal", "ascending")
    found = {name: closed_loop_result(runs[name]) for name in ("diagonal", "ascending")}
    table = table_of(page, "Transient / smallest")
    least = min(f.transient for f in found.values())
    for name, f in found.items():
        row = table[name]
        assert row["Start"] == name
        assert row["Largest transient (mm)"] == number(f.transient)
        assert row["Transient (counts)"] == number(f.transient / f.loop.count)
        assert row["Transient / smallest"] == number(f.transient / least)
        assert row["At the end (counts)"].endswith(f" ± {number(f.end.std / f.end.count, 2)}")
        assert row["Verdict"] == "rests"
    b_ell = found["diagonal"]
    predicted = number(100 * b_ell.setpoint_data["predicted_distance_K2"] / b_ell.setpoint_data["area_K2"])
    assert table["diagonal"]["Predicted distance from Bℓ (%)"] == predicted
    assert table["diagonal"]["Reached (%)"] == number(
        100 * b_ell.distance_K2 / b_ell.setpoint_data["area_K2"]
    )
    assert table["ascending"]["Reached (%)"] == "–"
    assert "Set-point 6 mm, disturbed by +6 K" in page.visible


def test_transients_begin_where_each_loop_was_closed(runs):
    page = page_of(runs, "diagonal", "ascending")
    drawn = next(p for p in page.plots if "set-point|" in p["layout"]["yaxis"]["title"]["text"])
    for name in ("diagonal", "ascending"):
        loop = closed_loop_result(runs[name]).loop
        error = next(t for t in drawn["data"] if t["name"] == name and t["yaxis"] == "y")
        np.testing.assert_allclose(unpacked(error["x"]), loop.t_s, atol=1e-4)
        np.testing.assert_allclose(unpacked(error["y"]), np.abs(loop.error), rtol=1e-5, atol=1e-4)
        assert drawn["layout"]["yaxis"]["range"][1] > np.abs(loop.error).max()
    (tint,) = [t for t in drawn["data"] if t["name"] == "disturbance"]
    assert unpacked(tint["x"]).min() == pytest.approx(
        closed_loop_result(runs["diagonal"]).disturbance_s[0], abs=0.5
    )


def test_the_states_and_the_output_paths_are_those_of_the_runs(runs):
    page = page_of(runs, "diagonal", "ascending")
    plane = next(p for p in page.plots if p["layout"]["yaxis"]["title"]["text"] == "α (K)")
    way = next(p for p in page.plots if "s scale (mm)" in p["layout"]["yaxis"]["title"]["text"])
    for name in ("diagonal", "ascending"):
        found = closed_loop_result(runs[name])
        state = next(t for t in plane["data"] if t["name"] == name)
        np.testing.assert_allclose(unpacked(state["x"]), [beta for beta, _ in found.boundary])
        gone = next(t for t in way["data"] if t["name"] == name)
        assert unpacked(gone["y"])[0] == pytest.approx(6.0, abs=0.15)
        assert unpacked(gone["x"])[0] == pytest.approx(found.loop.input_K[0], abs=1e-3)
    assert [t["name"] for t in plane["data"]] == ["α = β", "B_ℓ, α = 2ℓ − β", "diagonal", "ascending"]


def test_different_set_points_or_disturbances_are_reported(runs):
    page = page_of(runs, "diagonal", "ascending", "elsewhere")
    assert "These runs differ in set-point or disturbance" in page.visible
    assert list(table_of(page, "Transient / smallest")) == ["diagonal", "ascending"]
    assert row_of(page, "elsewhere", "Transient / smallest")[6:9] == ["–", "–", "–"]
    assert "Set-point 4 mm, without disturbance" in page.visible
    assert "These runs differ in" not in page_of(runs, "diagonal", "ascending").visible


INPUT = {"quantity": "temperature", "unit": "K"}


def ordinary(positions, unit="mm"):
    steps = tuple(step(k, u, y) for k, (u, y) in enumerate(zip((0.0, 90.0, 20.0), positions)))
    columns = {"t_s": np.arange(3.0), "input": np.array([0.0, 90.0, 20.0]), "position": np.array(positions)}
    output = {"quantity": "displacement", "unit": unit}
    return run_of(columns, steps, source="bench", input=INPUT, output=output)


def test_ordinary_runs_keep_to_themselves(runs):
    page = page_of(runs, "pi", a=ordinary((0, 5, 2)), b=ordinary((0, 6, 2)), inverse=runs["inverse"])
    assert list(table_of(page, "Steps in common")) == ["a", "b"]
    assert list(table_of(page, "Controller")) == ["pi", "inverse"]
    for plot in page.plots:
        names = {t["name"] for t in plot["data"]} & {"a", "b", "pi", "inverse"}
        assert names <= {"a", "b"} or names == {"pi", "inverse"}
    colours = {
        t["name"]: t["line"]["color"]
        for t in page.traces()
        if t["name"] in ("a", "b", "pi", "inverse") and "line" in t
    }
    assert colours == dict(zip(("a", "b", "pi", "inverse"), COMPARED))
    assert page.row("settings: controller")[1:] == ["pi", "–", "–", "inverse"]
    assert "Compared: " not in page_of(runs, "pi", "inverse").visible
    assert (
        "Closed loops"
        not in Page(comparison_page({"a": ordinary((0, 5, 2)), "b": ordinary((0, 6, 2))})).headings
    )


def test_loops_that_cannot_be_read_or_were_never_closed_do_not_cost_the_page(runs):
    """The run stopped on its way to the state: its mark is there, and no loop."""
    whole = runs["diagonal"]
    closed = next(e.t_s for e in whole.events if e.text == "loop closed")
    early = whole["t_s"] < closed
    stopped = replace(
        whole,
        columns={key: column[early] for key, column in whole.columns.items()},
        events=tuple(e for e in whole.events if e.t_s < closed),
    )
    dark = replace(whole, events=(Event(0.0, "info", "mark", "regulate", {"lower_K": None}),))
    page = page_of(runs, "diagonal", stopped=stopped, dark=dark)
    assert row_of(page, "stopped", "Transient / smallest")[5:] == ["–"] * 6
    assert "cannot be read: dark." in page.visible
    assert "No loop was closed" in Page(comparison_page({"a": stopped, "b": dark})).visible


def test_a_loop_in_another_unit_is_refused_like_any_run(runs):
    with pytest.raises(UsageError, match="Only runs in the same units"):
        comparison_page({"a": ordinary((0, 5, 2), unit="deg"), "pi": runs["pi"]})
