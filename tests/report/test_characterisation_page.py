"""The characterisation page holds the computed numbers in the documented order in one small file."""

import contextlib
import re
from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import plotly.graph_objects as go
import pytest

from report.pages import LOADING, Page, unpacked
from smarig.app.characterised_folder import characterised_folder
from smarig.cli import run as cli
from smarig.core.errors import UsageError
from smarig.identification.density_report import density_report
from smarig.report.characterisation_page import characterisation_page
from smarig.report.models.assessment import assessment
from smarig.report.models.evidence import training_run
from smarig.report.models.held_out_figures import loop_figure


@pytest.fixture(scope="module")
def evidence(characterised, tmp_path_factory):
    """What characterising the one-wire twin finds, in a folder with its files."""
    folder = tmp_path_factory.mktemp("one")
    characterised.copied(folder)
    with contextlib.chdir(folder):
        yield characterised.evidence()


@pytest.fixture(scope="module")
def text(evidence):
    return characterisation_page(evidence)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


DIAGNOSIS = "diagnosis/report.html"  # a separate page in the same folder


def test_it_loads_nothing(page, text):
    for name, attributes in page.tags:
        assert name not in ("link", "iframe", "object", "embed", "base", "img")
        for key in LOADING:
            assert attributes.get(key, "#").startswith("#") or attributes[key] == DIAGNOSIS
    style = text[text.index("<style>") : text.index("</style>")]
    assert "url(" not in style
    assert "@import" not in style


def test_the_sections_come_in_the_promised_order(page):
    words = (
        "Findings",
        "Wiping-out",
        "theorems",
        "First-order",
        "Weighting",
        "Validation",
    )
    places = [
        next(k for k, h in enumerate(page.headings) if word in h)
        for word in (*words, "Diagnosis", "Hysteresis", "Time series", "Rig", "Provenance")
    ]
    assert places == sorted(places)
    links = [a["href"] for name, a in page.tags if name == "a"]
    assert set(links) <= {"#" + a["id"] for _, a in page.tags if "id" in a} | {DIAGNOSIS}


def test_the_five_numbers(evidence, page):
    verification = evidence.verifications[evidence.chosen].runs[0]
    e = verification.settled
    assert f"{e.rms:.3g} mm" in page.card("Model error on held-out data")
    assert f"noise floor of the run {verification.noise_floor:.2g} mm" in page.card(
        "Model error on held-out data"
    )
    assert f"n = {e.n}" in page.card("Model error on held-out data")
    travel = max(np.ptp(run.points()[1]) for run in evidence.runs.values() if len(run.settled) > 1)
    assert f"{travel:.3g} mm" in page.card("Stroke")
    assert "not in MP" in page.card("Class of μ")  # one_e is known to have negative density (Table 5.2)
    hours = sum(run["t_s"][-1] - run["t_s"][0] for run in evidence.runs.values()) / 3600
    assert f"{hours:.2f} h" in page.card("Rig time")
    assert "65 FOD points on 10 curves" in page.card("Settled points")


def test_table_5_1_and_5_2(evidence, page):
    errors, classes = (t for t in page.tables if t[0][0] == "Surface")
    for name, found in evidence.identifications.items():
        row = next(r for r in errors if r[0].startswith(name))
        fit = found.model.fit
        assert [float(v) for v in row[1:4]] == pytest.approx(
            [fit["rms"], fit["norm2"], fit["weighted_norm2"]], rel=1e-3
        )
        assert float(row[4]) == pytest.approx(evidence.verifications[name].runs[0].settled.rms, rel=1e-2)
        low, high = evidence.choice.held_out_interval[name]
        assert row[5] == f"{evidence.choice.held_out_rms[name]:.3g} ({low:.3g}…{high:.3g})"
        assert row[6] == f"{100 * evidence.choice.negative_share[name]:.2f} %"
        category = next(r for r in classes if r[0] == name)
        assert category[2].startswith("yes" if found.density.M_P else "no")


def test_all_five_kinds_are_compared(evidence):
    kinds = ["constant", "parabolic", "exponential", "positive", "table"]
    assert list(evidence.identifications) == list(evidence.verifications) == kinds
    assert list(evidence.choice.held_out_rms) == kinds


def test_the_trade_off_has_one_mark_a_kind_and_positive_in_the_good_corner(evidence, page):
    title = "Negative part of μ (%)"
    by_curve, by_run = (
        p for p in page.plots if p["layout"].get("xaxis", {}).get("title", {}).get("text") == title
    )
    choice = evidence.choice
    for plot, rms in (
        (by_curve, choice.held_out_rms),
        (by_run, {n: v.runs[0].settled.rms for n, v in evidence.verifications.items()}),
    ):
        marks = {t["name"]: t for t in plot["data"] if t["name"] in rms}
        assert list(marks) == list(rms)
        for name, mark in marks.items():
            assert unpacked(mark["x"])[0] == pytest.approx(100 * choice.negative_share[name])
            assert unpacked(mark["y"])[0] == pytest.approx(rms[name])
            filled = mark["marker"]["symbol"] == "circle"
            assert filled == evidence.identifications[name].density.M_P
        left = [n for n in marks if unpacked(marks[n]["x"])[0] == 0]
        assert min(left, key=lambda n: rms[n]) == "positive"
        low, high = plot["layout"]["yaxis"]["range"]
        assert all(10**low < v < 10**high for v in rms.values())
    for mark in by_curve["data"][1:]:
        bar, value = mark["error_y"], unpacked(mark["y"])[0]
        ends = (value - bar["arrayminus"][0], value + bar["array"][0])
        assert ends == pytest.approx(choice.held_out_interval[mark["name"]])
    caption = next(c for c in page.captions if "one mark for each kind" in c)
    assert f"{choice.curves} curves, held out" in caption
    assert f"{evidence.verifications['positive'].runs[0].settled.n} points" in caption
    assert f"the smallest in MP is {choice.held_out_rms['positive']:.3g} mm (positive)" in caption


def test_the_summary_names_the_model_that_the_theorems_apply_to(evidence, page):
    at = page.visible.index("The exponential model is not in MP")
    words = page.visible[at : at + 700]
    rms, verification = evidence.choice.held_out_rms, evidence.verifications
    assert (
        "The positive model is in MP by construction, so the stability results of chapter 8 apply to that model"
        in words
    )
    assert "The positive model predicts less well" in words
    assert f"on held-out curves {rms['positive']:.3g} against {rms['exponential']:.3g} mm" in words
    run = {name: v.runs[0].settled.rms for name, v in verification.items()}
    assert f"on the held-out run {run['positive']:.3g} against {run['exponential']:.3g} mm" in words
    assert f"constant, has an error of {run['constant']:.3g} mm on the held-out run" in words
    assert "--surface positive" in words


@pytest.mark.long("takes two seconds")
def test_the_verdict_follows_the_errors(evidence):
    choice = evidence.choice
    even = replace(
        choice, held_out_rms=choice.held_out_rms | {"positive": choice.held_out_rms["exponential"]}
    )
    blind = replace(evidence, choice=even, verifications={})
    assert "The positive model predicts as well" in Page(characterisation_page(blind)).visible
    mixed = Page(characterisation_page(replace(evidence, choice=even))).visible
    assert "The positive model predicts less well on the held-out run only: " in mixed
    safe = Page(characterisation_page(replace(evidence, chosen="positive"))).visible
    assert "The positive model is in MP. The stability results of chapter 8 apply to it." in safe
    without = {n: f for n, f in evidence.identifications.items() if n != "positive"}
    bare = Page(characterisation_page(replace(evidence, identifications=without))).visible
    assert "The stability results of chapter 8 do not apply to it" in bare


def test_the_positive_model_shows_its_interval_around_its_curves(evidence, page):
    bands = page.traces("90 % interval")
    positive = evidence.identifications["positive"]
    assert len(bands) == positive.data.curves == 10
    for band in bands:
        u, y = unpacked(band["x"]), unpacked(band["y"])
        half = u.size // 2
        low, high = y[:half], y[half:][::-1]
        np.testing.assert_allclose(u[:half], u[half:][::-1], rtol=1e-6)
        assert np.all(low <= high)
        assert np.all(np.diff(low) >= 0)  # the curve of a positive measure never falls
        model = positive.model.hysteresis.y(u[:half].max(), u[:half])
        assert np.all((low <= model + 1e-5) & (model <= high + 1e-5))
    assert any("90 % intervals of a new reading" in c for c in page.captions)


def test_a_positive_measure_is_described_in_numbers(evidence, page):
    fit = evidence.identifications["positive"].positive
    assert page.row("Cells")[1:] == [str(fit.cells), f"{fit.at_zero} at the bound μ = 0"]
    assert page.row("Held-out rms")[1] == f"{fit.held_out.rms:.3g}"
    assert page.row("Effective parameters")[1] == f"{fit.freedom:.0f}"


def test_parameters_with_intervals(evidence, page):
    low, high = evidence.best.fit.intervals["x2"]
    table = next(t for t in page.tables if t[0][0] == "Parameter")
    assert table[1][0] == "x₂"
    within = (high - low) / 20  # two significant digits of the uncertainty
    assert float(table[1][1]) == pytest.approx(evidence.best.fit.values[0], abs=within)
    assert [float(v) for v in table[1][2].split(" to ")] == pytest.approx([low, high], abs=within)


def test_the_density_map_is_white_at_zero_and_marks_the_minimum(evidence, page):
    maps = {
        p["layout"]["title"]["text"]: p for p in page.plots if p["data"] and p["data"][0]["type"] == "heatmap"
    }
    assert list(maps) == list(evidence.identifications)
    for name, plot in maps.items():
        heat = plot["data"][0]
        assert heat["zmin"] == -heat["zmax"]
        d = density_report(evidence.identifications[name].model.hysteresis)
        cross = next(t for t in plot["data"] if t.get("name") == "minimum")
        assert (unpacked(cross["y"])[0], unpacked(cross["x"])[0]) == pytest.approx(d.mu_min_at)
        z = unpacked(heat["z"])
        assert np.nanmin(z) < 0 or d.M_P
        outlined = any(t["type"] == "contour" for t in plot["data"])
        assert outlined == (name != "table" and not d.M_P)


def test_the_residuals_drawn_are_measured_minus_model(evidence, page):
    verification = evidence.verifications[evidence.chosen].runs[0]
    drawn = [t for t in page.traces("measured − model") if unpacked(t["y"]).size == verification.input.size]
    drawn = [t for t in drawn if t["name"] == "measured − model"]
    assert len(drawn) == 2
    for trace in drawn:
        np.testing.assert_allclose(unpacked(trace["y"]), verification.measured - verification.predicted)
    np.testing.assert_allclose(unpacked(drawn[1]["x"]), verification.input)


def test_the_replayed_model_passes_the_measured_peaks(evidence, page):
    inputs, outputs = next(iter(evidence.of("first_order_descending"))).points()
    trace = next(t for t in page.traces("model, f exponential"))
    u, y = unpacked(trace["x"]), unpacked(trace["y"])
    np.testing.assert_allclose(u[::12], inputs, rtol=1e-5, atol=1e-4)
    assert np.abs(y[::12] - outputs).max() < 0.02  # a twentieth of what the constant surface misses


def test_every_plot_is_labelled_and_the_conditions_stand_once(page):
    assert len(page.captions) > 15
    assert all("n = " in caption and "one_wire_twin" not in caption for caption in page.captions)
    assert all(any(a["text"] == "TWIN" for a in plot["layout"]["annotations"]) for plot in page.plots)
    assert "Wire twin-one-wire, rig one_wire_twin, seed 0, ambient" in page.visible


def test_every_trace_and_layout_is_one_plotly_accepts(page):
    for plot in page.plots:
        plot["layout"].pop("narrow", None)
        go.Figure(plot["data"], plot["layout"])
        for trace in plot["data"]:
            if trace["type"] == "scatter":
                assert unpacked(trace["x"]).size < 3000


def test_provenance_names_every_run_with_its_hash(evidence, page):
    import hashlib

    for run in evidence.runs.values():
        assert page.row(run.path.name)[-1] == hashlib.sha256(run.path.read_bytes()).hexdigest()
    assert evidence.command in page.visible


def test_prop_4_6_is_stated_in_its_proved_direction_only(evidence, page):
    assert evidence.best.curves.cross
    assert "cross inside the major loop, so μ of the wire is negative" in page.visible
    curves = replace(evidence.best.curves, cross=False)
    best = replace(evidence.best, curves=curves)
    silent = replace(evidence, identifications={**evidence.identifications, evidence.chosen: best})
    assert "do not determine the sign of μ" in Page(characterisation_page(silent)).visible


def test_an_interrupted_run_is_announced_at_the_top(evidence):
    name, run = next(iter(evidence.runs.items()))
    cut = replace(run, meta={**run.meta, "end": {"cause": "hung up (SIGHUP)"}})
    page = Page(characterisation_page(replace(evidence, runs={**evidence.runs, name: cut})))
    assert page.visible.index("hung up (SIGHUP)") < page.visible.index("Model error on held-out data")


def test_what_people_typed_stays_text(evidence):
    evil = "<script>alert(1)</script>"
    text = characterisation_page(
        replace(evidence, title=evil, discoveries=(evil,), warnings=(evil,), command=evil)
    )
    assert evil not in text
    assert Page(text).visible.count(evil) >= 4


def test_a_campaign_without_a_model_or_validation_still_gives_a_page(evidence):
    bare = replace(evidence, identifications={}, verifications={}, representation=(), calibration=None)
    page = Page(characterisation_page(bare))
    assert "No model was identified" in page.visible
    assert "unknown" in page.card("Model error on held-out data")
    blind = Page(characterisation_page(replace(evidence, verifications={})))
    assert "No held-out run" in blind.visible


@pytest.mark.long("takes a second")
def test_the_folder_of_a_characterisation_gives_its_sheet(evidence, monkeypatch):
    """The analysis itself is that of ``characterise``; here, what it is given."""
    given = {}
    module = import_module("smarig.app.characterised_folder")
    monkeypatch.setattr(module, "analyse", lambda **found: given.update(found) or evidence)
    folder = next(iter(evidence.runs.values())).path.parents[1]
    (folder / "summary.html").unlink(missing_ok=True)
    assert cli(["report", str(folder), "--summary"]) == 0
    assert (given["rig"], given["options"], given["plan"].name) == (
        "one_wire_twin",
        " --seed 0",
        "characterise",
    )
    assert {name: run.path for name, run in given["runs"].items()} == {
        name: run.path for name, run in evidence.runs.items()
    }
    page = Page((folder / "summary.html").read_text(encoding="utf-8"))
    assert assessment(evidence).quality in page.visible
    assert page.tables[0][0] == ["Wire", "Load", "Measured", "Rig"]
    assert "Class of μ" not in page.visible
    assert page.tables[0][1][0] == "twin-one-wire"
    kelvin, degC = re.search(r"A_?s([\d.]+) Kabove ambient, ([\d.]+) °C; 95 %", page.card("As")).groups()
    assert float(degC) == pytest.approx(float(kelvin) + 22.0, abs=0.3)  # °C: the room of the twin
    assert (
        "No thermometer was on the wire: its temperature is computed from the measured current."
        in page.visible
    )
    assert re.match(r"Hysteresis width2\d(\.\d)? K95 %: ", page.card("Hysteresis width"))
    assert "Temperatures by tangents to 04_first_order_descending (heating assembled" in page.visible
    given.clear()
    assert cli(["report", str(folder), "--summary"]) == 0  # it is there: nothing is computed again
    assert not given
    assert cli(["report", str(folder), "--summary", "--force"]) == 0
    assert given


def test_the_first_figure_shows_what_the_extended_model_leaves(evidence):
    verification = evidence.verifications[evidence.chosen].runs[0]
    run = training_run(evidence)
    points = np.count_nonzero(verification.counted)
    settled = np.arange(2 * points) % 2 == 0
    gain = SimpleNamespace(settled=settled, extended_error=np.where(settled, 0.5, 9.0))
    for extended in (True, False):
        figure = loop_figure(replace(evidence, diagnosis=SimpleNamespace(extended=extended, gain=gain)), run)
        assert ("extended model of the diagnosis, rms 0.5 mm" in " ".join(figure.caption)) == extended


def test_the_errors_of_the_first_figure_go_over_time_where_they_drift(evidence):
    verification = evidence.verifications[evidence.chosen].runs[0]
    order = np.arange(verification.input.size)
    for added, over_time in ((0.05 * order, True), (0.3 * (order % 3), False), (0.0 * order, False)):
        changed = replace(verification, measured=verification.measured + added)
        one = replace(
            evidence, diagnosis=None, verifications={evidence.chosen: SimpleNamespace(runs=(changed,))}
        )
        figure = loop_figure(one, training_run(evidence))
        title = str(figure.panels[1].layout["xaxis"]["title"]["text"])
        assert title.startswith("Time since" if over_time else "Wire temperature")
        assert ("drawn over time" in " ".join(figure.caption)) == over_time


def test_runs_of_another_campaign_are_named(evidence, tmp_path):
    for name in ("report.html", "model.json", "runs"):
        (tmp_path / name).mkdir()
    with pytest.raises(UsageError, match="not those of the campaigns"):
        characterised_folder(tmp_path)
