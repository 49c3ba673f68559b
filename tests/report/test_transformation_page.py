"""The page of transformation temperatures: its figures are those of the result, and the run page shows them too."""

import json

import numpy as np
import pytest

from report.pages import Page, unpacked
from smarig.cli import run as cli
from smarig.report import run_page, transformation_page
from smarig.report.transformation.transformation_tables import figures_of
from smarig.transformation import TEMPERATURES, transformation_temperatures
from transformation.known_loops import known_loop, run_of


def made(seed=1, cycles=4, **meta):
    loop = known_loop(seed, kind="ramp", noise=0.003, drift=0.0, cycles=cycles)
    return run_of(loop.u, loop.y, **meta)


def test_the_temperatures_are_marked_where_the_tangents_meet():
    found = transformation_temperatures(made())
    page = Page(transformation_page(found))
    cycle = found.runs[0].cycles[-1]
    for name in TEMPERATURES:
        (mark,) = page.traces(name)
        assert unpacked(mark["x"])[0] == pytest.approx(cycle.figures[name].value)
        low, high = cycle.figures[name].ci95
        x = unpacked(mark["x"])[0]
        assert (x - mark["error_x"]["arrayminus"][0], x + mark["error_x"]["array"][0]) == pytest.approx(
            (low, high)
        )
    for direction in ("heating", "cooling"):
        (tangents,) = page.traces(f"tangents, {direction}")
        ends = unpacked(tangents["x"]).reshape(3, 3)
        assert np.isnan(ends[:, 2]).all()
        assert ends[:, :2].min() >= -1e-9 + unpacked(page.traces(direction)[0]["x"]).min()
    assert "TWIN" not in page.visible


def test_the_page_opens_with_three_sentences_and_the_loop_before_any_table():
    found = transformation_temperatures(
        made(wire="W7", conditions={"stress": {"mean": 150.0, "unit": "MPa"}})
    )
    html = transformation_page(found)
    page = Page(html)
    assert "<h1>Transformation temperatures of W7, 150 MPa" in html
    body = html[html.index("<main") :]
    assert body.index("On heating") < body.index("<figure") < body.index("<table")
    opening = page.visible[page.visible.index("On heating") :][:300]
    for name in TEMPERATURES:
        assert f"{int(found.runs[0].means[name].value)}." in opening
    assert "the width of the hysteresis is" in opening


def test_reasons_of_missing_figures_and_unused_branches_are_on_the_page():
    loop = known_loop(1, kind="ramp", noise=0.003, drift=0.0)
    half = loop.u.size // 2
    cut = loop.truth["A_f"] + 2
    rows = np.concatenate([np.flatnonzero(loop.u[:half] < cut), half + np.flatnonzero(loop.u[half:] < cut)])
    page = Page(transformation_page(transformation_temperatures(run_of(loop.u[rows], loop.y[rows]))))
    assert "not given: the output has not levelled off" in page.visible


def test_a_run_page_has_the_temperatures_of_a_full_loop_only():
    whole = Page(run_page(made(protocol="cycles")))
    assert "Transformation temperatures" in whole.headings
    field = Page(run_page(made(protocol="cycles", unit="T", quantity="field")))
    assert "Transformation temperatures" not in field.headings


def test_a_run_page_has_the_caveats_of_its_temperatures():
    loop = known_loop(1, kind="ramp", noise=0.003, drift=0.0)
    middle = (loop.truth["A_s"] + loop.truth["A_f"]) / 2
    rows = np.flatnonzero(np.abs(loop.u - middle) > 4)
    run = run_of(loop.u[rows], loop.y[rows], protocol="cycles")
    notes = figures_of(run).notes
    assert any("of the output lies between two readings" in note for note in notes)
    page = Page(run_page(run))
    for note in notes:
        assert note in page.visible


def test_several_runs_get_the_stress_figure():
    runs = [
        made(k, 1, name=f"r{k}", conditions={"stress": {"mean": 50.0 * k, "unit": "MPa"}}) for k in (1, 4, 7)
    ]
    found = transformation_temperatures(runs)
    page = Page(transformation_page(found))
    assert "Stress dependence" in page.headings
    assert len(page.tables[-1]) == 1 + len(found.stress)


def test_the_command_writes_the_page_and_one_object(tmp_path, capsys):
    rows = known_loop(1, kind="ramp", noise=0.003, drift=0.0)
    text = "T,e\n" + "".join(f"{a:.4f},{b:.8f}\n" for a, b in zip(rows.u, rows.y))
    (tmp_path / "loop.csv").write_text(text)
    (tmp_path / "map.toml").write_text(
        'name = "map"\nsummary = "A loop."\nsource = "made"\n[columns]\n'
        'temperature_degC = { column = "T", unit = "degC" }\n'
        'position = { column = "e", unit = "mm/mm" }\n[input]\nchannel = "temperature_degC"\n'
        'quantity = "temperature"\nunit = "degC"\n[output]\nquantity = "strain"\nunit = "mm/mm"\n'
    )
    run, page = tmp_path / "loop.run.sqlite", tmp_path / "loop.html"
    imported = ["import", tmp_path / "loop.csv", "--format", "csv", "--map", tmp_path / "map.toml", "-o", run]
    assert cli([str(a) for a in imported]) == 0
    capsys.readouterr()
    assert cli(["transformation", str(run), "-o", str(page), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["report"] == str(page)
    for name, true in rows.truth.items():
        assert found["runs"][0]["figures"][name]["value"] == pytest.approx(true, abs=0.5)
        assert found["runs"][0]["figures"][name]["degC"] == found["runs"][0]["figures"][name]["value"]
    assert cli(["transformation", str(run), "-o", str(run), "--force"]) == 2
    capsys.readouterr()
    assert cli(["report", str(run), "-o", str(tmp_path / "r.html"), "--json"]) == 0
    headline = json.loads(capsys.readouterr().out)["transformation"]
    assert set(headline) == {"A_s", "A_f", "M_s", "M_f", "stroke", "width"}
