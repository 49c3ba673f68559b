"""The index lists pages of results and models, with loops read as numbers and never as markup."""

import numpy as np
import pytest

from report.pages import Page
from report.test_folder import loop
from smarig.identification import identify
from smarig.record import load_run
from smarig.report import comparison_page, write_page
from smarig.report.components.html import paragraph
from smarig.report.components.page import Section, page
from smarig.report.components.page_summary import PageSummary, found_page
from smarig.report.folder_report import report_folder
from smarig.report.runs.run_summary import summary_of
from smarig.runner.session import Session

HOSTILE = "<script>alert(1)</script>"


def written(path, summary, title="A title"):
    path.write_text(
        page(title, "lead", [Section("One", "One", [paragraph("text")])], summary=summary), "utf-8"
    )
    return path


def test_a_summary_comes_back_as_it_was_written(tmp_path):
    u, y = np.linspace(0, 1, 5), np.array([0.0, 1.0, 4.0, 2.0, 0.5])
    summary = PageSummary("diagnosis", 'Found "it": 5 < 6 & 7', "bad", u, y, ("K", "mm"), "TWIN")
    found = found_page(written(tmp_path / "x.html", summary))
    assert (found.title, found.summary.kind, found.summary.level) == ("A title", "diagnosis", "bad")
    assert found.summary.sentence == 'Found "it": 5 < 6 & 7'
    assert (found.summary.units, found.summary.label) == (("K", "mm"), "TWIN")
    np.testing.assert_allclose(found.summary.u, u, rtol=1e-4)
    np.testing.assert_allclose(found.summary.y, y, rtol=1e-4)


@pytest.mark.parametrize(
    "text", ["", "no page", '<meta name="smarig-kind" content="run">', "<title>x</title>", "\0\xff" * 50]
)
def test_other_files_are_no_pages(tmp_path, text):
    (tmp_path / "x.html").write_text(text, encoding="utf-8")
    assert found_page(tmp_path / "x.html") is None
    assert found_page(tmp_path) is None


@pytest.mark.parametrize("numbers", ["1,2 3", "1,2 x,y", "nan,1 2,3", "1,2", HOSTILE, "1,2,3 4,5,6"])
def test_a_damaged_loop_is_left_out(tmp_path, numbers):
    summary = PageSummary("study", "words", "good", np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    file = written(tmp_path / "x.html", summary)
    file.write_text(file.read_text("utf-8").replace("1,3 2,4", numbers), "utf-8")
    assert found_page(file).summary.u.size == 0


def test_a_hostile_page_puts_no_markup_into_the_index(tmp_path):
    summary = PageSummary(
        HOSTILE, HOSTILE, "bad", np.array([0.0, 1.0]), np.array([0.0, 1.0]), (HOSTILE, HOSTILE), HOSTILE
    )
    written(tmp_path / "x.html", summary, HOSTILE)
    (tmp_path / "r").mkdir()
    with Session("one_wire_twin", seed=3) as session:
        session.run("initialise", {}, tmp_path / "r" / "a.run.sqlite")
    text = report_folder(tmp_path).index.read_text("utf-8")
    assert "<script>alert" not in text
    assert HOSTILE in Page(text).visible


@pytest.mark.long("takes three seconds")
def test_pages_and_models_are_listed_the_most_serious_first(tmp_path):
    with Session("one_wire_twin", seed=3) as session:
        curves = {"partition_K": (0, 50, 70, 90, 110, 160)}
        run = session.run("first_order_descending", curves, tmp_path / "curves.run.sqlite")
    identify(load_run(run), "exponential").model.save(tmp_path / "wire.model.json")
    (tmp_path / "broken.model.json").write_text("{", "utf-8")
    written(tmp_path / "fine.html", PageSummary("characterisation", "All is well.", "good"), "Fine")
    written(tmp_path / "poor.html", PageSummary("diagnosis", "Something acts.", "bad"), "Poor")
    write_page(comparison_page({"a": loop(), "b": loop(1)}), tmp_path / "two.html")
    made = report_folder(tmp_path)
    index = Page(made.index.read_text("utf-8"))
    places = [
        index.visible.index(words)
        for words in ("Something acts.", "All is well.", "it was fitted to", "curves")
    ]
    assert places == sorted(places)
    assert "comparison of runs" in index.visible
    assert any("broken.model.json" in sentence for sentence in made.unreadable)
    links = {attrs["href"] for name, attrs in index.tags if name == "a"}
    assert {"poor.html", "fine.html", "two.html", "wire.model.json", "curves.html"} <= links


def test_a_drawing_follows_the_samples_and_not_the_chords(tmp_path):
    with Session("one_wire_twin", seed=3) as session:
        run = load_run(session.run("validation", {"points": 4}, tmp_path / "v.run.sqlite"))
    drawn = summary_of(run)
    true_u, true_y = run["input"], run["position"]
    known = np.isfinite(true_u) & np.isfinite(true_y)
    spread = np.ptp(true_y[known]), np.ptp(true_u[known])
    points = np.column_stack([true_u[known] / spread[1], true_y[known] / spread[0]])[::25]
    path = np.column_stack([drawn.u / spread[1], drawn.y / spread[0]])
    ends = path[:-1, None], path[1:, None]
    along = ends[1] - ends[0]
    share = np.clip(((points - ends[0]) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-12), 0, 1)
    gaps = np.linalg.norm(points - ends[0] - share[..., None] * along, axis=-1).min(axis=0)
    assert gaps.max() < 0.02
    assert drawn.u.size <= 400
