"""Ascending curves are fitted as mirror images and drawn as measured."""

import numpy as np
import pytest

from report.pages import Page, unpacked
from smarig.identification.identify import identify
from smarig.record import load_run
from smarig.report.components.page import Section, page
from smarig.report.models import identification_plot_data
from smarig.runner.session import Session

pytestmark = pytest.mark.long("takes twenty seconds")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The same twin's hysteresis by descending and by ascending curves: (run, identification) each."""
    folder = tmp_path_factory.mktemp("mirror")
    found = []
    with Session("two_wire_twin", seed=5) as session:
        for protocol in ("first_order_descending", "first_order_ascending"):
            run = load_run(session.run(protocol, {}, folder / f"{protocol}.run.sqlite"))
            found.append((run, identify(run, surface="table")))
    return found


def test_measured_curves_are_the_measured_points(both):
    for run, found in both:
        points = {(round(u, 6), round(y, 9)) for u, y in zip(*run.points())}
        drawn = {
            (round(u, 6), round(y, 9))
            for c in identification_plot_data.measured_curves(found)
            for u, y in zip(c.u, c.y)
        }
        assert drawn <= points
        assert len(drawn) > 60


def test_the_density_is_the_same_from_either_side(both):
    (_, descending), (_, ascending) = both
    assert not descending.data.mirrored
    assert ascending.data.mirrored
    maps = [identification_plot_data.density_map(found) for found in (descending, ascending)]
    for first, second in zip(maps[0][:2], maps[1][:2]):
        np.testing.assert_allclose(first, second)
    mu, other = maps[0][2], maps[1][2]
    np.testing.assert_array_equal(np.isnan(mu), np.isnan(other))
    assert np.nanmax(np.abs(mu - other)) < 0.05 * np.nanmax(mu)


def test_the_replayed_model_goes_through_the_measured_points(both):
    for run, found in both:
        inputs, outputs = run.points()
        u, y = identification_plot_data.resimulated(found, inputs, 3)
        np.testing.assert_allclose(u[::3], inputs)
        assert np.abs(y[::3] - outputs).max() < 0.005 * np.ptp(outputs)


def test_a_page_of_ascending_curves_states_that_they_are_ascending(both):
    from smarig.report.models.first_order_figures import curves_figure, parameters_figure
    from smarig.report.models.plane_figures import surface_figure

    run, found = both[1]
    figures = [
        curves_figure(found, run),
        parameters_figure(found, run),
        surface_figure({"table": found}, "table", run),
    ]
    drawn = Page(page("t", "", [Section("s", "s", [f for f in figures if f])], label="TWIN"))
    assert "First-order ascending curves" in drawn.captions[0]
    assert "mirrored data" in drawn.captions[1]
    points = next(t for t in drawn.plots[-1]["data"] if t["type"] == "scatter3d")
    outputs = run.points()[1]
    assert outputs.min() - 1e-9 <= unpacked(points["z"]).min()
    assert unpacked(points["z"]).max() <= outputs.max() + 1e-9
    assert drawn.plots[-1]["layout"]["scene"]["yaxis"]["title"]["text"] == "β (K)"
