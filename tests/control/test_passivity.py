"""Thm 8.1 against relays with their own switching work: supplied energy, its bound, and cases in which
neither holds."""

import numpy as np
import pytest
from hypothesis import assume, given

from smarig.certificate.passivity import counterexample, passivity
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach
from smarig.theory.butterfly import butterfly_relays
from smarig.theory.energy import certify
from theory.energy.relay_energy import LEVELS, Game, Relays, histories, relays


def after(measure, past) -> tuple[RelayMeasure, Preisach, Relays]:
    """The package's operator and the reference's relays, both after a past from negative saturation."""
    made = RelayMeasure.from_arrays(*measure)
    operator, reference = Preisach(made), Relays.off(*measure, u=LEVELS[0]).along(past)
    operator.follow(past)
    reference.supplied = 0.0
    return made, operator, reference


def paid(reference: Relays, inputs) -> np.ndarray:
    supplied = []
    for u in inputs:
        reference.go(u)
        supplied.append(reference.supplied)
    return np.array(supplied)


@given(relays(low=0.0), histories(), histories())
def test_from_rest_the_supplied_energy_is_never_negative(measure, past, inputs):
    made, operator, reference = after(measure, [*past, 0.0])
    found = passivity(made, inputs, operator.state)
    energies = paid(reference, inputs)
    assert energies.min() >= -1e-9, "the theorem, by the relays' own account"
    np.testing.assert_allclose(found.supplied, energies, atol=1e-9)
    assert (found.bound, found.passive, found.within, found.failing) == (0.0, True, True, ())


@given(relays(low=0.0), histories(), histories())
def test_from_any_state_the_return_to_zero_attains_the_bound(measure, past, inputs):
    made, operator, reference = after(measure, past)
    stored, state = reference.stored, operator.state
    found = passivity(made, inputs, state)
    assert found.bound == pytest.approx(-stored, abs=1e-9)
    assert found.within
    assert paid(reference, inputs).min() >= -stored - 1e-9
    home = passivity(made, [0.0], state)
    assert home.supplied[-1] == pytest.approx(-stored, abs=1e-9)


@pytest.mark.long("takes a second")
@given(relays(low=-0.25), histories(), histories())
def test_signed_but_dissipative_measures_keep_the_available_storage_as_bound(measure, past, inputs):
    game = Game.of(*measure, LEVELS.tolist())
    best = game.best()
    assume(best is not None and np.min(measure[2]) < 0)
    made, operator, reference = after(measure, past)
    storage = best[game.start[Game.key(reference)]]
    found = passivity(made, inputs, operator.state)
    assert found.bound == pytest.approx(-storage, abs=1e-6)
    assert found.within
    assert paid(reference, inputs).min() >= -storage - 1e-6
    _, place = np.unique(np.stack(measure[:2]), axis=1, return_inverse=True)
    negative = np.bincount(place.ravel(), measure[2]).min() < 0
    assert ("ν ≥ 0" in [h.name for h in found.failing]) == negative


def test_rest_alone_is_not_enough_without_positivity():
    """Dissipative, u(0) = 0, and yet a bias: a negative relay gives energy as it switches up, and costs it later."""
    made = RelayMeasure.from_arrays([0.0, 1.0, 2.0], [-2.0, -2.0, -2.0], [1.0, -0.5, 1.0])
    operator = Preisach(made)
    operator.step(0.0)
    found = passivity(made, [1.0, -1.0], operator.state)
    assert certify(made).dissipative
    assert (found.basis, found.passive) == ("dissipative", False)
    assert found.bound == pytest.approx(-1.0, abs=1e-12)
    assert found.supplied[0] == pytest.approx(-1.0, abs=1e-12), "2 · (−0.5) · 1, by hand"
    assert [h.name for h in found.failing] == ["ν ≥ 0"]


@pytest.mark.parametrize("name", ["one_e", "two_e"])
def test_the_e_surfaces_are_passive_although_they_are_not_positive(name: str):
    model = thesis_surface(name)
    rng = np.random.default_rng(3)
    inputs = rng.uniform(model.lower, model.upper, 300)
    operator = Preisach(model, "anhysteretic")
    operator.follow([100.0, model.lower / 3, 0.0])
    found = passivity(model, inputs, operator.state)
    assert (found.basis, found.bound, found.passive, found.within) == ("recoverable", 0.0, True, True)
    assert [h.name for h in found.failing] == ["ν ≥ 0"]
    assert found.supplied[-1] == pytest.approx(by_outputs(model, inputs, operator.state), rel=1e-4)


def by_outputs(model, inputs, state) -> float:
    """∫ u dy by the trapezoid over the operator's outputs alone, many to a move."""
    turns = np.concatenate([[state.u], inputs])
    u = np.concatenate([np.linspace(a, b, 400) for a, b in zip(turns, turns[1:])])
    return float(np.trapezoid(u, Preisach(model).simulate(u, state)))


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "one_p-negative",
        "two_p-anhysteretic",
    ),
)
@pytest.mark.parametrize(("name", "start"), [("one_p", "negative"), ("two_p", "anhysteretic")])
def test_the_p_surfaces_are_broken_by_a_loop(name: str, start):
    model = thesis_surface(name)
    found = counterexample(model, start)
    _, low, high = found.violation.turning_points
    operator = Preisach(model, start)
    operator.follow([low, high])
    each = by_outputs(model, np.array([low, high]), operator.state)
    assert each < 0
    assert each == pytest.approx(found.violation.per_cycle, rel=0.02)
    for bound in (0.0, 1e3, 1e6):
        n = found.cycles_below(bound)
        assert found.supplied_after(n) < -bound <= found.supplied_after(n - 1)
    verdict = passivity(model, [high], start)
    assert verdict.bound == -np.inf
    assert verdict.text.startswith("Not passive with any bias")


@pytest.mark.long("takes two seconds")
def test_the_input_that_breaks_two_p_does_so_by_exact_work_too():
    model, found = thesis_surface("two_p"), counterexample(thesis_surface("two_p"), "anhysteretic")
    n = found.cycles_below(0.0)
    found_again = passivity(model, found.inputs(n)[1:], "anhysteretic")
    assert found_again.supplied[-1] < 0
    assert found_again.supplied[-1] == pytest.approx(found.supplied_after(n), abs=1e-6)
    assert found_again.supplied[1:-2:2].min() >= 0.0, "and no cycle before"


def test_a_loop_of_relays_breaks_the_butterfly():
    found = counterexample(butterfly_relays())
    assert found.supplied_after(found.cycles_below(5.0)) < -5.0


def test_what_is_passive_is_not_broken():
    with pytest.raises(UsageError, match="Dissipative"):
        counterexample(thesis_surface("one_c"))


def test_the_hypothesis_that_fails_is_named():
    found = passivity(thesis_surface("two_c"), [0.0, 50.0], "positive")
    assert [h.name for h in found.failing] == ["u(0) = 0"]
    assert "begins at 185" in found.text
    assert found.bound == pytest.approx(found.supplied.min(), rel=1e-9), "the return to zero attains it"
