"""Many hystereses along one input, many inputs through one hysteresis: what each alone would give."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarig.core.errors import DataError, UsageError
from smarig.preisach.batch import memory_trace, simulate_many
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach


def _table() -> FodTable:
    nodes = np.linspace(-185.0, 185.0, 9)
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, surface("two_p").y(a, b), np.nan))


def _measure() -> RelayMeasure:
    pair = np.sort(np.random.default_rng(41).integers(-185, 186, (150, 2)), axis=1).astype(float)
    ends = [185.0, -185.0, 185.0], [185.0, -185.0, -185.0]  # degenerate ones in both saturations too
    mass = np.random.default_rng(42).normal(0, 1, 153)
    return RelayMeasure.from_arrays([*pair[:, 1], *ends[0]], [*pair[:, 0], *ends[1]], mass)


SYSTEMS: list[Everett] = [
    surface("two_c"),
    surface("two_e"),
    _table(),
    _measure(),
    Mirrored(surface("two_p")),
]
SPAN = 35.0
initials = st.sampled_from(["negative", "positive", "anhysteretic"])
inputs = st.one_of(st.integers(-38, 38).map(lambda k: 5.0 * k), st.floats(-190, 190, width=32))
paths = st.lists(inputs, max_size=25)


def alone(systems, u, initial) -> np.ndarray:
    return np.array([Preisach(h, compiled=False).simulate(u, initial) for h in systems])


@given(initials, paths)
@example("anhysteretic", [50.0, 50.0, -50.0, 20.0, -190.0, -190.0, 30.0])
@example("negative", [100.0, -185.0, -185.0, 40.0, 40.0, 190.0, 190.0, 0.0])
@example("positive", [185.0, 185.0, 0.0])
def test_many_hystereses_along_one_input_are_each_alone(initial, path):
    together = simulate_many(SYSTEMS, path, initial)
    assert together.shape == (len(SYSTEMS), len(path))
    assert np.max(np.abs(together - alone(SYSTEMS, path, initial)), initial=0.0) <= 1e-12 * SPAN


@given(initials, paths, paths)
def test_a_state_to_start_from_gives_its_extrema(initial, before, path):
    """Each hysteresis has outputs of its own at the extrema of the one state."""
    starts = []
    for h in SYSTEMS:
        op = Preisach(h, initial)
        op.follow(before)
        starts.append(op.state)
    together = simulate_many(SYSTEMS, path, starts[0])
    each = [Preisach(h, s).follow(path) for h, s in zip(SYSTEMS, starts, strict=True)]
    assert np.max(np.abs(together - each), initial=0.0) <= 1e-12 * SPAN


@pytest.mark.parametrize("shape", ["walk", "decaying"])
def test_long_inputs_with_deep_memory(shape: str):
    rng = np.random.default_rng(43)
    n = 20_000
    oscillation = 184.0 * np.linspace(1, 0, n) * np.where(np.arange(n) % 2, -1.0, 1.0)
    u = {"walk": 185 * np.sin(np.cumsum(rng.normal(0, 0.1, n))), "decaying": oscillation}[shape]
    together = simulate_many(SYSTEMS[:4], u)
    assert np.max(np.abs(together - alone(SYSTEMS[:4], u, "negative"))) <= 1e-12 * SPAN


def test_ranges_may_differ():
    systems = [surface("one_c"), surface("two_c"), surface("one_e")]
    u = np.random.default_rng(44).uniform(-185, 185, 300)
    assert np.max(np.abs(simulate_many(systems, u) - alone(systems, u, "negative"))) <= 1e-12 * SPAN


@given(initials, st.integers(0, 4), st.integers(1, 20))
def test_many_inputs_through_one_hysteresis_are_each_alone(initial, k: int, n: int):
    u = np.random.default_rng(45).uniform(-190, 190, (k, n))
    outputs = simulate_many(SYSTEMS[1], u, initial)
    assert outputs.shape == (k, n)
    for row, y in zip(u, outputs, strict=True):
        assert np.array_equal(y, Preisach(SYSTEMS[1]).simulate(row, initial))


def test_a_trace_names_corners_and_parents():
    """90, then down to 40, up to 60, and beyond 90: the loop 40–60 hangs on 40 and is gone in the end."""
    found = memory_trace([90.0, 40.0, 60.0, 50.0, 100.0, 100.0, 0.0], 0.0, 174.1)
    hangs_on = found.u[found.parent[found.first :]].tolist()
    assert hangs_on == [0.0, 90.0, 40.0, 60.0, 0.0, 0.0, 0.0]
    assert found.alpha[found.first :].tolist() == [90.0, 90.0, 60.0, 60.0, 100.0, 100.0, 0.0]
    assert found.beta[found.first :].tolist() == [0.0, 40.0, 40.0, 50.0, 0.0, 0.0, 0.0]
    assert found.sign[found.first :].tolist() == [1, -1, 1, -1, 1, 1, 1]


def test_shapes_that_are_neither_are_refused():
    with pytest.raises(UsageError, match=r"One hysteresis takes inputs of shape \(k, n\), got \(3,\)"):
        simulate_many(SYSTEMS[0], [1.0, 2.0, 3.0])
    with pytest.raises(UsageError, match=r"Several hystereses share one input of shape \(n,\), got \(1, 2\)"):
        simulate_many(SYSTEMS, [[1.0, 2.0]])
    with pytest.raises(DataError, match="NaN as its input, at sample 1"):
        simulate_many(SYSTEMS, [1.0, float("nan")])
