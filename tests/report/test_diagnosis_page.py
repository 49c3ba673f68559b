"""The page of a diagnosis: its texts and figures, of a twin with an effect, for every verdict."""

import re
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from diagnosed_twin import WALKING, diagnosed_twin
from report.pages import LOADING, Page, unpacked
from smarig.diagnosis import CommandedDiagnosis
from smarig.diagnosis.comparison.verdict_rules import Verdict
from smarig.plant.effect_catalogue import effect_types
from smarig.report.components.figure import AXIS_MARGIN
from smarig.report.components.page import write_page
from smarig.report.diagnosis.diagnosis_predictions import DiagnosisPredictions, diagnosis_caption
from smarig.report.diagnosis.residual_figures import half_ranges, symmetric_layout
from smarig.report.diagnosis_page import diagnosis_page


@pytest.fixture(scope="module")
def named() -> CommandedDiagnosis:
    """A wire that walks, with few effects that compete, and one that needs a second wire."""
    found = diagnosed_twin().diagnosis
    unseen = next(k for k in effect_types() if k.name == "cross_talk")
    return replace(found, subject=replace(found.subject, catalogue=(*found.subject.catalogue, unseen)))


@pytest.fixture(scope="module")
def silent(named) -> CommandedDiagnosis:
    """The same evidence where nothing is likely, and no run was held out."""
    return replace(named, verdict=Verdict("silent", "nothing"), extended=False, gain=None)


@pytest.fixture
def named_page(named) -> Page:
    return Page(diagnosis_page(named))


def under(d: CommandedDiagnosis, word) -> CommandedDiagnosis:
    """The same evidence under another verdict."""
    verdicts = {
        "ambiguous": Verdict("ambiguous", "shared", ("walking", "slip")),
        "unknown": Verdict("unknown", "variable", (), "time"),
        "not_identifiable": Verdict("not_identifiable", "not_testable"),
    }
    return replace(d, verdict=verdicts[word])


@pytest.mark.long("takes two seconds")
def test_a_named_effect_stands_first_with_its_interval_probability_and_what_it_does(named, named_page):
    value = named.effects()[0]["parameters"]["percent_per_cycle"]
    low, high = value["ci95"]
    words = named_page.visible[named_page.visible.index("Found: ") :]
    assert words.startswith(f"Found: walking (rate {value['value']:.3g} [{low:.3g}, {high:.3g}] %/cycle")
    assert "With every full cycle the position rises by" in words
    assert low < WALKING < high


def test_the_cards_show_errors_and_gain(named, named_page):
    e = named.error
    assert f"{e.base:.3g} → {e.extended:.3g}" in named_page.card("Settled points, rms (mm)")
    share = named_page.card("Removable share")
    assert float(share.split("R = ")[1][:4]) == pytest.approx(named.gain.removable_share, abs=0.01)
    assert str(len(named.timeline.settled)) in named_page.card("Settled points used")


def test_steps_that_had_not_settled_are_reported(named):
    run = named.timeline.runs[0]
    late = [replace(step, verdict="timed_out") if k in (1, 4) else step for k, step in enumerate(run.steps)]
    timeline = replace(named.timeline, runs=(replace(run, steps=tuple(late)), *named.timeline.runs[1:]))
    words = f"2 of {len(named.timeline.settled)} settled points had not settled by their time limit."
    assert words in replace(named, subject=replace(named.subject, timeline=timeline)).text()
    assert "had not settled" not in named.text()


def test_a_diagnosis_without_finding_states_it_and_shows_no_extended_model(silent):
    page = Page(diagnosis_page(silent))
    assert "Nothing stands out" in page.visible
    assert "no held-out run" in page.card("Gain on held-out data")
    assert not page.traces("extended model")


def test_no_experiment_is_needed_only_where_everything_was_tested(named, silent, monkeypatch):
    """Effects that these runs cannot show, no held-out run, a given model that is far off: each is left open."""
    after = lambda d: Page(diagnosis_page(d)).visible.split("The next experiment")[-1]  # noqa: E731
    assert silent.not_identifiable
    assert "No experiment is needed" not in after(silent)
    assert "No run was held out" in after(silent)
    assert "lists effects that may be present" in after(silent)
    tested = replace(silent, gain=named.gain)
    assert "No run was held out" not in after(tested)
    assert "No experiment is needed" not in after(tested)
    monkeypatch.setattr(CommandedDiagnosis, "not_identifiable", ())
    assert "No experiment is needed" in after(tested)
    assert "No experiment is needed" not in after(silent)
    monkeypatch.setattr(CommandedDiagnosis, "given_is_far", True)
    assert "The given model is far from these data" in after(tested)
    assert "No experiment is needed" not in after(tested)


def test_a_silent_diagnosis_says_on_what_it_was_tested(named, silent):
    shown = len(silent.subject.catalogue) - len(silent.not_identifiable)
    points = len(silent.timeline.settled)
    line = next(line for line in silent.lines() if line.startswith("Tested: "))
    assert line.startswith(
        f"Tested: {shown} of {len(silent.subject.catalogue)} effects, on {points} settled points in "
    )
    assert line.endswith("excursions; no run was held out.")
    assert f"held out: {named.gain.blocks} blocks" in replace(silent, gain=named.gain).text()
    assert "Tested: " not in named.text()


def test_runs_with_few_excursions_say_that_they_could_name_nothing(silent):
    few, many = (replace(silent, evidence=replace(silent.evidence, blocks=n)) for n in (3, 30))
    words = "The runs have 3 excursions, too few for the name of a cause."
    assert words in Page(diagnosis_page(few)).visible
    assert "too few for the name" not in Page(diagnosis_page(many)).visible


def test_what_scatters_along_the_input_is_not_taken_for_the_room(named_page):
    assert named_page.row("Noise of the wire's temperature, σ of the input")
    assert "mbient fluctuation" not in named_page.visible


@pytest.mark.parametrize(
    ("word", "sentence", "advice"),
    [
        ("ambiguous", "The truth is likely among these: walking", "What would decide between them"),
        ("unknown", "Something is wrong and depends on the time", "Repeat the same run later"),
        ("not_identifiable", "These data cannot show any effect", "Make a run that can show an effect"),
    ],
)
def test_every_other_verdict_has_its_sentence_and_advice(named, word, sentence, advice):
    page = Page(diagnosis_page(under(named, word)))
    assert sentence in page.visible
    assert advice in page.visible[page.visible.index("The next experiment") :]


def test_causes_are_drawn_and_listed_with_their_probabilities(named, named_page):
    table = next(t for t in named_page.tables if t[0][0] == "Cause")
    likely = {p.name: w for p, w in named.causes.items() if p.kind == "effect" and w >= 0.01}
    listed = {row[0]: float(row[1]) for row in table[1:]}
    assert {name: listed[name] for name in likely} == pytest.approx(likely, abs=0.005)
    bars = next(t for plot in named_page.plots for t in plot["data"] if t.get("orientation") == "h")
    assert unpacked(bars["x"]).max() == pytest.approx(named.causes[next(iter(named.causes))])


def test_hypotheses_are_listed_heaviest_first_above_nothing(named, named_page):
    table = next(t for t in named_page.tables if t[0][0] == "Hypothesis")
    heaviest, nothing = named.weights.heaviest, named.found.hypotheses[0]
    assert table[1][0] == heaviest.name
    assert float(table[1][2].replace("−", "-")) == pytest.approx(heaviest.score - nothing.score, abs=0.06)


def test_the_residuals_drawn_are_measured_minus_each_model(named, named_page):
    predictions = DiagnosisPredictions.of(named)
    for name, whole in (("base", predictions.base), ("extended", predictions.extended)):
        drawn = unpacked(named_page.traces(f"measured − {name} model")[0]["y"])
        np.testing.assert_allclose(drawn, predictions.residuals(whole, "settled"))
        assert np.std(drawn) == pytest.approx(getattr(named.error, name), rel=1e-6)


def test_effects_that_the_data_cannot_show_are_listed_with_what_would_show_them(named, named_page):
    known = {k.name: k for k in effect_types()}
    assert named.not_identifiable
    after = named_page.visible[named_page.visible.index("cannot show at any strength, and") :]
    for name in named.not_identifiable:
        assert f"{name}. {known[name].summary} What shows it: " in after


def test_the_noise_is_that_of_both_models(named, named_page):
    row = named_page.row("Settled position")
    assert float(row[1]) == pytest.approx(named.subject.base.refitted.noise.settled, rel=0.01)
    assert float(row[2]) == pytest.approx(named.noise.settled, rel=0.01)


def test_a_separating_run_is_printed(named):
    run = {"protocol": "pause_an_hour", "why": "The room goes on, cycles do not.", "rig_hours": 2.5}
    words = Page(diagnosis_page(replace(named, separating_run=run))).visible
    assert "pause_an_hour, 2.50 h on the rig" in words
    assert "The room goes on, cycles do not." in words


def test_every_block_held_out_is_drawn(named, named_page):
    blocks = unpacked(named_page.traces("base model")[-1]["x"])
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
    timeline = replace(named.timeline, runs=named.timeline.runs * 2)
    twice = replace(named, subject=replace(named.subject, timeline=timeline))
    assert "dotted lines" in diagnosis_caption(twice, dotted=True)[0]
    assert "dotted lines" not in diagnosis_caption(twice)[0]


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


def test_in_a_notebook_it_shows_the_result_and_draws_both_models(named, named_page):
    display_html = Page(named._repr_html_())
    assert "walking" in display_html.visible
    assert "TWIN · simulated, not hardware" in display_html.visible
    drawn = {trace.name: np.asarray(trace.y, dtype=float) for trace in named.plot().data}
    for which in ("base", "extended"):
        name = f"measured − {which} model"
        np.testing.assert_allclose(drawn[name], unpacked(named_page.traces(name)[0]["y"]))


def test_without_an_extended_model_the_text_states_the_base_model_only(named):
    gain = named.gain.without_extension()
    text = replace(under(named, "unknown"), gain=gain, extended=False).text()
    assert "(extended model)" not in text
    assert f"Held-out runs, {gain.blocks} blocks: rms error {gain.base:.4g} mm" in text
    assert "→" not in text
    assert "(extended model)" in named.text()
    assert "→" in named.text()
