"""The drawn values are the measured ones: values, units, positions, axes up, and the twin's label; without a
viewer."""

import json

import numpy as np
import pytest

from live.made import RecordingOutput, planned_run_info
from smarig.core.sample import Sample
from smarig.core.severity import Severity
from smarig.live import colours
from smarig.live.display_info import run_display_info
from smarig.live.live_items import EventItem, SampleItem
from smarig.live.playback import batches, replay
from smarig.live.plot_axes import Plot, nice_step, rounded
from smarig.live.preisach_plane import boundary, density, density_image
from smarig.live.primitives import (
    Pixels,
    Points,
    Polylines,
    SeriesLegend,
    StateLane,
    TextLog,
    TimeSeries,
    Transform,
)
from smarig.live.scene_renderer import SceneRenderer
from smarig.live.view_layout import Split, View
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.record import Run
from smarig.replay import HysteresisPredictor, NamedPredictor
from smarig.report.components import style


def drawn(run: Run, size: int = 500) -> tuple[RecordingOutput, SceneRenderer]:
    screen, display_info = RecordingOutput(), run_display_info(run)
    assert display_info.twin_hysteresis is not None
    scene_renderer = SceneRenderer(
        display_info,
        screen.show,
        [NamedPredictor("own", HysteresisPredictor(display_info.twin_hysteresis, display_info.initial))],
        display_info.twin_hysteresis,
    )
    screen.show(scene_renderer.opening())
    for batch in batches(run, size):
        scene_renderer.draw(batch)
    return screen, scene_renderer


def column(screen: RecordingOutput, path: str) -> tuple[np.ndarray, np.ndarray]:
    series = [mark for mark in screen.at(path) if isinstance(mark, TimeSeries)]
    return np.concatenate([m.times_s for m in series]), np.vstack([m.values for m in series])


def views(part: Split | View) -> list[View]:
    return [part] if isinstance(part, View) else [v for p in part.parts for v in views(p)]


def test_every_sample_is_drawn_with_its_value(one_wire):
    screen, _ = drawn(one_wire)
    times, position = column(screen, "position")
    assert np.array_equal(times, one_wire["t_s"])
    assert np.array_equal(position[:, 0], one_wire["position"])
    assert np.array_equal(
        column(screen, "current")[1], np.c_[one_wire["current_command_A"], one_wire["current_A"]]
    )
    assert np.array_equal(column(screen, "temperature")[1][:, 0], one_wire["input"])
    assert np.array_equal(column(screen, "voltage")[1][:, 0], one_wire["voltage_V"])
    assert np.ptp(one_wire["position"]) > 8.0  # it moved


def test_the_own_surface_predicts_the_twin_to_its_noise(one_wire):
    screen, _ = drawn(one_wire)
    residual = column(screen, "residual")[1]
    per_count = one_wire.meta["output"]["per_count"]
    assert np.std(residual) < per_count
    assert np.allclose(residual[:, 0], np.subtract(*column(screen, "position")[1].T), equal_nan=True)


def test_batches_do_not_change_what_is_drawn(one_wire):
    few, many = drawn(one_wire, 10_000)[0], drawn(one_wire, 37)[0]
    for path in ("position", "residual", "settling/counts"):
        assert np.array_equal(column(few, path)[1], column(many, path)[1], equal_nan=True)
    trail = f"{Plot('graph', rounded('', 0, 1), rounded('', 0, 1)).inside}/measured"
    ways = [np.vstack([s for m in screen.at(trail) for s in m.strips]) for screen in (few, many)]
    assert np.array_equal(*ways)


def test_what_stands_still_costs_nothing(one_wire):
    screen, scene_renderer = drawn(one_wire)
    frames = sum(len(m.times_s) for m in screen.at(f"{scene_renderer.plane.inside}/boundary"))
    assert 50 < frames < len(one_wire) / 5


def test_axes_point_up_and_have_units(one_wire):
    screen, scene_renderer = drawn(one_wire)
    (place,) = [m for m in screen.at("graph/plot") if isinstance(m, Transform)]
    assert place.scale is not None
    assert place.scale[0] > 0 > place.scale[1]  # viewers draw y downward
    (titles,) = screen.at("graph/plot/titles")
    assert titles.texts == ("estimated temperature above ambient (K)", "position (mm)")
    names = [v.name for v in views(scene_renderer.layout)]
    for unit in ("(mm)", "(K)", "(A)", "(V)", "(Ω)", "(counts)", "(s)"):
        assert any(unit in name for name in names), unit
    drawn_to = place.shift[0, 1] + place.scale[1] * np.array(
        [scene_renderer.graph.y.low, scene_renderer.graph.y.high]
    )
    assert np.allclose(drawn_to, [0.0, -scene_renderer.graph.height])


@pytest.mark.long("takes two seconds")
def test_every_view_has_something_drawn_below_its_origin(one_wire, two_wire):
    for run in (one_wire, two_wire):
        screen, scene_renderer = drawn(run)
        for view in views(scene_renderer.layout):
            below = [
                m for m in screen.primitives if m.path == view.origin or m.path.startswith(f"{view.origin}/")
            ]
            assert [m for m in below if not isinstance(m, SeriesLegend)], view.name


def test_a_twin_is_labelled_where_nobody_misses_it(one_wire):
    screen, scene_renderer = drawn(one_wire)
    labels = [
        m for m in screen.primitives if isinstance(m, Points) and any("TWIN" in text for text in m.texts)
    ]
    assert {m.path for m in labels} == {"graph/source", "plane/source", "rig/source"}
    assert all(m.colour == colours.AMBER for m in labels)
    assert screen.at("about/page")[0].text.startswith("## TWIN")
    assert sum(v.name.startswith("TWIN") for v in views(scene_renderer.layout)) >= 5


def test_hardware_is_not_called_a_twin(one_wire):
    meta = {**one_wire.meta, "source": "bench"}
    screen = RecordingOutput()
    scene_renderer = SceneRenderer(
        run_display_info(Run(one_wire.path, meta, one_wire.columns, (), ())), screen.show
    )
    screen.show(scene_renderer.opening())
    assert "TWIN" not in json.dumps([str(m) for m in screen.primitives]) + str(scene_renderer.layout)
    assert not [m for m in screen.primitives if isinstance(m, Pixels)]  # the μ of this wire is unknown


def test_the_boundary_is_that_of_the_inputs(one_wire):
    screen, scene_renderer = drawn(one_wire)
    primitives = [m for m in screen.at(f"{scene_renderer.plane.inside}/boundary") if isinstance(m, Polylines)]
    last = primitives[-1].strips[-1]
    memory = Preisach(thesis_surface("one_e"))
    t_last = primitives[-1].times_s[-1]
    for u in one_wire["input"][one_wire["t_s"] <= t_last].tolist():
        memory.step(u)
    assert np.array_equal(last, boundary(memory.state, 0.0, memory.hysteresis.upper))
    assert last[-1, 0] == last[-1, 1]


def test_a_diagonal_boundary_leaves_the_line_where_the_input_turned():
    memory = Preisach(thesis_surface("two_e"), "anhysteretic")
    top = memory.hysteresis.upper
    assert boundary(memory.state, -top, top).tolist() == [[-top, top], [0.0, 0.0]]
    memory.step(40.0)
    memory.step(10.0)
    found = boundary(memory.state, -top, top).tolist()
    assert found == [[-top, top], [-40.0, 40.0], [10.0, 40.0], [10.0, 10.0]]


def test_the_map_holds_the_surface_less_its_reversible_part():
    h = thesis_surface("one_c")
    mu = density(h, 60)
    cell = (h.upper - h.lower) / 60
    below = np.nansum(mu) * cell**2
    corner = np.linspace(h.lower, h.upper, 61)
    diagonal = sum(h.everett(b, a) for a, b in zip(corner[:-1], corner[1:])) / 2
    total = h.everett(h.upper, h.lower) / 2
    assert below + diagonal == pytest.approx(total, rel=1e-9)
    shown = density_image(mu)
    assert tuple(shown[0, -1]) == colours.GROUND
    assert (shown[np.isfinite(mu)][:, 0] > 100).any()


def test_the_load_rises_and_the_shaft_turns_as_measured(one_wire, two_wire):
    screen, _ = drawn(one_wire)
    lifted = np.vstack([m.shift for m in screen.at("rig/load") if isinstance(m, Transform)])
    assert lifted[:, 1].max() == pytest.approx(one_wire["position"].max(), abs=0.15)
    turn = np.concatenate([m.turn_rad for m in screen.at("rig/pulley") if isinstance(m, Transform)])
    assert np.allclose(turn * 15.0, lifted[:, 1])
    screen, _ = drawn(two_wire)
    turn = np.concatenate([m.turn_rad for m in screen.at("rig/pulley") if isinstance(m, Transform)])
    assert np.degrees(turn.min()) == pytest.approx(two_wire["position"].min(), abs=0.6)
    assert screen.at("rig/wire_2")
    assert not screen.at("rig/load")


def test_lanes_show_steps_and_how_they_ended(one_wire):
    screen, _ = drawn(one_wire)
    lanes = {
        path: [m for m in screen.at(path) if isinstance(m, StateLane)]
        for path in ("lanes/step", "lanes/verdict")
    }
    steps = [state for m in lanes["lanes/step"] for state in m.states]
    assert [s for s in steps if s.startswith("step")] == [f"step {s.index}" for s in one_wire.steps]
    ended = [
        (t, v) for m in lanes["lanes/verdict"] for t, v in zip(m.times_s.tolist(), m.states) if v != "waiting"
    ]
    assert ended == [(s.t_start_s, s.verdict) for s in one_wire.steps]


def test_events_are_shown_with_their_severities(one_wire):
    screen = RecordingOutput()
    scene_renderer = SceneRenderer(run_display_info(one_wire), screen.show)
    scene_renderer.draw([EventItem(1.0, "error", "trip", "too hot", Severity.MAJOR)])
    (log_lines,) = [m for m in screen.primitives if isinstance(m, TextLog)]
    assert (log_lines.texts, log_lines.severities) == (("trip: too hot",), (Severity.MAJOR,))
    (lane,) = [m for m in screen.primitives if isinstance(m, StateLane)]
    assert lane.states == ("trouble",)


def ticked(k: int, u: float, y: float) -> SampleItem:
    return SampleItem(Sample(k, 0.1 * k, 0.5, 0.5, 2.4, np.nan, round(y / 0.047), y, 22.0, 0), 0, u)


def test_after_a_gap_the_model_predicts_nothing_until_saturation():
    screen, display_info = RecordingOutput(), planned_run_info()
    assert display_info.twin_hysteresis is not None
    upper = display_info.twin_hysteresis.upper
    scene_renderer = SceneRenderer(
        display_info,
        screen.show,
        [NamedPredictor("own", HysteresisPredictor(display_info.twin_hysteresis, "negative"))],
        display_info.twin_hysteresis,
    )
    scene_renderer.draw([ticked(1, 10.0, 0.0)])
    scene_renderer.draw([ticked(5, 60.0, 1.0), ticked(6, upper, 12.0), ticked(7, 100.0, 11.0)], lost=3)
    _, values = column(screen, "position")
    assert np.isfinite(values[:, 1]).tolist() == [True, False, True, True]
    assert any("3 items" in text for m in screen.primitives if isinstance(m, TextLog) for text in m.texts)


def test_a_zeroed_encoder_does_not_look_like_a_wrong_model():
    screen, display_info = RecordingOutput(), planned_run_info()
    assert display_info.twin_hysteresis is not None
    scene_renderer = SceneRenderer(
        display_info,
        screen.show,
        [NamedPredictor("own", HysteresisPredictor(display_info.twin_hysteresis, "negative"))],
    )
    before = [ticked(k, 10.0, 0.0) for k in range(60)]
    after = [ticked(k, 10.0, 5.0) for k in range(60, 120)]
    scene_renderer.draw([*before, EventItem(6.0, "info", "zero", "Encoder zeroed.", Severity.NONE), *after])
    assert np.abs(column(screen, "residual")[1]).max() < 1e-12


def test_axes_grow_with_the_data():
    screen, display_info = RecordingOutput(), planned_run_info()
    scene_renderer = SceneRenderer(display_info, screen.show)
    scene_renderer.draw([ticked(1, 10.0, 3.0)])
    assert scene_renderer.graph.y == display_info.output
    scene_renderer.draw([ticked(2, 10.0, 40.0)])
    assert scene_renderer.graph.y.low <= display_info.output.low
    assert scene_renderer.graph.y.high > 40.0
    assert [m for m in screen.at("graph/plot") if isinstance(m, Transform)]


def test_a_replay_at_a_pace_keeps_it():
    """With a simulated clock: at twice real time, ten seconds take five."""
    clock = [0.0]
    shown: list[tuple[float, float]] = []

    def wait(seconds: float) -> bool:
        clock[0] += seconds
        return False

    run = a_plain_run()
    replay(
        run, lambda items: shown.extend((clock[0], i.sample.t_s) for i in items), 2.0, wait, lambda: clock[0]
    )
    assert [t for _, t in shown] == run["t_s"].tolist()
    late = [now - t / 2.0 for now, t in shown]
    assert min(late) > -1e-9
    assert max(late) < 0.5


def a_plain_run() -> Run:
    t = np.arange(0.0, 10.0, 0.1)
    nothing = np.full(t.size, np.nan)
    names = (
        "step",
        "current_command_A",
        "current_A",
        "voltage_V",
        "temperature_degC",
        "ambient_degC",
        "counts",
    )
    columns = {"tick": np.arange(t.size) * 1.0, "t_s": t, "input": t, "position": t, "quality": 0 * t}
    return Run(a_path(), {}, {**columns, **dict.fromkeys(names, nothing)}, (), ())


def a_path():
    from pathlib import Path

    return Path("somebody's.run.sqlite")


def test_data_of_others_are_drawn_without_a_rig():
    screen = RecordingOutput()
    run = a_plain_run()
    scene_renderer = SceneRenderer(run_display_info(run), screen.show)
    screen.show(scene_renderer.opening())
    for batch in batches(run):
        scene_renderer.draw(batch)
    assert np.array_equal(column(screen, "position")[1][:, 0], run["position"])
    assert not [m for m in screen.primitives if m.path.startswith("rig")]
    assert not [v for v in views(scene_renderer.layout) if v.kind == "space"]


@pytest.mark.parametrize(("rough", "nice"), [(0.11, 0.2), (0.2, 0.2), (3.0, 5.0), (51.0, 100.0)])
def test_ticks_are_round(rough, nice):
    assert nice_step(rough) == nice


def test_colours_mean_the_same_as_in_the_reports():
    def rgb(text: str) -> tuple[int, ...]:
        return tuple(int(text[k : k + 2], 16) for k in (1, 3, 5))

    assert rgb(style.HEATING) == colours.HEATING
    assert rgb(style.MODEL) == colours.model_colour(0)
    assert rgb(style.CURRENT) == colours.ORANGE
    assert rgb(style.GOOD) == colours.GOOD
    assert len({colours.model_colour(k) for k in range(4)}) == 4


def test_the_distance_from_the_window_is_that_of_the_window(one_wire):
    """Of the last 25 s of the step, as the runner's own window has them."""
    screen, _ = drawn(one_wire)
    off = column(screen, "settling/counts")[1][:, 0]
    step, counts = one_wire["step"], one_wire["counts"]
    members = np.flatnonzero(step == 2)
    assert len(members) > 300
    for k in (members[100], members[300], members[-1]):
        window = counts[max(members[0], k - 249) : k + 1]
        assert off[k] == pytest.approx(counts[k] - window.mean())


def test_ticks_reach_both_ends():
    assert rounded("", 0.0, 10.0).ticks == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
