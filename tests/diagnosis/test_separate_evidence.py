"""The evidence of one effect: where it lies, and what remains of it beside a flexible discrepancy."""

from dataclasses import replace

import pytest
from smarig.diagnosis.explain.discrepancy import likeliest_discrepancy
from smarig.diagnosis.explain.search import _starts
from smarig.diagnosis.explain.separate_evidence import separate_evidence

from diagnosis.short_boxes import first_test, given_model, recorded, short_box
from smarig.diagnosis import Explanation, joint_density_from_best_start
from smarig.plant import POSITIONS, effect_types, effects_from_pairs

NUMBER = 1  # a box with one wire


@pytest.fixture(scope="module")
def lagging():
    """A wire with a longer time constant, recorded with its transients."""
    return recorded(short_box(NUMBER, {"wire_lag": {"change_percent": 50}}, ("transients",)))


@pytest.fixture(scope="module")
def found(lagging):
    """The evidence of the true effect."""
    given = given_model(NUMBER)
    effects = effects_from_pairs(["wire_lag=50"])
    model, refitted = joint_density_from_best_start(
        lagging, replace(given, effects=effects), given.hysteresis
    )
    best = Explanation(effects, model, refitted)
    (one,) = separate_evidence(lagging, best, likeliest_discrepancy(lagging, model, refitted))
    return one


def test_its_parts_add_up_to_its_gain(found):
    """But for the prior of the sizes of noise and density."""
    assert sum(found.by_kind.values()) == pytest.approx(found.nats, rel=0.1)


def test_a_lag_is_seen_in_moving_positions_and_no_discrepancy_replaces_it(found):
    assert found.own > 0.9 * found.nats > 100
    assert found.over_discrepancy > 0.5 * found.nats


def test_parts_of_a_classical_density_are_never_searched_for(lagging):
    """What shows the others: in short, the kinds of readings in which a density does not take them up."""
    hidden = {k.name for k in effect_types() if not k.shown_by}
    assert hidden == {"coulomb_friction", "end_conduction", "r_phase"}
    started = _starts(first_test(lagging, given_model(NUMBER)), 100)
    assert "wire_lag" in {e.kind.name for e in started}
    assert not hidden & {e.kind.name for e in started}
    kinds = {kind for k in effect_types() for kind in k.shown_by}
    assert kinds == {*POSITIONS, "current", "resistance"}
