"""Batches of inputs and many models along one input: bit for bit those of one operator after the other."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from preisach.test_kernel import ALL, KINDS, LOOPS, initials, needs_numba, walk
from smarig.core.errors import DataError, UsageError
from smarig.preisach import compiled
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.many_models import simulate_models
from smarig.preisach.operator import Preisach, State
from smarig.theory import MovingPreisach

Saturation = Literal["negative", "positive", "anhysteretic"]
STARTS: tuple[Saturation, ...] = ("negative", "positive", "anhysteretic")


def one_by_one(hystereses, inputs, initial) -> np.ndarray:
    return np.stack([Preisach(h, compiled=False).simulate(u, initial) for h in hystereses for u in inputs])


def tables(count: int) -> list[FodTable]:
    """Tables on the same nodes, as draws of a posterior are."""
    nodes = np.array([-185.0, -90.0, -10.0, 3.0, 60.0, 185.0])
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    y = thesis_surface("two_p").y(a, b)
    random = np.random.default_rng(8)
    return [
        FodTable.from_arrays(nodes, nodes, np.where(b <= a, y + random.normal(0, 1, y.shape), np.nan))
        for _ in range(count)
    ]


@pytest.mark.parametrize("compiled", LOOPS)
@given(name=st.sampled_from(sorted(KINDS)), initial=initials, rows=st.integers(1, 4), seed=st.integers(0, 99))
def test_each_row_of_a_batch_starts_from_the_initial_state(compiled, name, initial, rows, seed):
    inputs = np.stack([walk(40, seed + k) for k in range(rows)])
    operator = Preisach(KINDS[name], compiled=compiled)
    y = operator.simulate(inputs, initial)
    assert y.tolist() == one_by_one([KINDS[name]], inputs, initial).tolist()
    assert operator.state == Preisach(KINDS[name], initial).state  # where each of them began


@pytest.mark.parametrize("name", sorted(ALL))
def test_every_hysteresis_takes_a_batch_and_a_state(name):
    before = Preisach(ALL[name])
    before.follow(walk(30, 2))
    inputs = np.stack([walk(25, 5), walk(25, 6)])
    y = Preisach(ALL[name]).simulate(inputs, before.state)
    again = [Preisach(ALL[name], before.state) for _ in inputs]
    assert y.tolist() == [o.follow(u).tolist() for o, u in zip(again, inputs)]


@needs_numba
def test_threads_change_nothing(monkeypatch):
    monkeypatch.setattr(compiled, "WORTH_A_THREAD", 50)
    monkeypatch.setattr(compiled, "_processors", lambda: 3)
    inputs = np.stack([walk(60, k) for k in range(11)])
    y = Preisach(KINDS["table"], compiled=True).simulate(inputs)
    assert y.tolist() == one_by_one([KINDS["table"]], inputs, "negative").tolist()
    many = simulate_models(tables(7), inputs[0], "positive", compiled=True)
    assert many.tolist() == one_by_one(tables(7), inputs[:1], "positive").tolist()


def test_a_batch_without_rows_or_samples_is_empty():
    wire = Preisach(KINDS["two_e"])
    assert wire.simulate(np.empty((0, 5))).shape == (0, 5)
    assert wire.simulate(np.empty((3, 0))).shape == (3, 0)


def test_a_batch_names_where_it_is_not_a_number_and_other_shapes_are_refused():
    inputs = np.zeros((3, 4))
    inputs[1, 2] = np.nan
    wire = Preisach(KINDS["two_e"])
    with pytest.raises(DataError, match=r"Input 1 of the batch is NaN at sample 2"):
        wire.simulate(inputs)
    with pytest.raises(UsageError, match=r"got shape \(1, 1, 1\)"):
        wire.simulate(np.zeros((1, 1, 1)))
    with pytest.raises(UsageError, match=r"got shape \(3, 4\)"):
        wire.follow(np.zeros((3, 4)))


@pytest.mark.parametrize("use_compiled", LOOPS)
@pytest.mark.parametrize("initial", STARTS)
def test_many_models_are_their_operators(initial: Saturation, use_compiled: bool):
    u = walk(80, 3)
    y = simulate_models(tables(5), u, initial, compiled=use_compiled)
    assert y.tolist() == one_by_one(tables(5), [u], initial).tolist()


def test_an_extended_operator_takes_a_batch_too():
    model, inputs = MovingPreisach(thesis_surface("two_e"), 0.1), np.stack([walk(20, 1), walk(20, 2)])
    assert model.simulate(inputs).tolist() == [model.simulate(u).tolist() for u in inputs]


def test_many_models_may_be_of_any_kind():
    u, start = walk(30, 4), Preisach(KINDS["table"])
    start.follow([100.0, -20.0])
    y = simulate_models(list(KINDS.values()), u)
    assert y.tolist() == one_by_one(KINDS.values(), [u], "negative").tolist()
    own: State = start.state
    assert simulate_models([KINDS["table"]], u, own).tolist() == [start.follow(u).tolist()]
    with pytest.raises(UsageError, match="at least one hysteresis"):
        simulate_models([], u)
