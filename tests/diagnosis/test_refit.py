"""The joint refit of readings: the likelihood is that of the readings, and the fitted density predicts them."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.refit import refit
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.replay import build_timeline, predict


@pytest.fixture(scope="module")
def timeline(tmp_path_factory):
    """Settled positions alone: what moves is known the worse the faster it is believed to move."""
    runs = session_runs(tmp_path_factory.mktemp("refit"), LONG, LISTED, LONG)
    return replace(build_timeline(runs, twin_plant_model()[0].actuator.tau_s), other_readings=())


def plant_model(hysteresis=None):
    wire, per_count = twin_plant_model()
    return replace(wire, per_count=per_count, hysteresis=hysteresis or wire.hysteresis)


def refitted(timeline, plant_model):
    return refit(timeline, predict(timeline, plant_model), plant_model)


def off(timeline, hysteresis):
    """Rms error of settled positions, up to a constant."""
    return np.std(timeline.settled.value - predict(timeline, plant_model(hysteresis)).values["settled"])


@pytest.fixture(scope="module")
def fair(timeline):
    """A table that predicts the timeline."""
    table = refitted(timeline, plant_model()).posterior.table()
    return refitted(timeline, plant_model(table)).posterior.table()


def later(table, power):
    """The table, transforming at other temperatures between the same ends: higher below a power of one."""
    share = (table.nodes - table.lower) / (table.upper - table.lower)
    return FodTable(table.lower + share**power * (table.upper - table.lower), table.values, table.unit)


@pytest.mark.long("takes two seconds")
def test_the_evidence_does_not_depend_on_the_models_stroke(timeline, fair):
    """A wrong stroke only changes what readings are divided by, all of them by two."""
    larger = FodTable(fair.nodes, 2.0 * fair.values, fair.unit)
    small, large = (refitted(timeline, plant_model(h)) for h in (fair, larger))
    assert large.log_evidence == pytest.approx(small.log_evidence, abs=1.5)
    np.testing.assert_allclose(large.scale, 2.0 * small.scale)


def least_step(hysteresis):
    """The least rise of the FOD surface in α, mm."""
    nodes = np.linspace(hysteresis.lower, hysteresis.upper, 97)
    alpha, beta = np.meshgrid(nodes, nodes, indexing="ij")
    y = np.where(beta <= alpha, hysteresis.y(alpha, np.minimum(alpha, beta)), np.nan)
    return float(np.nanmin(np.diff(y, axis=0)))


@pytest.mark.long("takes two seconds")
def test_the_density_of_a_refit_predicts_what_a_wrong_one_missed(timeline, fair):
    wrong = later(fair, 0.94)
    found = refitted(timeline, plant_model(wrong)).posterior.table()
    assert off(timeline, found) < 0.2 * off(timeline, wrong)
    assert off(timeline, fair) < 0.005
    assert np.diff(found.values[:, 0]).max() < 1e-9  # in saturation nothing is on


def test_a_refit_puts_no_negative_mass_where_the_model_has_none(timeline):
    """``one_c`` is positive, and so is what is found from a wrong density as positive."""
    positive = thesis_surface("one_c")
    assert least_step(positive) > -1e-9
    wrong = later(refitted(timeline, plant_model(positive)).posterior.table(), 0.94)
    found = refitted(timeline, plant_model(wrong)).posterior.table()
    assert off(timeline, found) < 0.2 * off(timeline, wrong)
    assert least_step(found) > -1e-9


def test_the_more_a_density_is_wrong_the_less_its_evidence(timeline, fair):
    evidence = [refitted(timeline, plant_model(later(fair, p))).log_evidence for p in (1.0, 0.9, 0.75)]
    assert evidence[0] > evidence[1] + 3 > evidence[2] + 6
