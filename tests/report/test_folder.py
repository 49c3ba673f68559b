"""The index of a folder finds every run, stays small, and is renewed without touching other files."""

import os
import sqlite3

import numpy as np
import pytest

from report.pages import LOADING, Page, run_of, step
from smarig.core.errors import UsageError
from smarig.report.components.page import LIBRARY
from smarig.report.folder_report import report_folder
from smarig.report.index_page import IndexEntry, index_page
from smarig.report.runs.run_summary import shared_frames, summary_of
from smarig.runner.session import Session

INPUT = {"quantity": "temperature", "unit": "K"}
OUTPUT = {"quantity": "displacement", "unit": "mm"}


def loop(k=0, scale=1.0, **more):
    """A run of a loop in memory, 200 settled steps."""
    t = np.linspace(0, 2 * np.pi, 200)
    u, y = 50 - 50 * np.cos(t), scale * (5 - 5 * np.cos(t - 0.3)) + k
    steps = tuple(step(i, a, b) for i, (a, b) in enumerate(zip(u, y)))
    meta = {"source": "twin", "rig": "r", "wire": "w", "input": INPUT, "output": OUTPUT, "seed": k} | more
    return run_of({"t_s": np.arange(200.0), "position": y, "input": u}, steps, **meta)


@pytest.fixture
def folder(tmp_path):
    with Session("one_wire_twin", seed=3) as session:
        session.run("validation", {"points": 2}, tmp_path / "night" / "a b#1.run.sqlite", notes="<b>cold</b>")
        session.run("validation", {"points": 2}, tmp_path / "plain.run.sqlite")
    return tmp_path


def test_a_run_whose_description_is_damaged_is_named_and_the_others_are_there(folder):
    with sqlite3.connect(folder / "plain.run.sqlite") as db:
        db.execute("UPDATE run SET value = '1e300' WHERE key = 'start_epoch'")
    db.close()
    made = report_folder(folder)
    assert [page.report.name for page in made.pages] == ["a b#1.html"]
    assert [
        ("plain.run.sqlite" in s, "its key 'start_epoch' is not a date" in s) for s in made.unreadable
    ] == [(True, True)]
    assert "start_epoch" in Page(made.index.read_text(encoding="utf-8")).visible


def test_a_folder_gets_an_index_a_page_for_each_run_and_one_library(folder):
    (folder / "junk.run.sqlite").write_text("no run", encoding="utf-8")
    made = report_folder(folder)
    assert [page.report.relative_to(folder).as_posix() for page in made.pages] == [
        "night/a b#1.html",
        "plain.html",
    ]
    assert "junk.run.sqlite" in made.unreadable[0]
    text = made.index.read_text(encoding="utf-8")
    links = [
        attrs["href"] for name, attrs in Page(text).tags if name == "a" and not attrs["href"].startswith("#")
    ]
    assert set(links) == {"night/a%20b%231.html", "plain.html"}
    assert "junk.run.sqlite" in Page(text).visible
    assert "<b>cold</b>" not in text
    assert "plotly" not in text
    inner = made.pages[0].report.read_text(encoding="utf-8")
    assert len(inner) < 300_000
    assert f'data-library="../{LIBRARY}"' in inner
    assert (folder / LIBRARY).stat().st_size > 1_000_000


def test_pages_newer_than_their_run_are_left_alone_and_older_ones_renewed(folder):
    first = report_folder(folder)
    pages = [page.report for page in first.pages]
    for page in pages:
        os.utime(page, (2e9, 2e9))
    os.utime(folder / "plain.run.sqlite", (3e9, 3e9))
    report_folder(folder)
    assert pages[0].stat().st_mtime == 2e9
    assert pages[1].stat().st_mtime != 2e9
    report_folder(folder, force=True)
    assert pages[0].stat().st_mtime != 2e9


def test_somebody_elses_file_is_not_replaced_and_nothing_is_written(folder):
    (folder / "index.html").write_text("mine", encoding="utf-8")
    with pytest.raises(UsageError, match="not written by smarig"):
        report_folder(folder)
    assert not list(folder.rglob("*.js"))
    assert (folder / "index.html").read_text(encoding="utf-8") == "mine"
    report_folder(folder, force=True)
    assert "mine" not in (folder / "index.html").read_text(encoding="utf-8")


@pytest.mark.long("takes two seconds")
def test_hundreds_of_runs_stay_a_small_page_that_loads_nothing():
    entries = [IndexEntry(summary_of(loop(k)), f"{k}.html") for k in range(300)]
    text = index_page("many", entries)
    assert len(text.encode()) < 300 * 6_000
    page = Page(text)
    assert len(page.tables[0]) == 301
    for _, attributes in page.tags:
        for key in LOADING:
            value = attributes.get(key, "#")
            assert value.startswith("#") or value.endswith(".html")


def test_each_figure_has_its_title_and_the_twins_label():
    text = index_page(
        "one",
        [IndexEntry(summary_of(loop()), "a.html"), IndexEntry(summary_of(loop(1, source="bench")), "b.html")],
    )
    words = [attrs["aria-label"] for name, attrs in Page(text).tags if name == "svg"]
    assert words[0].startswith("TWIN, simulated. Hysteresis of validation: Displacement (mm) over 10 mm")
    assert words[1].startswith("Hysteresis")
    assert "1 of the 2 runs on this page come from a software simulation" in Page(text).visible
    assert text.count(">TWIN</text>") == 1


def test_runs_of_one_wire_are_drawn_to_one_scale_from_their_own_zero():
    small, large, other = (
        summary_of(loop(*given, **meta)) for given, meta in (((3, 0.5), {}), ((0,), {}), ((), {"wire": "v"}))
    )
    frames = shared_frames([small, large, other])
    assert frames[0].u == frames[1].u
    assert np.ptp(frames[0].y) == pytest.approx(10, rel=0.01) == np.ptp(frames[1].y)
    assert frames[0].y[0] == pytest.approx(3, abs=0.01)
    assert np.ptp(frames[2].y) == pytest.approx(10, rel=0.01)


def test_a_run_that_holds_nothing_is_listed_all_the_same():
    page = Page(index_page("empty", [IndexEntry(summary_of(run_of(end=None)), "e.html")]))
    assert "Nothing to draw." in page.visible
    assert "never closed" in page.visible


def test_a_wire_that_stays_cold_has_no_loop_to_draw():
    meta = {"source": "twin", "rig": "r", "wire": "w", "input": INPUT, "output": OUTPUT}
    cold = run_of({"t_s": np.arange(9.0), "position": np.tile([0, 0.01, 0], 3), "input": np.zeros(9)}, **meta)
    entries = [IndexEntry(summary_of(run), "x.html") for run in (cold, loop())]
    page = Page(index_page("made", entries))
    assert "No loop: input and output hardly change (ranges: input 0 K, output 0.01 mm)." in page.visible
    assert len([name for name, _ in page.tags if name == "svg"]) == 1
    alone = Page(index_page("alone", entries[:1]))  # on its own scale it is drawn
    assert "No loop" not in alone.visible


def test_wires_are_counted_only_where_runs_name_them():
    named, unnamed = summary_of(loop()), summary_of(loop(wire="", rig=""))

    def index(*runs):
        return Page(index_page("made", [IndexEntry(run, "x.html") for run in runs])).visible

    assert "distinct pairs" not in index(unnamed, unnamed)
    assert "Wires1distinct pairs of rig and wire; 1 run of unnamed wires" in index(named, named, unnamed)
