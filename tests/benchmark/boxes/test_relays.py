"""Relays switched in sorted order equal an array of relays switched one by one, exactly."""

import numpy as np
import pytest

from benchmark.boxes.small import few_relays
from benchmarks.boxes.relays import RelayHysteresis, Relays, demagnetised


class Naive:
    """Relays of which every one is evaluated at every step."""

    def __init__(self, h, on=False):
        self.h, self.on = h, np.full(h.alpha.size, on)

    def move(self, u):
        self.on = np.where(u >= self.h.alpha, True, np.where(u <= self.h.beta, False, self.on))
        return float(self.h.mass[self.on].sum() / self.h.mass.sum())


@pytest.mark.parametrize("seed", range(5))
def test_equal_to_the_naive_array_step_by_step(seed):
    h = few_relays("one_wire", 400, seed)
    rng = np.random.default_rng(seed)
    inputs = np.concatenate([rng.uniform(40, 130, 300), 85 + np.cumsum(rng.normal(0, 1, 700))])
    inputs[::17] = rng.choice(h.alpha, inputs[::17].size)  # on thresholds, too
    inputs[5::17] = rng.choice(h.beta, inputs[5::17].size)
    relays, naive = Relays(h), Naive(h)
    for u in inputs.tolist():
        assert relays.move(u) == naive.move(u)


def test_reversible_relays_and_equal_thresholds():
    alpha = np.array([1.0, 1.0, 2.0, 2.0, 3.0])
    h = RelayHysteresis(alpha, np.array([1.0, 0.5, 2.0, 0.5, 0.5]), np.arange(1.0, 6.0), 1.0, 0.0)
    relays, naive = Relays(h), Naive(h)
    for u in (0.7, 1.5, 1.0 + 1e-12, 2.5, 1.9, 0.9, 3.0, 0.5 + 1e-12, 0.5, 2.0):
        assert relays.move(u) == naive.move(u)


def test_without_feedback_a_coupled_move_is_a_plain_move():
    h = few_relays("one_wire", 400)
    plain, yielding = Relays(h), Relays(h)
    for u in np.random.default_rng(3).uniform(50, 120, 300).tolist():
        assert yielding.move_coupled(lambda share, u=u: u + 0 * share) == plain.move(u)
        assert yielding.u == plain.u


@pytest.mark.parametrize("shift_K", [12.0, 3.0, -6.0, -40.0])
def test_feedback_comes_to_rest_where_it_agrees_with_itself(shift_K):
    """The hysteresis input at the final share switches no further relay, to within the mass of one."""
    h = few_relays("one_wire", 1500)
    relays, at, one = Relays(h), 0.0, abs(shift_K) * h.mass.max() / h.mass.sum()
    rng = np.random.default_rng(4)
    for T in rng.uniform(40, 130, 200).tolist():
        rising = T - shift_K * relays.share > relays.u
        share = relays.move_coupled(lambda x, T=T: T - shift_K * x)
        hysteresis_input = T - shift_K * share
        assert (hysteresis_input <= relays.u + 1e-9) if rising else (hysteresis_input >= relays.u - 1e-9)
        assert abs(hysteresis_input - relays.u) <= one + 1e-9
        assert relays.move(relays.u) == share
        at += 1
    assert at == 200


def test_positive_feedback_is_an_avalanche_in_order():
    """Relays one by one, each at what the ones before it have made of the temperature."""
    h = few_relays("one_wire", 300)
    relays, on = Relays(h), np.zeros(300, dtype=bool)
    for T in np.linspace(60, 100, 81).tolist():
        share = relays.move_coupled(lambda x, T=T: T + 15.0 * x)
        while True:
            hysteresis_input = T + 15.0 * float(h.mass[on].sum() / h.mass.sum())
            ready = np.flatnonzero(~on & (h.alpha <= hysteresis_input))
            if not ready.size:
                break
            on[ready[np.argmin(h.alpha[ready])]] = True
        assert share == float(h.mass[on].sum() / h.mass.sum())


def test_a_decaying_oscillation_leaves_half_of_symmetric_relays_on():
    rng = np.random.default_rng(0)
    middle, width = rng.normal(0, 8, 2000), rng.uniform(20, 60, 2000)
    middle = np.concatenate([middle, -middle])
    width = np.concatenate([width, width])
    h = RelayHysteresis(middle + width / 2, middle - width / 2, np.ones(4000), 1.0, -0.5)
    assert demagnetised(h).share == pytest.approx(0.5, abs=0.03)
