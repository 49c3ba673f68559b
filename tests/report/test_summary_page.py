"""The first sentences of a run, and the one-sheet summary: built from the figures, and one sheet on paper."""

from dataclasses import replace

import numpy as np
import pytest

import smarig
from report.pages import Page, run_of, step
from smarig.identification import verify
from smarig.record import Event, load_run
from smarig.report.components.numbers import number, signed
from smarig.report.run_page import run_cards
from smarig.report.runs.run_assessment import run_assessment
from smarig.report.runs.run_tables import quality_table
from smarig.report.summary_page import summary_page
from smarig.runner.session import Session

INPUT, OUTPUT = {"quantity": "temperature", "unit": "K"}, {"quantity": "displacement", "unit": "mm"}


def made(verdicts=("settled",) * 4, end="done", events=(), protocol="validation", **meta):
    targets, outputs = (0.0, 90.0, 20.0, 80.0), (0.0, 12.0, 3.0, 11.0)
    steps = tuple(step(k, u, y, v) for k, (u, y, v) in enumerate(zip(targets, outputs, verdicts)))
    columns = {"t_s": np.arange(4.0) * 60, "input": np.array(targets), "position": np.array(outputs)}
    meta = {"source": "bench", "input": INPUT, "output": OUTPUT, "protocol": protocol} | meta
    return run_of(columns, steps, tuple(events), end=end, **meta)


@pytest.mark.parametrize(
    ("run", "words", "level"),
    [
        (made(), "The run ended as planned and all 4 holds settled.", "good"),
        (
            made(("settled", "timed_out", "settled", "settled")),
            "Of 4 holds, 1 did not settle in time; no point of theirs is used.",
            "warning",
        ),
        (
            made(("settled", "interrupted", "timed_out", "settled")),
            "Of 4 holds, 1 did not settle in time and 1 was interrupted; ",
            "warning",
        ),
        (
            made(("settled", "interrupted", "settled", "settled")),
            "Of 4 holds, 1 was interrupted; ",
            "warning",
        ),
        (made(end="Too hot."), "The run is incomplete: Too hot.", "bad"),
        (made(end=None), "The run is incomplete: ", "bad"),
        (made(warnings=["one", "two"]), "2 remarks", "warning"),
        (run_of(), "The run has no samples.", "bad"),
    ],
)
def test_the_record_is_judged_by_its_figures(run, words, level):
    found = run_assessment(run)
    assert words in found.quality
    assert found.level == level
    assert ("Resume the run" in found.advice) == (level == "bad" and run.cause != "done")
    assert ("Repeat the run" in found.advice) == (level == "bad" and run.cause == "done")


def test_a_severe_event_is_told_first():
    event = Event(3.0, "warning", "still_on", "It may still heat.", {})
    assert run_assessment(made(events=[event])).level == "bad"


def test_lost_samples_are_told_and_spoil_no_hold():
    run = made(events=[Event(3.0, "warning", "lost", "7 samples were lost.", {})])
    found = run_assessment(run)
    assert (found.level, found.quality) == ("warning", "Samples are marked or missing; see Data quality.")
    assert "Repeat" not in found.advice
    assert "some are marked or missing" in str(run_cards(run))
    (table,) = Page(str(quality_table({"a": run}))).tables
    assert dict(zip(table[0], table[1]))["Gaps"] == "1"
    assert "Gaps" not in str(quality_table({"a": made()}))


def test_travel_and_range_are_those_of_the_record():
    assert "a travel of 12 mm over 90 K; 4 settled points, 3.0 min" in run_assessment(made()).measured


@pytest.fixture(scope="module")
def wire(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wire")
    with Session("one_wire_twin", seed=3) as session:
        curves = {"partition_K": (0, 50, 70, 90, 110, 160)}
        run = load_run(session.run("first_order_descending", curves, folder / "c.run.sqlite"))
    return run, smarig.identify(run, "exponential").model


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "0.004-good-can be used",
        "0.5-bad-diagnose",
    ),
)
@pytest.mark.parametrize(
    ("rms", "level", "advice"), [(0.004, "good", "can be used"), (0.5, "bad", "diagnose")]
)
def test_a_model_is_judged_against_the_noise(wire, rms, level, advice):
    run, model = wire
    verified = verify(model, [run]).runs[0]
    assert verified.is_training
    other = replace(
        verified, is_training=False, settled=replace(verified.settled, rms=rms), noise_floor=0.004
    )
    found = run_assessment(run, other, "m")
    assert found.level == level
    assert advice in found.advice
    error = verified.measured - verified.predicted
    k = int(np.nanargmax(np.abs(error)))
    at = f"at {number(verified.input[k])} K (point {k + 1} of {error.size})"
    place = f"The largest error is {signed(error[k])} mm, {at}."
    assert (place in found.advice) == (level == "bad")
    assert f"predicts this run to {rms:.3g} mm rms" in found.quality
    fitted = run_assessment(run, replace(other, is_training=True), "m")
    assert "was fitted to this run; the error of the fit is" in fitted.quality
    assert "predict" not in fitted.quality
    assert ("That is no prediction" in fitted.advice) == (level == "good")


def test_the_summary_holds_sentences_loops_figures_and_origin(wire):
    run, model = wire
    page = Page(summary_page(run, model))
    assert len(page.plots) == 2
    assert "was fitted to this run" in page.visible
    assert page.card("Error, rms")
    assert "c.run.sqlite, SHA-256" in page.visible
    assert len(Page(summary_page(run)).plots) == 1


def test_the_summary_says_wire_load_and_date():
    run = made(wire="NiTi 7", start_epoch=1_790_000_000.0, conditions={"load": {"mean": 4.2, "unit": "N"}})
    assert Page(summary_page(run)).tables[0][1] == [
        "NiTi 7",
        "load 4.2 N",
        "2026-09-21 14:13 UTC",
        "not recorded",
    ]
    assert Page(summary_page(made())).tables[0][1] == ["not recorded"] * 4


def test_what_is_counted_on_a_sheet_are_readings_where_only_the_input_was_measured():
    u = np.concatenate([np.linspace(0, 90, 60), np.linspace(90, 0, 60)])
    y = 6 * (1 + np.tanh((u - np.repeat((50.0, 30.0), 60)) / 9))
    columns = {"t_s": np.arange(120.0), "input": u, "position": y}
    about = {"source": "import", "protocol": "import", "initial": "negative"}
    run = run_of(columns, (), input=INPUT, output=OUTPUT, **about)
    page = Page(summary_page(run, smarig.identify(run, "positive").model))
    assert "n = 120 readings." in page.visible
