"""The page of a run of any kind, with any ending and with missing data."""

from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from report.pages import LOADING, Page, run_of, step, unpacked
from smarig.config import load_actuator, load_rig
from smarig.core.sample import Quality
from smarig.record import Event
from smarig.report.run_page import run_page
from smarig.report.runs.hysteresis_figure import hysteresis_figure
from smarig.runner.session import Session

TEMPERATURE = {"quantity": "temperature", "unit": "degC"}
STRAIN = {"quantity": "strain", "unit": "mm/mm"}


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """A short run of the two-wire twin's initialisation and one of wiping-out on the one-wire twin."""
    from smarig.record import load_run

    folder = tmp_path_factory.mktemp("runs")
    with Session("two_wire_twin", seed=3) as session:
        start = session.run("initialise", {"cycles": 4}, folder / "i.run.sqlite")
    with Session("one_wire_twin", seed=3) as session:
        test = session.run(
            "wiping_out", {"points_per_branch": 2}, folder / "w.run.sqlite", notes="<script>1</script>"
        )
    return load_run(start), load_run(test)


def test_a_twin_run_shows_its_numbers_and_its_label(twin):
    run = twin[1]
    text = run_page(run)
    page = Page(text)
    assert page.visible.lstrip().startswith("TWIN")
    assert all(f"n = {len(run.settled)}" in c for c in page.captions)
    assert all(any(a["text"] == "TWIN" for a in plot["layout"]["annotations"]) for plot in page.plots)
    assert "rig one_wire_twin" in page.visible
    travel = np.ptp(run["position"])
    assert f"{travel:.4g} mm" in page.card("Travel")
    counted = page.row("wiping out")
    assert int(counted[3]) == len(run.steps)
    assert int(counted[4]) == sum(s.verdict == "settled" for s in run.steps)
    assert page.row("One count")[1:3] == ["0.04712", "mm"]
    assert page.row("Resistance martensite")[1:] == ["5", "ohm", "section 5.1.3"]
    assert page.row("Notes")[1] == "<script>1</script>"
    assert "<script>1</script>" not in text
    assert "retraces segment A" in page.visible


def test_values_of_a_template_or_of_another_sensor_are_not_shown_as_those_of_the_bench():
    rig = load_rig("bench_one_wire")
    rig = rig.model_copy(update={"encoder": rig.encoder.model_copy(update={"resolution": 0.005})})
    actuator = load_actuator("gorbet_one_wire").model_dump(mode="json")
    actuator["wire"]["density"]["source"] = "replace: of the data sheet"
    moved = {"position": [0.0, 1.0], "t_s": [0.0, 1.0]}
    output = {"quantity": "position", "unit": "mm"}
    page = Page(
        run_page(
            run_of(moved, rig_values=rig.model_dump(mode="json"), actuator_values=actuator, output=output)
        )
    )
    assert page.row("Density")[3] == "template: of another wire"
    assert "Radius" not in page.visible  # a sensor that reads a length turns no pulley
    assert "noise counts" not in page.visible
    assert "replace:" not in page.visible
    assert page.row("Resistance martensite")[3] == "section 5.1.3"
    assert page.row("Encoder: resolution")[1:] == ["0.005", "mm", "rig file"]
    assert "counts per rev" not in page.visible
    turning = dict.fromkeys(("rig_values", "actuator_values"), None) | {"actuator_values": actuator}
    assert Page(run_page(run_of(moved, **turning, output=output))).row("Radius")[1] == "15"
    assert page.row("Amplifier: saturation")[3] == "rig file, for previews and checks"
    assert page.row("Limits: current max")[3] == "rig file"


def test_a_step_that_moved_is_not_said_to_have_ended_at_its_mean():
    page = Page(run_page(run_of({"t_s": [0.0]}, (step(0, 20.0, -1.79, "elapsed"),))))
    (words,) = [words for words in page.captions if words.startswith("Steps.")] or [page.visible]
    assert "A step that is not 'settled' may have ended elsewhere." in words


@pytest.mark.parametrize(
    ("position", "verdict", "shown"),
    [
        (np.linspace(0, 1, 50), "elapsed", "–"),
        (np.sin(np.linspace(0, 2 * np.pi, 50)), "interrupted", "–"),
        (np.random.default_rng(0).normal(0.2, 0.1, 50), "settled", "0.2"),
        (np.random.default_rng(0).normal(0.2, 0.1, 50), "suspect", "0.2"),
        (np.linspace(0, 1, 50), "timed_out", "0.2"),
    ],
)
def test_a_step_that_did_not_wait_has_no_mean(position, verdict, shown):
    columns = {"t_s": np.arange(50) / 5, "position": position, "step": np.zeros(50)}
    output = {"quantity": "position", "unit": "mm", "per_count": 0.005, "resolution": 0.005}
    page = Page(run_page(run_of(columns, (step(0, 20.0, 0.2, verdict),), output=output)))
    (row,) = [row for rows in page.tables for row in rows if row[:2] == ["0", "made"]]
    assert row[3].startswith(shown)


def test_the_sentence_and_the_card_state_the_same_travel():
    columns = {
        "t_s": np.arange(200.0),
        "position": np.linspace(0, 8, 200),
        "input": np.linspace(0, 100, 200),
    }
    page = Page(run_page(run_of(columns, (step(0, 50.0, 3.0), step(1, 70.0, 5.0)), output={"unit": "mm"})))
    assert page.card("Travel").startswith("Travel8 mm")
    assert "a travel of 8 mm over 100" in page.visible


def test_no_line_crosses_a_gap_of_the_record():
    """A run that lost four samples, and was resumed 14 s after a fault."""
    t = np.concatenate([np.arange(0, 40, 0.2), np.arange(40.8, 60, 0.2), np.arange(74, 100, 0.2)])
    wave = 50 - 50 * np.cos(2 * np.pi * t / 20)
    columns = {"t_s": t, "input": wave, "position": wave / 10, "current_A": wave / 100}
    lost, last = np.searchsorted(t, [40.5, 73]).tolist()  # first rows after the gaps
    output = {"quantity": "position", "unit": "mm"}
    run = run_of(columns, period_s=0.2, input=TEMPERATURE, output=output)
    page = Page(run_page(run))
    for name in ("Current", "Temperature", "Position"):
        (trace,) = page.traces(name)[:1]
        x, y = unpacked(trace["x"]), unpacked(trace["y"])
        gaps = np.flatnonzero(np.isnan(x))
        assert [(x[at - 1], x[at + 1]) for at in gaps] == [(t[k - 1], t[k]) for k in (lost, last)]
        assert np.isnan(y[gaps]).all()
    jumps = [np.abs(np.diff(unpacked(trace["x"]))) for trace in page.plots[0]["data"]]
    assert max(np.nanmax(jump) for jump in jumps) < abs(wave[last] - wave[last - 1])
    unbroken = Page(run_page(run.with_meta(period_s=None)))
    assert not any(np.isnan(unpacked(trace["x"])).any() for trace in unbroken.traces("Current"))


def test_the_path_between_settled_points_does_not_cross_a_gap_either():
    t = np.concatenate([np.arange(0, 60, 0.2), np.arange(74, 130, 0.2)])
    u = np.concatenate([np.linspace(0, 40, 300), np.linspace(80, 100, 280)])
    columns = {"t_s": t, "input": u, "position": u / 10, "step": np.repeat([0, 1], [300, 280])}
    steps = (step(0, 40.0, 4.0), step(1, 100.0, 10.0))
    figure = hysteresis_figure(run_of(columns, steps, period_s=0.2, output={"unit": "mm"}))
    (path,) = [trace for trace in figure.panels[0].data if trace["name"] == "rising input"][:1]
    x = unpacked(path["x"])
    (at,) = np.flatnonzero(np.isnan(x[:-1]))
    assert [x[at - 1], x[at + 1]] == pytest.approx([40, 80])


def test_each_instrument_is_listed_once():
    page = Page(run_page(run_of(instruments=["ACME 3, s/n 7", "gauge 2", "ACME 3, s/n 7"])))
    assert page.row("Instruments")[1] == "ACME 3, s/n 7; gauge 2"


def test_the_settled_points_are_drawn_as_measured(twin):
    run = twin[1]
    drawn = Page(run_page(run)).traces("settled points")[0]
    inputs, outputs = run.points()
    np.testing.assert_allclose(unpacked(drawn["x"]), inputs)
    np.testing.assert_allclose(unpacked(drawn["y"]), outputs)


def test_the_direction_of_travel_is_drawn(twin):
    page = Page(run_page(twin[1]))
    for name, sign in (("rising input", 1), ("falling input", -1)):
        trace = page.traces(name)[0]
        moves = np.diff(unpacked(trace["x"]))
        moves = moves[np.isfinite(moves)]
        assert moves.size
        assert np.all(moves * sign >= 0)


def test_the_path_is_that_of_the_samples_and_not_of_chords_between_settled_points(twin):
    run = twin[1]
    drawn = [Page(run_page(run)).traces(name)[0] for name in ("rising input", "falling input")]
    points = np.concatenate([np.stack([unpacked(t["x"]), unpacked(t["y"])], 1) for t in drawn])
    points = points[np.isfinite(points).all(axis=1)]
    samples = np.stack([run["input"], run["position"]], 1).astype(np.float32)
    assert len(points) > 3 * len(run.settled)
    pairs = [np.ascontiguousarray(a, np.float32).view(np.int64) for a in (points, samples)]
    assert np.isin(*pairs).all()
    levels = np.sort(points[:, 0])
    above = np.searchsorted(levels, run["input"]).clip(1, levels.size - 1)
    gaps = np.minimum(np.abs(levels[above] - run["input"]), np.abs(levels[above - 1] - run["input"]))
    assert gaps.max() < 0.02 * np.ptp(run["input"])


def test_initialisation_shows_the_wire_against_the_commands(twin):
    run = twin[0]
    page = Page(run_page(run))
    wire, asked = page.traces("wire temperature")[0], page.traces("steady temperature of the current")[0]
    rows = run["step"] == next(s.index for s in run.steps if s.branch == "decay")
    top = run["current_command_A"][rows].max()
    assert unpacked(asked["y"]).max() == pytest.approx(185 * top**2, rel=1e-4)  # 185 K at 1 A (§5.4.1)
    assert unpacked(wire["y"]).max() == pytest.approx(run["input"][rows].max(), rel=1e-6)
    assert 100 < unpacked(wire["y"]).max() < unpacked(asked["y"]).max()
    assert "In 4 cycles" in page.visible or "In 5 cycles" in page.visible


def test_every_trace_and_layout_is_one_plotly_accepts(twin):
    for run in twin:
        for plot in Page(run_page(run)).plots:
            plot["layout"].pop("narrow", None)
            go.Figure(plot["data"], plot["layout"])


def test_long_runs_are_drawn_with_few_points_and_all_extremes(twin):
    run = twin[0]
    trace = Page(run_page(run)).traces("Shaft angle")[0]
    y = unpacked(trace["y"])
    assert len(run) > 3000 > y.size
    assert y.max() == pytest.approx(run["position"].max(), rel=1e-6)
    assert y.min() == pytest.approx(run["position"].min(), rel=1e-6)


def test_an_empty_run_gives_a_page():
    page = Page(run_page(run_of()))
    assert "no samples to draw" in page.visible
    assert page.plots == []


def test_what_a_resumed_run_records_of_its_interruption_is_no_advice_for_now():
    """The session that resumes it has ordered the current to zero since."""
    cut_off = run_of(end=None, has_lease=False)
    assert cut_off.may_flow
    assert cut_off.past_cause == "incomplete: the run was never closed"
    assert run_of(end="tripped: too hot").past_cause == "tripped: too hot"


def test_a_run_without_a_lease_that_was_cut_off_says_that_its_current_may_be_on():
    words = "its current may still be on"
    assert words in Page(run_page(run_of(end=None, has_lease=False))).visible
    for told in ({"end": None, "has_lease": True}, {"end": None}, {"has_lease": False}):
        assert words not in Page(run_page(run_of(**told))).visible


@pytest.mark.parametrize(
    ("end", "words"), [(None, "never closed"), ("stopped: the <b>lease</b> expired", "<b>lease</b>")]
)
def test_the_page_of_a_run_that_ended_early_states_the_cause_at_the_top(end, words):
    page = Page(run_page(run_of(end=end)))
    at = page.visible.index("Incomplete run made.run.sqlite")
    assert words in page.visible[at : at + 120]
    assert at < page.visible.index("Rig and conditions")
    assert "Incomplete" not in Page(run_page(run_of())).visible


def test_limits_are_those_of_the_run_and_those_that_were_not_set_have_no_row():
    values = {"limits": {"temperature_max_K": 105.0, "stress_max_MPa": 300.0, "voltage_max_V": None}}
    page = Page(run_page(run_of(rig_values=values)))
    assert page.row("Limits: temperature max")[1:3] == ["105", "K"]
    assert page.row("Limits: stress max")[1:3] == ["300", "MPa"]
    assert "None" not in page.visible


def test_conditions_are_values_with_units():
    stress = {"mean": 51.25, "unit": "MPa", "min": 49.9, "max": 50.0}
    page = Page(run_page(run_of(conditions={"stress": stress, "specimen": {"text": "A3"}})))
    assert page.row("Stress")[1:3] == ["51.2", "MPa"]
    assert page.row("Specimen")[1] == "A3"


def test_what_is_not_as_it_should_be_is_marked_and_counted():
    n = 400
    quality = np.zeros(n)
    quality[[5, 6, 7]] = Quality.SATURATED
    quality[100] = Quality.RETRIED | Quality.STALE
    columns = {
        "t_s": np.arange(n) / 10,
        "position": np.linspace(0, 1, n),
        "current_A": np.ones(n),
        "quality": quality,
    }
    steps = (step(0, 1.0, 0.1), step(1, 2.0, 0.5, "timed_out"), step(2, 1.5, 0.4))
    events = (Event(3.0, "warning", "amplifier", "It saturated.", {}),)
    page = Page(run_page(run_of(columns, steps, events, source="bench")))
    header, counted = next(t for t in page.tables if t[0][0] == "Run")[:2]
    assert dict(zip(header, counted)) == {
        "Run": counted[0],
        "Duration": counted[1],
        "Samples": "400",
        "Steps": "3",
        "Settled": "2",
        "Timed out": "1",
        "Retried": "1",
        "Stale": "1",
        "Saturated": "3",
        "Ended": "done",
    }
    assert "No step and no sample is marked interrupted, void, tripped or suspect." in page.visible
    ringed = page.traces("not settled")[0]
    assert unpacked(ringed["x"]).tolist() == [2.0]
    assert unpacked(page.traces("3 saturated")[0]["x"]).tolist() == pytest.approx([0.5, 0.6, 0.7])
    assert "It saturated." in page.visible
    assert "TWIN" not in page.visible


@pytest.mark.long("takes two seconds")
def test_temperature_strain_cycles_without_time_or_current():
    t = np.linspace(0, 40 * np.pi, 9000)
    columns = {"input": 100 + 60 * np.sin(t), "position": 0.02 - 0.02 * np.tanh(np.sin(t - 0.3))}
    imported = {"file": "<cycles>.txt", "format": "csv"}
    run = run_of(
        columns, protocol="sma_cycles", source="import", input=TEMPERATURE, output=STRAIN, imported=imported
    )
    page = Page(run_page(run))
    assert "TWIN" not in page.visible
    assert "no time was recorded" in page.visible
    assert "Imported from <cycles>.txt" in page.visible
    plot = page.plots[0]  # the next shows the tangents
    assert plot["layout"]["xaxis"]["title"]["text"] == "Temperature (°C)"
    assert plot["layout"]["yaxis"]["title"]["text"] == "Strain (mm/mm)"
    x = np.concatenate([unpacked(trace["x"]) for trace in plot["data"]])
    assert np.nanmax(x) == pytest.approx(columns["input"].max())


def test_reversal_curves_are_drawn_one_by_one():
    fields = [np.linspace(-start, 1, 200) for start in np.linspace(-0.8, 1, 30)]
    columns = {
        "input": np.concatenate(fields),
        "position": np.concatenate([np.tanh(3 * f - 1) for f in fields]),
        "step": np.repeat(np.arange(30), 200),
    }
    run = run_of(columns, protocol="first_order_reversal_curves", source="import")
    traces = [trace for panel in hysteresis_figure(run).panels for trace in panel.data]
    drawn = [trace for trace in traces if trace["name"].startswith("reversal at")]
    assert sum(int(np.isnan(unpacked(trace["x"])).sum()) for trace in drawn) == 30


def test_reversal_curves_without_numbers_are_still_drawn():
    columns = {"input": np.linspace(0, 1, 50), "position": np.linspace(0, 1, 50)}
    assert Page(run_page(run_of(columns, protocol="first_order_reversal_curves"))).plots


def test_nothing_is_ever_loaded(twin):
    for name, attributes in Page(run_page(twin[1])).tags:
        assert name not in ("link", "iframe", "object", "embed", "base", "img")
        for key in LOADING:
            assert attributes.get(key, "#").startswith("#"), f"<{name} {key}={attributes[key]}>"
        assert "url(" not in attributes.get("style", "")


def test_the_share_of_lost_samples_stands_at_the_top(twin):
    run = twin[1]
    kept = np.delete(np.arange(len(run)), [10, 11, 50])
    columns = {name: run[name][kept] for name in run.columns}
    lost = Event(1.0, "warning", "lost", "2 samples were lost.", {})
    visible = Page(run_page(replace(run, columns=columns, events=(*run.events, lost)))).visible
    lead = visible[: visible.index("Warnings")].replace("\u202f", "")
    assert f"3 of {len(run)} samples" in lead
    assert f"{100 * 3 / len(run):.2g} %) were lost." in lead


def test_many_warnings_of_one_kind_are_counted(twin):
    lost = tuple(Event(k, "warning", "lost", f"{k + 2} samples were lost.", {}) for k in range(500))
    clock = Event(1.0, "warning", "clock", "The clocks differ.", {})
    page = Page(run_page(replace(twin[1], events=(*lost, clock))))
    box = page.visible[page.visible.index("Warnings") :]
    box = box[: box.index("The clocks differ.")]
    assert box.count("samples were lost") == 3
    assert "497 more of this kind (lost)." in box
