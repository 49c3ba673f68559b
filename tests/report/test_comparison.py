"""Comparison of runs, and of models on the same runs: offsets, errors and texts."""

import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import smarig
from report.pages import Page, run_of, step, unpacked
from smarig.core.errors import UsageError
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.record import load_run
from smarig.report.components.numbers import number
from smarig.report.model_comparison_page import models_page
from smarig.report.run_comparison_page import comparison_page
from smarig.report.runs.comparison_assessment import comparison_assessment
from smarig.report.runs.own_characterisation import _rms_with_zero_of, earlier_model_sentence
from smarig.report.runs.run_alignment import aligned, common_steps, run_change
from smarig.report.runs.run_family import family_figures
from smarig.report.transformation.transformation_tables import temperature_table
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session
from smarig.transformation import run_figures

INPUT = {"quantity": "temperature", "unit": "K"}
OUTPUT = {"quantity": "displacement", "unit": "mm"}
TARGETS = (0.0, 100.0, 20.0, 80.0)
WALKING = {"name": "walking", "parameters": {"percent_per_cycle": {"value": 0.6, "unit": "%/cycle"}}}


def made(positions, targets=TARGETS, **meta):
    steps = tuple(step(k, u, y) for k, (u, y) in enumerate(zip(targets, positions)))
    columns = {"t_s": np.arange(4.0), "input": np.array(targets[:4]), "position": np.array(positions[:4])}
    return run_of(columns, steps, **({"source": "bench", "input": INPUT, "output": OUTPUT} | meta))


def test_outputs_are_subtracted_only_while_the_steps_are_the_same():
    first = made((0, 5, 2, 4))
    assert common_steps(first, made((0, 5, 2, 4), (0.0, 100.0, 30.0, 80.0))) == 2
    assert common_steps(first, made((0, 5), (0.0, 100.0))) == 2
    assert common_steps(first, made((0, 5, 2, 4), (10.0, 100.0, 20.0, 80.0))) == 0


def test_a_shift_of_the_encoder_is_taken_out_and_a_change_of_shape_stays():
    each = aligned({"a": made((0, 5, 2, 4)), "b": made((1.5, 6.5, 3.5, 5.9))})[1]
    assert each.offset_kind == "fitted"
    assert each.offset == pytest.approx(-1.6)
    np.testing.assert_allclose(each.difference, [-0.1, -0.1, -0.1, 0.3], atol=1e-12)
    assert each.rms == pytest.approx(np.sqrt(0.03))


def test_runs_of_one_session_keep_their_zero():
    session_meta = {"start_epoch": 1e9, "encoder_zero": "power-up"}
    each = aligned({"a": made((0, 5, 2, 4), **session_meta), "b": made((1, 6, 3, 5), **session_meta)})[1]
    assert (each.offset, each.offset_kind) == (0.0, "known")
    np.testing.assert_allclose(each.difference, 1.0)


def test_two_days_that_began_in_one_state_keep_the_zero_of_their_power_up():
    days = [{"start_epoch": 1e9 * k, "encoder_zero": "power-up", "initial": "negative"} for k in (1, 2)]
    positions = ((0, 5, 2, 4), (0, 6, 3, 5))
    each = aligned({n: made(y, **day) for n, y, day in zip("ab", positions, days)})[1]
    assert (each.offset, each.offset_kind) == (0.0, "power-up")
    np.testing.assert_allclose(each.difference, [0, 1, 1, 1])
    for changed in ({"initial": "continued"}, {"source": "import"}, {"encoder_zero": "zeroed at 5 s"}):
        other = made((0, 6, 3, 5), **(days[1] | changed))
        assert aligned({"a": made((0, 5, 2, 4), **days[0]), "b": other})[1].offset_kind == "fitted"


COLD = {
    "encoder_zero": "zeroed at 67.7 s",
    "initial": "continued",
    "actuator_text": 'arrangement = "one_wire"',
}


def zeroed_cold(positions, day, **meta):
    output = OUTPUT | {"per_count": 0.05}
    return made(positions, **(COLD | {"start_epoch": 1e9 * day, "output": output} | meta))


@pytest.mark.parametrize(
    ("positions", "offset", "kind"),
    [
        ((0.06, 5.06, 2.06, 4.06), -0.06, "fitted"),  # within two counts of 0.05 mm: rounding of the zero
        ((0.0, 4.5, 1.5, 3.5), 0.0, "cold"),  # slack: the cold end stays where it was zeroed
        ((0.0, 5.5, 2.5, 4.5), 0.0, "cold"),
    ],
)
def test_the_zero_of_a_cold_wire_takes_up_no_change_of_the_loop(positions, offset, kind):
    runs = {"a": zeroed_cold((0, 5, 2, 4), 1), "b": zeroed_cold(positions, 2)}
    each = aligned(runs)[1]
    assert (each.offset, each.offset_kind) == (pytest.approx(offset), kind)
    assert ("Zeroed cold by initialise" in Page(comparison_page(runs)).visible) == (kind == "cold")


@pytest.mark.parametrize(
    "meta",
    [
        {"actuator_text": 'arrangement = "two_wire"'},  # its initial state varies
        {"actuator_text": "["},
        {"source": "import"},
        {"output": OUTPUT},
        {"encoder_zero": "power-up"},
    ],
)
def test_a_zero_that_may_be_of_another_state_is_fitted_freely(meta):
    runs = {"a": zeroed_cold((0, 5, 2, 4), 1), "b": zeroed_cold((0.0, 4.5, 1.5, 3.5), 2, **meta)}
    each = aligned(runs)[1]
    assert (each.offset, each.offset_kind) == (pytest.approx(0.375), "fitted")


def test_runs_with_nothing_in_common_are_drawn_but_not_subtracted():
    page = Page(comparison_page({"a": made((0, 5, 2, 4)), "b": made((1, 6, 3, 5), (9.0, 8.0, 7.0, 6.0))}))
    assert "not subtracted" in page.visible
    assert "no step is common with the first run: b" in page.visible
    assert not page.traces("difference")


def test_what_differs_is_listed_and_what_does_not_is_not():
    runs = {
        "a": made((0, 5, 2, 4), seed=1, effects=[]),
        "b": made((0, 5, 2, 4), seed=1, effects=["walking(1)"]),
    }
    page = Page(comparison_page(runs))
    assert page.row("effects")[1:] == ["none", "walking(1)"]
    assert not [row for table in page.tables for row in table if row[0] == "seed"]


def test_a_twin_compared_with_a_bench_is_named_in_the_banner():
    text = comparison_page({"a": made((0, 5, 2, 4)), "b": made((0, 5, 2, 4), source="twin")})
    assert "TWIN: 1 of the 2 runs" in Page(text).visible
    assert "TWIN" not in Page(comparison_page({"a": made((0, 5, 2, 4)), "b": made((0, 5, 2, 4))})).visible


def test_what_cannot_be_compared_is_refused_in_a_sentence():
    other = made((0, 5, 2, 4), output={"quantity": "angle", "unit": "deg"})
    with pytest.raises(UsageError, match="Only runs in the same units"):
        comparison_page({"a": made((0, 5, 2, 4)), "b": other})
    with pytest.raises(UsageError, match="at most 60"):
        comparison_page({str(k): made((0, 5, 2, 4)) for k in range(61)})


# --- the first screen -----------------------------------------------------------------------------------

INPUTS = np.concatenate([np.linspace(0, 100, 21), np.linspace(95, 0, 20), np.linspace(5, 100, 20)])


def curve(u):
    """A smooth loop without memory, in mm over K."""
    return 6 * (1 + np.tanh((u - 45) / 15))


def day(shift=0.0, gain=1.0, noise=0.003, seed=0, **meta):
    """A run of the same steps, with the input shifted by ``shift`` K and the output scaled."""
    random = np.random.default_rng(seed)
    y = gain * curve(INPUTS - shift) + noise * random.standard_normal(INPUTS.size)
    steps = tuple(step(k, float(u), float(v)) for k, (u, v) in enumerate(zip(INPUTS, y)))
    columns = {"t_s": np.arange(INPUTS.size, dtype=float), "input": INPUTS, "position": y}
    return run_of(
        columns, steps, **({"source": "bench", "wire": "w", "input": INPUT, "output": OUTPUT} | meta)
    )


def change_of(other, first=None):
    reference, found = aligned({"a": first or day(), "b": other})
    return run_change(reference, replace(found, noise=0.003 * np.sqrt(2)))


def test_a_shift_of_the_input_is_told_as_one():
    change = change_of(day(shift=2.0, seed=1))
    assert change.level == "poor"
    assert change.is_shift
    assert not change.is_gain_change
    assert change.shift[0] == pytest.approx(2.0, abs=0.15)
    assert change.explained > 0.95


def test_a_change_of_the_stroke_is_told_as_one():
    change = change_of(day(gain=0.96, seed=1))
    assert change.is_gain_change
    assert not change.is_shift
    assert change.gain[0] == pytest.approx(-0.04, abs=0.003)


def test_the_same_wire_on_another_day_has_not_changed():
    change = change_of(day(seed=2))
    assert change.level == "good"
    assert not change.is_shift
    assert not change.is_gain_change


@pytest.mark.parametrize(
    ("other", "words", "level"),
    [
        (day(seed=2), "A model of one of these runs holds for the other.", "good"),
        (day(shift=2.0, seed=2), "a shift of the input by +", "bad"),
        (day(gain=0.9, seed=2), "a change of the output by −", "bad"),
    ],
)
def test_the_advice_follows_the_change(other, words, level):
    reference, found = aligned({"a": day(), "b": other})
    found = replace(found, noise=0.0042)
    family = family_figures([reference.run, found.run])
    assessed = comparison_assessment([reference, found], family)
    assert words in assessed.advice
    assert assessed.level == level


def test_a_cause_that_explains_a_part_is_told_as_a_part(tmp_path):
    """A shifted input and a floor: the shift explains more than half of the square, and not all of it."""
    shifted, slack = day(shift=2.0), 0.9
    y = np.maximum(shifted.points()[1], slack)
    steps = tuple(step(k, float(u), float(v)) for k, (u, v) in enumerate(zip(INPUTS, y)))
    other = replace(shifted, steps=steps)
    days = {"a": day(), "b": replace(other, path=tmp_path / "b" / "runs" / "04_fod.run.sqlite")}
    reference, found = aligned(days)
    change = run_change(reference, found)
    assert 0.5 < change.explained < 0.9
    found = replace(found, noise=0.0042)

    def advised():
        return comparison_assessment([reference, found], family_figures([reference.run, found.run])).advice

    advice = advised()
    assert "A part of the difference looks like a shift of the input" in advice
    assert f"{100 * change.explained:.0f} % of its square. The rest has another cause." in advice
    assert "The difference is that of" not in advice
    assert "diagnose all runs of the later day" in advice
    for path, about in (
        ("a", {"verdict": "silent"}),
        ("b", {"verdict": "named", "set": ["walking"], "effects": [WALKING]}),
    ):
        place = tmp_path / path / "diagnosis" / "diagnosis.json"
        place.parent.mkdir(parents=True)
        place.write_text(json.dumps(about), encoding="utf-8")
    reference = replace(
        reference, run=replace(reference.run, path=tmp_path / "a" / "runs" / "04_fod.run.sqlite")
    )
    assert advised().startswith("What their own diagnoses found: a: nothing; b: walking"), (
        "a cause, not half a reason"
    )


def test_effects_that_the_records_of_twins_state_are_told_if_they_differ():
    plain, walked = day(), day(shift=5.0, effects=["walking(percent_per_cycle=0.3)"])
    assert plain.name == walked.name, "the same file in two folders"

    def assessed(**runs):
        found = aligned(runs)
        return comparison_assessment(found, family_figures([each.run for each in found]))

    found = assessed(monday=plain, tuesday=walked)
    assert "monday: none; tuesday: walking(percent_per_cycle=0.3)" in found.advice
    assert "tuesday" in found.measured
    assert "walking" not in assessed(monday=walked, tuesday=walked).advice


@pytest.mark.parametrize(
    ("stored", "told"),
    [
        (
            {"verdict": "named", "set": ["walking"], "effects": [WALKING]},
            "tuesday: walking (rate 0.6 %/cycle). Against walking",
        ),
        ({"verdict": "ambiguous", "set": ["creep", "walking"]}, "tuesday: one of creep, walking."),
        (
            {"verdict": "unknown", "depends_on": "time"},
            "tuesday: errors without a known cause, which vary with time.",
        ),
        ({"verdict": "silent"}, ""),
        ("no JSON", ""),
        ("[" * 100_000, ""),
        ({"verdict": "named", "set": 5, "effects": 5}, "tuesday: errors without a known cause."),
        ({"verdict": "ambiguous", "set": 5}, "tuesday: errors without a known cause."),
        ({"verdict": "unknown", "effects": True, "depends_on": 7}, "which vary with 7."),
        ({"verdict": "named", "set": ["\ud800"], "effects": [{"name": "\ud800"}]}, "tuesday: \\ud800."),
        (
            {"verdict": "named", "effects": [{"name": "creep", "parameters": {"rate": {"value": 10**400}}}]},
            "tuesday: creep (rate unknown).",
        ),
    ],
)
def test_campaigns_are_compared_with_what_their_own_diagnoses_found(tmp_path, stored, told):
    days = {"monday": {"verdict": "silent"}, "tuesday": stored}
    runs = {}
    for name, about in days.items():
        place = tmp_path / name / "diagnosis" / "diagnosis.json"
        place.parent.mkdir(parents=True)
        place.write_text(about if isinstance(about, str) else json.dumps(about), encoding="utf-8")
        run = day(gain=0.9 if name == "tuesday" else 1.0, seed=len(name))
        runs[name] = replace(run, path=tmp_path / name / "runs" / "04_fod.run.sqlite")
    found = aligned(runs)
    advice = comparison_assessment(found, family_figures([each.run for each in found])).advice
    assert ("What their own diagnoses found: monday: nothing" in advice) == bool(told)
    assert told in advice


def test_the_page_opens_with_the_sentences():
    text = Page(
        comparison_page({"mon": day(start_epoch=1.7e9), "tue": day(shift=3, seed=1, start_epoch=1.70009e9)})
    ).visible
    assert text.index("Compared: ") < text.index("Hysteresis of the runs, overlaid")
    assert "2023-11-14" in text


def test_runs_of_several_loads_are_a_family_over_stress():
    runs = {
        f"r{k}": day(gain=1 + 0.1 * k, seed=k, conditions={"stress": {"mean": 50.0 * k, "unit": "MPa"}})
        for k in (3, 1, 2)
    }
    page = Page(comparison_page(runs))
    assert "from 50 MPa to 150 MPa of stress" in page.visible
    trend = next(p for p in page.plots if p["layout"]["xaxis"]["title"]["text"] == "Stress (MPa)")
    x, y = (unpacked(trend["data"][0][key]) for key in "xy")
    np.testing.assert_allclose(x, [50, 100, 150])
    assert np.all(np.diff(y) > 0.5)


@pytest.mark.long("takes a second")
def test_twelve_days_are_drawn_as_one_family():
    runs = {f"d{k}": day(shift=0.5 * k, seed=k, start_epoch=1.7e9 + 86400 * k) for k in range(12)}
    page = Page(comparison_page(runs))
    assert "0 days to 11 days" in page.visible
    drawn = {t["line"]["color"] for t in page.plots[0]["data"] if t["mode"] == "lines"}
    assert len(drawn) == 12


@pytest.fixture(scope="module")
def wire(tmp_path_factory):
    """Curves, a held-out run, and a run of a wire with the effect walking."""
    folder = tmp_path_factory.mktemp("wire")
    with Session("one_wire_twin", seed=3) as session:
        curves = {"partition_K": (0, 50, 70, 90, 110, 160)}
        session.run("first_order_descending", curves, folder / "c.run.sqlite")
        session.run("validation", {"points": 6}, folder / "v.run.sqlite")
    with Session(
        "one_wire_twin", twin=TwinSettings(seed=3, effects=effects_from_pairs(["walking=2"]))
    ) as session:
        session.run("validation", {"points": 6}, folder / "w.run.sqlite")
    return {name: load_run(folder / f"{name}.run.sqlite") for name in "cvw"}


@pytest.mark.long("takes two seconds")
def test_a_zero_walk_exceeds_the_noise(wire):
    found = aligned({"v": wire["v"], "w": wire["w"]})[1]
    assert found.difference.size == len(wire["v"].settled)
    assert found.noise
    assert found.rms > 10 * found.noise


def test_models_are_compared_on_the_same_points_and_drawn_on_one_scale(wire):
    models = {name: smarig.identify(wire["c"], name).model for name in ("constant", "exponential")}
    page = Page(models_page(models, {"v": wire["v"], "w": wire["w"]}))
    rms = {name: float(page.row(f"{name} on v")[2]) for name in models}
    assert rms["exponential"] < rms["constant"]
    drawn = page.traces("exponential")
    inputs = wire["v"].points()[0]
    errors = [
        t for t in drawn if unpacked(t["x"]).size == inputs.size and np.allclose(unpacked(t["x"]), inputs)
    ]
    assert np.sqrt(np.mean(unpacked(errors[0]["y"]) ** 2)) == pytest.approx(rms["exponential"], rel=0.01)
    maps = [trace for trace in page.traces() if trace["type"] == "heatmap"]
    tops = {(trace["zmax"], trace["colorbar"]["title"]["text"]) for trace in maps}
    assert len(maps) == 2
    assert len(tops) == 1
    assert page.row("exponential on all runs")[1] == str(sum(len(wire[k].settled) for k in "vw"))


def test_the_page_of_models_opens_with_the_verdict_on_each(wire):
    models = {name: smarig.identify(wire["c"], name).model for name in ("constant", "exponential")}
    both = Page(models_page(models, {"v": wire["v"]})).visible
    for name in models:
        (one,) = smarig.verify(models[name], [wire["v"]]).runs
        sentence = f"{name} on v: {number(one.settled.rms)} mm rms, {one.verdict.text}."
        assert sentence in both
        assert both.index(sentence) < both.index("Errors (measured")
        alone = Page(models_page({name: models[name]}, {"v": wire["v"]})).visible
        assert sentence in alone
        assert f"Model {name}" in alone


def test_an_offset_fitted_to_a_step_or_two_shows_no_agreement():
    """With one common step, the difference is zero by itself."""
    for common in (1, 2, 3):
        other = made((0, 9, 7, 1), (*TARGETS[:common], *(k + 0.5 for k in TARGETS[common:])))
        found = aligned({"a": made((0, 5, 2, 4)), "b": other})
        assert (found[1].difference.size, found[1].offset_kind) == (common, "fitted")
        assessed = comparison_assessment(found, family_figures([each.run for each in found]))
        assert ("in common" in assessed.quality) == (common < 3)
        assert assessed.level != "good"


def test_one_step_of_two_runs_with_one_zero_shows_no_change():
    """Two protocols of one session, which begin with the same step."""
    same = {"encoder_zero": "power-up", "initial": "negative"}
    other = made((0.5, 9, 7, 1), (TARGETS[0], *(k + 0.5 for k in TARGETS[1:])), **same)
    found = aligned({"a": made((0, 5, 2, 4), **same), "b": other})
    assert (found[1].difference.size, found[1].offset_kind) == (1, "power-up")
    assessed = comparison_assessment(found, family_figures([each.run for each in found]))
    assert "only 1 step in common" in assessed.quality


@pytest.mark.long("takes three seconds")
def test_the_model_of_the_first_day_is_tried_on_the_other(tmp_path):
    """A wire that became slack overnight."""
    runs, levels = {}, {"partition_K": (0, 50, 80, 160)}
    for name, effects in (("monday", ()), ("tuesday", effects_from_pairs(["slack=10"]))):
        file = tmp_path / name / "runs" / "04.run.sqlite"
        file.parent.mkdir(parents=True)
        with Session("one_wire_twin", twin=TwinSettings(seed=len(name), effects=effects)) as session:
            runs[name] = load_run(session.run("first_order_descending", levels, file))
    first, other = aligned(runs)
    assert earlier_model_sentence(first, other) == ""
    model = smarig.identify(runs["monday"], "exponential").model
    model.save(tmp_path / "monday" / "model.json")
    own, found = (smarig.verify(model, [runs[day]]).runs[0] for day in ("monday", "tuesday"))
    assert other.offset_kind != "fitted"
    rms = np.hypot(found.settled.rms, found.offset - own.offset)
    assert rms > 5 * own.settled.rms
    sentence = f"predicts tuesday to {rms:.3g} mm rms; on monday its error is {own.settled.rms:.3g} mm."
    assert earlier_model_sentence(first, other) == f"The model of monday {sentence}"
    free = replace(other, offset_kind="fitted")
    assert f"to {found.settled.rms:.3g} mm rms, with its zero fitted;" in earlier_model_sentence(first, free)
    advice = comparison_assessment([first, other], family_figures(list(runs.values()))).advice
    assert sentence in advice
    (tmp_path / "monday" / "model.json").write_text("{}", encoding="utf-8")
    assert earlier_model_sentence(first, other) == ""


def test_a_fitted_zero_of_the_other_day_is_taken_out_again():
    """Errors of −0.1 about a fitted zero of 0.5 are 0.2 from the zero of the first day, 0.2."""
    counted = np.array([True, True, False])
    own: Any = SimpleNamespace(offset=0.2)
    found: Any = SimpleNamespace(
        measured=np.array([1.0, 2.0, 9.0]),
        predicted=np.array([1.1, 2.1, np.nan]),
        offset=0.5,
        counted=counted,
    )
    assert _rms_with_zero_of(own, found) == pytest.approx(0.2)


def test_transformation_temperatures_of_both_days_stand_side_by_side():
    def loop(shift_K):
        u = np.concatenate([np.linspace(20, 110, 90), np.linspace(110, 20, 90)])
        y = 6 * (1 + np.tanh((u - np.repeat((70.0, 50.0), 90) - shift_K) / 8))
        columns = {"t_s": np.arange(180.0), "input": u, "position": y}
        about = {"source": "import", "input": INPUT | {"unit": "degC"}, "output": OUTPUT}
        return run_of(columns, (), **about)

    runs = {"monday": loop(0.0), "tuesday": loop(3.0), "cold": made((0, 5, 2, 4))}
    found = temperature_table(runs)
    assert found is not None
    (shown,) = Page(str(found)).tables
    assert shown[0] == ["Quantity", "monday", "tuesday"]
    before, after = (run_figures(runs[day]).means["M_s"].value for day in ("monday", "tuesday"))
    (row,) = [row for row in shown if row[0] == "Ms"]
    assert [float(cell.split(" ")[0]) for cell in row[1:]] == pytest.approx([before, after], abs=0.06)
    assert all(" °C (" in cell for cell in row[1:])
    assert temperature_table({"cold": runs["cold"]}) is None
    assert temperature_table({f"{k}": runs["monday"] for k in range(7)}) is None
