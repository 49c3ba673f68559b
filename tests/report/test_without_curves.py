"""The characterisation page of a positive measure whose runs hold no first-order curves, and of ascending ones."""

import numpy as np
import pytest

from identification.made_runs import PARTITION, driven_run, fod_inputs, made_run
from report.pages import Page, unpacked
from smarig.identification.identify import identify
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.operator import Preisach
from smarig.record import Run
from smarig.report.characterisation_page import characterisation_page
from smarig.report.components.page import Section, page
from smarig.report.models import identification_plot_data
from smarig.report.models.evidence import Evidence
from smarig.report.models.first_order_figures import curves_figure

GROWING = [
    0,
    10,
    20,
    0,
    -20,
    0,
    20,
    40,
    10,
    -20,
    -45,
    -10,
    30,
    70,
    20,
    -30,
    -75,
    -20,
    40,
    100,
    30,
    -60,
    -110,
    130,
]


def of(run, found):
    return Evidence("A wire", {"loops": run}, (), {"positive": found}, "positive", {}, (), (), "made", 0.0)


@pytest.mark.long("takes a second")
def test_a_page_without_first_order_curves_states_it():
    run = driven_run("two_c", GROWING, seed=3, initial="anhysteretic", source="bench")
    found = identify(run, "positive")
    drawn = Page(characterisation_page(of(run, found)))
    assert "contain no first-order curves" in drawn.visible
    assert not any("First-order descending curves and" in c for c in drawn.captions)
    assert f"{len(GROWING)} with known memory used" in drawn.card("Settled points")
    assert "No such curve was measured" in " ".join(drawn.captions)
    assert "The positive model is in MP" in drawn.visible
    replay = next(t for t in drawn.traces("model, μ ≥ 0"))
    u, y = unpacked(replay["x"]), unpacked(replay["y"])
    np.testing.assert_allclose(u[::12], GROWING, rtol=1e-5, atol=1e-4)
    assert np.abs(y[::12] - run.points()[1]).max() < 1.0  # of 33 degrees: it starts where the run did


@pytest.fixture(scope="module")
def ascending():
    """A run of ascending curves, and the positive measure of all its points: not in the mirror itself."""
    rises = [-u for u in fod_inputs([-v for v in reversed(PARTITION["two"])])]
    run = driven_run("two_e", [-185.0, *rises], seed=2)
    return run, identify(run, "positive")


def test_the_image_of_a_table_is_exact():
    table = identify(
        driven_run("two_c", GROWING, seed=1, initial="anhysteretic"), "positive"
    ).model.hysteresis
    assert isinstance(table, FodTable)
    image = identification_plot_data.mirrored_table(table)
    walk = np.random.default_rng(4).uniform(image.lower, image.upper, 300)
    there = Preisach.from_surface(image).simulate(walk)
    np.testing.assert_allclose(there, Preisach.from_surface(Mirrored(table)).simulate(walk), atol=1e-10)


def test_ascending_curves_are_drawn_as_measured_though_nothing_was_mirrored(ascending):
    run, found = ascending
    assert found.data.mirrored
    assert not found.model.mirrored
    points = {(round(u, 6), round(y, 9)) for u, y in zip(*run.points())}
    measured = identification_plot_data.measured_curves(found)
    assert {(round(u, 6), round(y, 9)) for c in measured for u, y in zip(c.u, c.y)} <= points
    _, _, error = identification_plot_data.residuals(found)
    assert np.sqrt(np.mean(error**2)) < 0.4  # of 33 degrees
    figure = curves_figure(found, run)
    drawn = Page(page("t", "", [Section("s", "s", [figure])], label="TWIN"))
    assert "First-order ascending curves and the positive model" in drawn.captions[0]
    assert f"rms {np.sqrt(np.mean(error**2)):.3g}" in drawn.captions[0]
    assert not drawn.traces("90 % interval")  # its intervals are those of descending curves


def test_the_density_is_drawn_where_it_is(ascending):
    _, found = ascending
    alpha, beta, mu = identification_plot_data.density_map(found)
    table = found.model.hysteresis
    np.testing.assert_allclose(alpha, table.nodes, atol=1e-9)
    mass = table.everett(alpha[9], beta[3]) - table.everett(alpha[8], beta[3])
    mass -= table.everett(alpha[9], beta[4]) - table.everett(alpha[8], beta[4])
    area = (alpha[9] - alpha[8]) * (beta[4] - beta[3])
    assert mu[8, 3] == pytest.approx(mass / (2 * area), abs=1e-9 * np.nanmax(mu))
    assert np.nanmin(mu) > -1e-12 * np.nanmax(mu)


def test_reversal_curves_have_their_intervals_in_the_signs_of_the_measurement():
    fields = np.linspace(-185.0, 185.0, 24)
    truth = Preisach.from_surface(thesis_surface("two_c"))
    curves = [fields[k:] for k in range(0, 22, 3)]
    u = np.concatenate(curves)
    y = np.concatenate([truth.simulate(np.concatenate([[185.0], c]))[1:] for c in curves])
    y += np.random.default_rng(0).normal(0, 0.05, y.size)
    run = made_run(u, y, unit="emu", initial=None, protocol="first_order_reversal_curves")
    step = np.concatenate([np.full(c.size, float(k)) for k, c in enumerate(curves)])
    run = Run(run.path, run.meta, run.columns | {"step": step}, (), ())
    found = identify(run, "positive")
    model, measured = (
        identification_plot_data.model_curves(found),
        identification_plot_data.measured_curves(found),
    )
    inside = []
    for curve, seen in zip(model, measured, strict=True):
        low, high = identification_plot_data.interval(found, curve)
        order = np.argsort(curve.u)
        assert np.all((low <= curve.y + 1e-9) & (curve.y <= high + 1e-9))
        assert np.all(np.diff(low[order]) >= 0)
        assert np.all(np.diff(high[order]) >= 0)
        ends = [np.interp(seen.u, curve.u[order], end[order]) for end in (low, high)]
        inside += ((ends[0] <= seen.y) & (seen.y <= ends[1])).tolist()
    assert np.mean(inside) > 0.85
