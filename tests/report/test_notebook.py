"""The representations in a notebook: small, labelled and escaped; with one figure each on request."""

from dataclasses import replace

import numpy as np
import pytest

import smarig
from report.pages import Page, run_of
from smarig.core.errors import UsageError
from smarig.record import load_run
from smarig.runner.session import Session

LIGHT, FIGURE = 20_000, 400_000  # bytes


@pytest.fixture(scope="module")
def wire(tmp_path_factory):
    file = tmp_path_factory.mktemp("wire") / "c.run.sqlite"
    with Session("one_wire_twin", seed=3) as session:
        session.run("first_order_descending", {"partition_K": (0, 50, 70, 90, 110, 160)}, file)
    run = load_run(file)
    return run, smarig.identify(run, "exponential").model


@pytest.mark.long("takes two seconds")
def test_a_run_and_a_model_show_themselves_in_a_few_kilobytes(wire):
    for thing, words in zip(wire, ("First order descending on one_wire_twin", "Exponential surface")):
        display_html = thing._repr_html_()
        assert len(display_html.encode()) < LIGHT
        assert words in Page(display_html).visible
        assert "TWIN · simulated, not hardware" in Page(display_html).visible
        assert [attrs["role"] for name, attrs in Page(display_html).tags if name == "svg"] == ["img"]


def test_what_a_person_typed_does_not_become_markup():
    display_html = run_of(protocol="<img src=x>")._repr_html_()
    assert "<img" not in display_html


def test_a_figure_that_cannot_be_drawn_gives_a_message_instead_of_an_error():
    not_steps: tuple = ("<yesterday>",)
    display_html = replace(run_of(), steps=not_steps)._repr_html_()
    assert Page(display_html).visible.startswith("This Run cannot be drawn (AttributeError: ")
    assert "<yesterday>" not in display_html


def test_a_run_is_plotted_with_the_models_answer(wire):
    run, model = wire
    figure = run.plot(model)
    measured, predicted, settled = figure.data
    assert len(measured.x) > 3 * len(settled.x)
    np.testing.assert_allclose(settled.x, run.points()[0])
    late = np.asarray(measured.x) > 5
    assert np.sqrt(np.mean((np.asarray(predicted.y) - np.asarray(measured.y))[late] ** 2)) < 0.1
    assert figure.layout.xaxis.title.text == "Wire temperature above ambient (K)"
    assert [note.text for note in figure.layout.annotations] == ["TWIN"]


def test_a_models_density_is_plotted(wire):
    figure = wire[1].plot()
    assert "heatmap" in [trace.type for trace in figure.data]
    assert len(figure.to_json()) < FIGURE


def test_a_hundred_thousand_samples_make_no_heavy_figure_and_lose_no_extreme():
    t = np.linspace(0, 60, 100_000)
    run = run_of(
        {"input": np.sin(t), "position": np.cos(t) + np.exp(-((t - 30) ** 2) * 1e4)}, source="import"
    )
    figure = smarig.plot(run)
    assert len(figure.to_json()) < FIGURE
    assert max(figure.data[0].y) == pytest.approx(run["position"].max())


def test_a_figure_is_shown_where_plotly_is_not(wire):
    bundle = wire[0].plot(wire[1])._repr_mimebundle_()
    assert bundle["image/svg+xml"].startswith("<svg")
    assert "application/vnd.plotly.v1+json" in bundle
    assert "text/html" not in bundle
    assert wire[0].plot()._repr_html_() is None


def test_a_figure_is_drawn_on_given_axes(wire):
    from matplotlib.figure import Figure

    run, model = wire
    ax = Figure().add_subplot()
    assert run.plot(model, ax=ax) is ax
    assert [text.get_text() for text in ax.get_legend().get_texts()][-2:] == ["model", "settled points"]
    assert ax.get_xlabel() == "Wire temperature above ambient (K)"
    np.testing.assert_allclose(np.sort(ax.lines[-1].get_xdata()), np.sort(run.points()[0]), rtol=1e-6)


def test_results_show_table_and_verdict(wire):
    run, _ = wire
    found = smarig.identify(run, "exponential")
    assert "Fit: at the noise floor: good" in Page(found._repr_html_()).visible
    assert [trace.name for trace in found.plot().data][-1] == "measured"
    checked = smarig.verify(found.model, [run])
    assert Page(checked._repr_html_()).row("c.run.sqlite")[-1] == "at the noise floor: good"
    assert len(checked.plot().data[-1].x) == len(run.settled)


def test_anything_else_is_refused_in_a_sentence():
    with pytest.raises(UsageError, match="Pass a run, a model, a diagnosis"):
        smarig.plot(3)


@pytest.mark.parametrize("wrong", [3, "x", [1], np.array([])])
def test_what_are_no_axes_is_refused_in_a_sentence(wire, wrong):
    with pytest.raises(UsageError, match="axes of one plot"):
        wire[0].plot(ax=wrong)
