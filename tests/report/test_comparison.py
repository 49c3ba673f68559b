"""Comparison of runs, and of models on the same runs: offsets, errors and texts."""

import numpy as np
import pytest

import smarig
from report.pages import Page, run_of, step, unpacked
from smarig.core.errors import UsageError
from smarig.plant.effect_catalogue import effects_from_pairs
from smarig.record import load_run
from smarig.report.model_comparison_page import models_page
from smarig.report.run_comparison_page import comparison_page
from smarig.report.runs.run_alignment import aligned, common_steps
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

INPUT = {"quantity": "temperature", "unit": "K"}
OUTPUT = {"quantity": "displacement", "unit": "mm"}
TARGETS = (0.0, 100.0, 20.0, 80.0)


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
    with pytest.raises(UsageError, match="at most 8"):
        comparison_page({str(k): made((0, 5, 2, 4)) for k in range(9)})


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
