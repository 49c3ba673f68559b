"""Figures are saved without touching pages, of one run and of a whole folder."""

import json

import pytest

from smarig.cli import run as cli
from smarig.report.components.figure import Figure, Panel
from smarig.report.drawing.saved_figures import figures_saved_in
from smarig.runner.session import Session


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("runs")
    with Session("one_wire_twin", seed=3) as session:
        session.run("validation", {"points": 2}, made / "a.run.sqlite")
        session.run("validation", {"points": 2}, made / "day 2" / "b.run.sqlite")
    return made


@pytest.mark.long("takes five seconds")
def test_a_page_that_is_there_does_not_hinder_its_figures(folder, tmp_path, capsys):
    page = folder / "a.html"
    assert cli(["report", str(folder / "a.run.sqlite")]) == 0
    page.write_text(page.read_text("utf-8") + "<!-- mine -->", encoding="utf-8")
    assert cli(["report", str(folder / "a.run.sqlite"), "--figures", str(tmp_path / "f")]) == 0
    assert "is left as it is" in capsys.readouterr().err
    assert "<!-- mine -->" in page.read_text("utf-8")
    assert {f.suffix for f in (tmp_path / "f").iterdir()} == {".svg", ".pdf"}
    named = ["report", str(folder / "a.run.sqlite"), "--figures", str(tmp_path / "g"), "-o", str(page)]
    assert cli(named) == 2  # a page that is named is wanted
    assert not (tmp_path / "g").exists(), "refused before anything was drawn"
    page.write_text("somebody else's", encoding="utf-8")
    assert cli(["report", str(folder / "a.run.sqlite"), "--figures", str(tmp_path / "h")]) == 2
    page.unlink()


@pytest.mark.long("takes five seconds")
def test_a_folder_gives_the_figures_of_each_page(folder, tmp_path, capsys):
    assert cli(["report", str(folder), "--figures", str(tmp_path / "f"), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["reports"]) == 2
    places = {f.parent.relative_to(tmp_path / "f").as_posix() for f in (tmp_path / "f").rglob("*.pdf")}
    assert places == {"a", "day 2/b"}


def test_a_sheet_is_of_a_run_or_a_characterisation(folder, capsys):
    assert cli(["report", str(folder), "--summary"]) == 2
    assert "holds no characterisation" in capsys.readouterr().err


@pytest.mark.long("takes two seconds")
def test_each_panel_is_named_after_what_it_shows(tmp_path):
    panels = [
        Panel([], {"xaxis": {"title": {"text": "Time (h)"}}, "yaxis": {"title": {"text": y}}})
        for y in ("Displacement (mm)", "Measured − model (mm)")
    ]
    figure = Figure(
        panels, "Measured loops and the model, which is a title of more than sixty letters.", [], ""
    )
    with figures_saved_in(tmp_path) as files:
        figure.html()
    stem = "01-measured-loops-and-the-model-which-is-a-title-of-more-than"
    assert {f.stem for f in files} == {f"{stem}--displacement", f"{stem}--measured-model"}
    same = Figure([panels[0], panels[0]], "Twice.", [], "")
    with figures_saved_in(tmp_path) as files:
        same.html()
    assert {f.stem for f in files} == {"01-twice--panel-1", "01-twice--panel-2"}
