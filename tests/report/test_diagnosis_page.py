"""The page of a diagnosis: its texts and figures of evidence from a twin with an injected drift, for every
verdict.

The search is not run here. The explanation is the injected drift, with made-up standard deviations.
"""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import plotly.graph_objects as go
import pytest
from smarig.diagnosis.critique.calibration import CALIBRATION_BOXES
from smarig.diagnosis.critique.critique import critique
from smarig.diagnosis.critique.visibility import visibility
from smarig.diagnosis.diagnosis_result import Diagnosis, ErrorSummary
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.explain.discrepancy import Discrepancy
from smarig.diagnosis.explain.search import NearestEffect

import smarig
from report.pages import LOADING, Page, unpacked
from smarig.diagnosis.held_out_gain import held_out_gain
from smarig.diagnosis.refit.parameter_fit import ParameterFit
from smarig.plant.effect_catalogue import effect_types, effects_from_pairs
from smarig.plant.effects.slack import slack
from smarig.record import load_run
from smarig.replay import build_timeline, plant_model_of, predict
from smarig.replay.plant_model import actuator_of
from smarig.report.components.figure import AXIS_MARGIN
from smarig.report.components.page import write_page
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions, diagnosis_caption
from smarig.report.diagnosis.residual_axes import half_ranges, symmetric_layout
from smarig.report.diagnosis_page import diagnosis_page
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

DRIFT, SLIP = effects_from_pairs(["ambient_drift=3", "slip=1"])
COMPETE = ("ambient_drift", "creep", "sensor_lag", "slack", "walking")
LEVELS = (0, 50, 70, 80, 90, 110, 160)
NAMED = DiagnosisVerdict("named", ((("ambient_drift",), 0.97), (("slip",), 0.03)))


def lived(folder, seed, *effects, with_validation=False):
    """First-order curves of a one-wire twin, with a held-out run on request."""
    with Session("one_wire_twin", twin=TwinSettings(seed=seed, effects=effects)) as session:
        curves = {"partition_K": LEVELS}
        runs = [session.run("first_order_descending", curves, folder / f"{seed}f.run.sqlite")]
        if with_validation:
            runs.append(session.run("validation", {"points": 10}, folder / f"{seed}v.run.sqlite"))
    return [load_run(run) for run in runs]


@pytest.fixture(scope="session")
def named(tmp_path_factory) -> Diagnosis:
    """A drift of 3 K with its rival, 40 nulls."""
    folder = tmp_path_factory.mktemp("diagnosed")
    model = smarig.identify(lived(folder, 4)[0], "positive").model
    runs = lived(folder, 5, DRIFT, with_validation=True)
    extended = replace(model, name=f"{model.name} + ambient_drift", effects=(DRIFT.to_json(),))
    timeline = build_timeline(runs[:1], actuator_of(model).tau_s)
    base, with_drift = (plant_model_of(m, timeline.runs[0]) for m in (model, extended))
    first = critique(timeline, base, [k for k in effect_types() if k.name in COMPETE], count=40, alpha=0.1)
    spread = {("ambient_drift", p.name): 0.1 for p in DRIFT.kind.parameters}
    best = ParameterFit((DRIFT,), spread, spread, np.zeros(1), base, moved=0.0)
    rival = SimpleNamespace(effects=(SLIP,), names=("slip",))
    level = SimpleNamespace(
        critique=first, explanations=(best, rival), best=best, gain=321.0, lead=lambda k: 14.0 * k
    )
    misses = [
        np.std(timeline.settled.value - predict(timeline, s).values["settled"]) for s in (base, with_drift)
    ]
    gain = held_out_gain(runs[:1], runs[1:], base, with_drift, first.refitted.noise)
    error = ErrorSummary(timeline.unit, first.refitted.noise.settled, float(misses[0]), *map(float, misses))
    return Diagnosis(
        verdict=NAMED,
        reason="",
        discrepancy=Discrepancy("time", "input", 60.0, 0.1, 300.0, 0.01),
        remaining=Discrepancy("", "", 0.0, 0.1, 300.0, 0.01),
        timeline=timeline,
        first=first,
        levels=(level,),
        base=base,
        visibility=visibility(first),
        error=error,
        gain=gain,
        model=extended,
        numerics=1e-15,
        alpha=0.1,
        nulls=40,
        seconds=1.0,
    )


@pytest.fixture(scope="session")
def silent(named) -> Diagnosis:
    """The same evidence where nothing exceeds the threshold."""
    quiet = replace(named.first, threshold=1e6, alarm_threshold=1e6, calibrated_p=0.5)
    return replace(named, verdict=DiagnosisVerdict("silent"), first=quiet, levels=(), gain=None)


def nearest(d: Diagnosis, word: str) -> Diagnosis:
    """The same evidence under another verdict."""
    two = ((("ambient_drift",), 0.6), (("slip",), 0.4))
    return replace(d, verdict=DiagnosisVerdict(word, two, "time" if word == "unknown" else None))


def test_an_effect_that_nearly_has_a_name_is_told_with_what_it_lacks_and_what_helps(named):
    d = replace(
        named,
        verdict=DiagnosisVerdict("unknown", depends_on="level"),
        levels=(),
        nearest=NearestEffect(slack(0.57), 17.6, 18.0, 13.9),
    )
    assert "no known effect explains it" in replace(d, nearest=None).text()
    for words in (d.text(), Page(diagnosis_page(d)).visible):
        assert "no known effect explains it" not in words
        assert "Nearest effect of the catalogue: slack (floor 0.57 %)" in words
        assert "only 17.6 of the 18 nats that a name needs" in words
        assert slack.remedy_text in words
    without_variable = replace(d, verdict=DiagnosisVerdict("unknown"))
    assert "something is wrong, but no effect of the catalogue is certain" in without_variable.text().lower()
    assert d.to_json()["nearest"] == {
        "name": "slack",
        "parameters": {
            p.name: {"value": v, "unit": p.unit} for p, v in zip(slack.parameters, (0.57,), strict=True)
        },
        "gain_nats": 17.6,
        "required_nats": 18.0,
        "lead_nats": 13.9,
    }


@pytest.mark.parametrize(("counts", "at_least"), [(0.1, True), (0.5, False)])
def test_a_noise_that_is_the_least_assumed_is_told_as_a_bound(silent, counts, at_least):
    """A fit assumes a tenth of a count at least; then the scatter may be smaller."""
    per_count = silent.first.refitted.noise.settled / counts
    d = replace(silent, base=replace(silent.base, per_count=per_count))
    for words in (d.text(), Page(diagnosis_page(d)).visible):
        assert ("noise of a settled point at most 0.0" in words) == at_least
    assert ("at its lower bound of 0.1 counts" in Page(diagnosis_page(d)).visible) == at_least


def test_a_named_effect_stands_first_with_its_strength_interval_p_and_gain(named):
    page = Page(diagnosis_page(named))
    found = named.effects()[0]["parameters"]["swing_K"]
    words = page.visible[page.visible.index("Named: ") :]
    assert words.startswith(f"Named: ambient_drift, swing {found['value']:.3g} K (95 %: ".replace("-", "−"))
    assert f"{found['ci95'][0]:.3g} to {found['ci95'][1]:.3g}".replace("-", "−") in words
    assert "p ≤ 0.005" in page.card("Probability by chance")
    assert f"{CALIBRATION_BOXES} simulated wires without an effect" in page.card("Probability by chance")
    e = named.error
    assert f"{e.base:.3g} → {e.extended:.3g}" in page.card("Settled points, rms (mm)")
    assert f"R = {named.gain.removable_share:.2f}".replace("-", "−") in page.card("Removable share")


def test_steps_that_had_not_settled_are_reported(named):
    run = named.timeline.runs[0]
    late = [replace(step, verdict="timed_out") if k in (1, 4) else step for k, step in enumerate(run.steps)]
    late_text = replace(named.timeline, runs=(replace(run, steps=tuple(late)), *named.timeline.runs[1:]))
    words = f"2 of {len(named.timeline.settled)} settled points had not settled by their time limit."
    assert words in replace(named, timeline=late_text).text()
    assert "had not settled" not in named.text()


def test_a_negative_gain_is_announced(named):
    worse = replace(named.gain, extended_error=3 * named.gain.base_error)
    better = replace(named.gain, extended_error=0.5 * named.gain.base_error)
    assert "Do not use it yet" in Page(diagnosis_page(replace(named, gain=worse))).visible
    assert "Do not use it yet" not in Page(diagnosis_page(replace(named, gain=better))).visible


def test_a_diagnosis_without_finding_states_it_and_shows_no_extended_model(silent):
    page = Page(diagnosis_page(silent))
    assert (
        "No finding: the model explains these data as well as it explains data without any effect."
        in page.visible
    )
    assert "no held-out run" in page.card("Gain on held-out data")
    assert not page.traces("extended model")
    assert "No experiment is needed" in page.visible


def test_a_silent_verdict_above_the_threshold_gives_a_warning(named):
    page = Page(diagnosis_page(replace(named, verdict=DiagnosisVerdict("silent"), levels=())))
    assert "No finding, with a doubt" in page.visible
    assert "No experiment is needed" not in page.visible


def test_rivals_stand_below_the_best_with_their_distance_and_probability(named):
    page = Page(diagnosis_page(named))
    assert page.row("ambient_drift: swing")[1:] == ["0", "0.970"]
    assert page.row("slip: ")[1:] == ["14.0", "0.030"]


@pytest.mark.parametrize(
    ("word", "sentence", "advice"),
    [
        ("ambiguous", "one of ambient_drift, slip", "What would decide between them"),
        ("unknown", "Unknown: something is wrong and depends on the time", "Repeat the same run later"),
        ("not_identifiable", "These data cannot decide", "Make a run that can show an effect"),
    ],
)
def test_every_other_verdict_has_its_sentence_and_advice(named, word: str, sentence: str, advice: str):
    page = Page(diagnosis_page(nearest(named, word)))
    assert sentence in page.visible
    assert advice in page.visible[page.visible.index("The next experiment") :]


def test_the_residuals_drawn_are_measured_minus_each_model(named):
    page = Page(diagnosis_page(named))
    predictions = DiagnosisPredictions.of(named)
    assert np.std(predictions.residuals(predictions.extended, "settled")) == pytest.approx(
        named.error.extended, rel=1e-6
    )
    for name, whole in (("base", predictions.base), ("extended", predictions.extended)):
        drawn = unpacked(page.traces(f"measured − {name} model")[0]["y"])
        np.testing.assert_allclose(drawn, predictions.residuals(whole, "settled"))
        assert np.std(drawn) == pytest.approx(getattr(named.error, name), rel=1e-6)


def test_the_ambient_channel_is_drawn_where_it_explains_most(named):
    caption = next(c for c in Page(diagnosis_page(named)).captions if "ambient temperature in the box" in c)
    assert " K " in caption
    assert f"n = {len(named.timeline.settled)}" in caption


def test_every_candidate_is_on_the_detection_figure_on_its_side_of_the_threshold(named):
    page = Page(diagnosis_page(named))
    drawn = page.traces("effect of the catalogue") + page.traces("depends on a variable")
    values = np.sinh(np.concatenate([unpacked(trace["x"]) for trace in drawn]))
    seen = [s.standard for s in named.first.scores if s.candidate.traces.shape[1]]
    np.testing.assert_allclose(np.sort(values), np.sort(seen), atol=1e-9)
    edge = np.sinh(unpacked(page.traces("threshold")[0]["x"]))
    np.testing.assert_allclose(edge, named.first.alarm_threshold)


def test_visibility_is_reported_for_every_effect(named):
    blind = replace(named.visibility, delta=np.where(np.arange(len(named.visibility.names)) == 0, 0.0, 1.0))
    page = Page(diagnosis_page(replace(named, visibility=blind)))
    known = {k.name: k for k in effect_types()}
    for name in named.visibility.names:
        assert page_row(page, name)[1].split()[0] == f"{abs(known[name].primary.typical):g}"
    hidden = named.visibility.names[0]
    assert page_row(page, hidden)[3] == "none"
    after = page.visible[page.visible.index("cannot show at any strength") :]
    assert after.split(" What shows it: ")[0].endswith(f"{hidden}. {known[hidden].summary}")


def page_row(page: Page, effect: str) -> list[str]:
    """The row of an effect in the table of visibility."""
    table = next(t for t in page.tables if t[0][0] == "Effect")
    return next(row for row in table if row[0] == effect)


def test_a_separating_run_is_printed(named):
    run = {"protocol": "pause_an_hour", "why": "The room goes on, cycles do not.", "rig_hours": 2.5}
    requested = replace(named)
    object.__setattr__(requested, "separating_run", run)
    words = Page(diagnosis_page(requested)).visible
    assert "pause_an_hour, 2.50 h on the rig" in words
    assert "The room goes on, cycles do not." in words


def test_every_block_held_out_is_drawn(named):
    page = Page(diagnosis_page(named))
    blocks = unpacked(page.traces("base model")[-1]["x"])
    np.testing.assert_allclose(blocks, np.arange(1, named.gain.blocks + 1))


def test_the_rms_of_the_blocks_drawn_make_up_the_whole_every_reading_by_its_own_noise(named):
    gain = named.gain
    weight = np.linspace(1.0, 9.0, gain.block.size)
    weighted = replace(gain, weight=weight)
    page = Page(diagnosis_page(replace(named, gain=weighted)))
    drawn = unpacked(page.traces("base model")[-1]["y"])
    shares = [weight[gain.block == b].sum() for b in np.unique(gain.block)]
    assert np.sqrt(np.average(drawn**2, weights=shares)) == pytest.approx(weighted.base)
    assert len(unpacked(page.traces("base model, noisier")[0]["x"])) == np.sum(weight < 9 / 4)


def test_an_axis_with_a_finer_scale_than_its_neighbour_states_it():
    small, large = np.array([-0.1, 0.1]), np.array([-5.0, 5.0])
    assert half_ranges([large, small], 0.0) == pytest.approx([5 * AXIS_MARGIN, 0.1 * AXIS_MARGIN])
    assert half_ranges([small, large], 0.0) == pytest.approx([5 * AXIS_MARGIN] * 2)
    assert half_ranges([large, small], 4.0) == pytest.approx([5 * AXIS_MARGIN] * 2)
    assert symmetric_layout("y", 0.1, [5.0, 0.1])["annotations"][0]["text"] == "axis 50 × finer"
    assert "annotations" not in symmetric_layout("y", 5.0, [5.0, 0.1])


def test_a_dotted_line_is_explained_only_where_one_can_be(named):
    twice = replace(named, timeline=replace(named.timeline, runs=named.timeline.runs * 2))
    assert "dotted lines" in diagnosis_caption(twice, dotted=True)[0]
    assert "dotted lines" not in diagnosis_caption(twice)[0]


def test_a_model_that_misses_more_than_before_is_no_good_news(named):
    worse = replace(named.error, extended=2 * named.error.base)
    assert "even on its own training points" in Page(diagnosis_page(replace(named, error=worse))).visible


def test_a_page_is_labelled_whole_and_loads_nothing(named, silent, tmp_path):
    for d in (named, silent):
        text = diagnosis_page(d)
        page = Page(text)
        assert page.visible.lstrip().startswith("TWIN")
        assert "rig one_wire_twin" in page.visible
        assert not re.search(r"\b(nan|None|inf)\b", page.visible)
        for plot in page.plots:
            go.Figure(plot["data"], {k: v for k, v in plot["layout"].items() if k != "narrow"})
            for side in ("xaxis", "yaxis"):
                assert "title" in plot["layout"][side]
        for name, attributes in page.tags:
            assert name not in ("link", "iframe", "object", "embed", "base", "img")
            for key in LOADING:
                assert attributes.get(key, "#").startswith("#")
        assert write_page(text, tmp_path / f"{d.verdict.word}.html").stat().st_size < 7_000_000


def test_in_a_notebook_it_shows_the_result_and_draws_both_models(named):
    display_html = Page(named._repr_html_())
    assert "ambient_drift" in display_html.visible
    assert "TWIN · simulated, not hardware" in display_html.visible
    drawn = {trace.name: np.asarray(trace.y, dtype=float) for trace in named.plot().data}
    page = Page(diagnosis_page(named))
    for which in ("base", "extended"):
        name = f"measured − {which} model"
        np.testing.assert_allclose(drawn[name], unpacked(page.traces(name)[0]["y"]))


def test_the_interval_of_a_parameter_stays_within_its_bounds(named):
    spread = dict.fromkeys(named.levels[-1].best.spread, 20.0)
    level = named.levels[-1]
    wide = SimpleNamespace(**vars(level) | {"best": replace(level.best, spread=spread)})
    page = Page(diagnosis_page(replace(named, levels=(wide,))))
    (cell,) = [row[0] for table in page.tables for row in table if row[0].startswith("ambient_drift: swing")]
    assert "(95 %: −5 to 5)" in cell
    assert "(95 %: 0.1 to 48)" in cell


def test_without_an_extended_model_the_text_states_the_base_model_only(named):
    gain = named.gain.without_extension()
    text = replace(nearest(named, "unknown"), gain=gain).text()
    assert "(extended model)" not in text
    assert f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g} mm" in text
    assert "→" not in text
    assert "(extended model)" in named.text()
    assert "→" in named.text()
