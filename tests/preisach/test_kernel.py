"""The kernel, plain and compiled: relays, steps, runs in pieces and restored states give the same output."""

import json
import tracemalloc
from typing import Literal

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from preisach.relay_reference import Relays, histories
from smarig.core.errors import DataError, UsageError
from smarig.preisach.compiled import compiled_available
from smarig.preisach.compiled_loop import bucketed, rank
from smarig.preisach.everett import Everett, from_diagonal
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.forc_curve import ForcCurve
from smarig.preisach.hysteresis.forc_table import ForcTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.kernel import CHUNK
from smarig.preisach.operator import Preisach, State

needs_numba = pytest.mark.skipif(not compiled_available(), reason="numba (extra `fast`) is not installed")
LOOPS = [pytest.param(False, id="plain"), pytest.param(True, id="compiled", marks=needs_numba)]


def _uneven_nodes() -> np.ndarray:
    return np.array([-185.0, -120.0, -119.0, -40.0, -3.0, 5.0, 60.0, 61.0, 62.5, 140.0, 185.0])


def _table() -> FodTable:
    nodes = _uneven_nodes()
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, thesis_surface("two_p").y(a, b), np.nan))


def _measure(count: int = 200, seed: int = 1) -> RelayMeasure:
    rng = np.random.default_rng(seed)
    pair = np.sort(np.round(rng.normal(0, 60, (count, 2)).clip(-184, 184)), axis=1)  # clustered thresholds
    mass = rng.normal(0.2, 1, count)
    return RelayMeasure.from_arrays([*pair[:, 1], 185.0], [*pair[:, 0], -185.0], [*mass, 0.1])


def _curves() -> ForcTable:
    tops = np.linspace(-150.0, 185.0, 7)
    downs = [np.linspace(top, -185.0, 5 + k) for k, top in enumerate(tops)]
    return ForcTable.from_curves([ForcCurve(b[0], b, thesis_surface("two_c").y(b[0], b)) for b in downs])


KINDS: dict[str, Everett] = {
    "measure": _measure(),
    "table": _table(),
    **{name: thesis_surface(name) for name in ("two_c", "two_p", "two_e")},
}
OTHERS: dict[str, Everett] = {"mirror": Mirrored(thesis_surface("two_e")), "curves": _curves()}
ALL = {**KINDS, **OTHERS, "mirrored measure": Mirrored(_measure())}
initials = st.sampled_from(["negative", "positive", "anhysteretic"])
inputs = st.one_of(st.integers(-38, 38).map(lambda k: 5.0 * k), st.floats(-190, 190, width=32))
paths = st.lists(inputs, min_size=1, max_size=25)


def walk(n: int, seed: int, reach: float = 188.0) -> np.ndarray:
    """A walk over the whole range and a little beyond; about every eighth sample stands still."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(0, 9, n) * (rng.random(n) > 0.12)
    return np.abs((np.cumsum(steps) + reach) % (4 * reach) - 2 * reach) - reach


# --- against relays -----------------------------------------------------------------------------------


def _fine_measure() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    lattice = np.array([0.0, 1.0, 40.0, 40.5, 41.0, 100.0, 160.0, 161.0, 200.0])
    pair = np.sort(rng.choice(lattice, (150, 2)), axis=1)
    pair = np.vstack([pair[(pair[:, 1] < 200) & (pair[:, 0] > 0)], [[0.0, 200.0], [100.0, 100.0]]])
    return pair[:, 1], pair[:, 0], rng.normal(0.2, 1, len(pair))


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "nested-90.0-compiled",
        "nested-None-compiled",
    ),
)
@pytest.mark.parametrize("compiled", LOOPS)
@pytest.mark.parametrize("centre", [None, 90.0, 100.0])
@pytest.mark.parametrize("history", sorted(histories(np.arange(20.0), 0)))
def test_a_measure_is_its_relays_on_every_kind_of_history(history: str, centre: float | None, compiled: bool):
    alpha, beta, mass = _fine_measure()
    op = Preisach(RelayMeasure.from_arrays(alpha, beta, mass), compiled=compiled)
    if centre is not None:
        op.go_to_diagonal(centre)
    on = np.zeros(alpha.size, bool) if centre is None else (alpha + beta < 2 * centre) | (alpha <= centre)
    relays = Relays(alpha, beta, 2 * mass, on, op.u)
    levels = np.sort(np.concatenate([alpha, alpha - 0.2, beta, [70.0, 130.0]])).clip(0.0, 200.0)
    u = histories(np.unique(levels), 5)[history]
    y = op.follow(u)
    assert np.ptp(y) > 0
    assert np.max(np.abs(y - relays.drive(u, -mass.sum()))) <= 1e-12 * 2 * np.abs(mass).sum()


# --- one loop, however it is called ---------------------------------------------------------------------


@given(st.sampled_from(sorted(ALL)), initials, paths)
@example("two_e", "anhysteretic", [50.0, -50.0, 50.0, -50.5, 60.0, -190.0, 20.0])
@example("measure", "anhysteretic", [40.0, 20.0, 40.0, -40.0, 40.0])
@example("table", "positive", [185.0, 60.0, 61.0, 60.0, -185.0, -185.0, 0.0])
def test_a_run_is_its_steps_bit_for_bit(name: str, initial, path):
    op, at_once = Preisach(ALL[name], initial), Preisach(ALL[name], compiled=False)
    steps = [op.step(u) for u in path]
    assert at_once.simulate(path, initial).tolist() == steps
    assert at_once.state == op.state


@given(st.sampled_from(sorted(ALL)), initials, paths, st.integers(1, 4))
@example("two_e", "anhysteretic", [50.0, -50.0, 50.0, -50.5, 60.0, -190.0, 20.0], 1)
@example("two_e", "anhysteretic", [50.0, -190.0, 40.0, 30.0], 2)  # leaves B* between two requested points
@example("two_e", "anhysteretic", [190.0, 250.0, -50.0], 3)
def test_outputs_and_memories_along_a_path_are_those_of_its_steps(name: str, initial, path, every):
    op, along = Preisach(ALL[name], initial), Preisach(ALL[name], initial)
    steps = [(op.step(u), op.state) for u in path]
    at = list(range(0, len(path), every))
    y, states = along.follow_with_states(path, at)
    np.testing.assert_allclose(y, [steps[k][0] for k in at], rtol=0, atol=1e-13 * np.abs(op.y).max() + 1e-12)
    assert [s.extrema for s in states] == [steps[k][1].extrema for k in at]
    assert [s.diagonal for s in states] == [steps[k][1].diagonal for k in at]


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "table-negative",
        "table-positive",
        "two_p-negative",
        "two_p-positive",
    ),
)
@needs_numba
@pytest.mark.parametrize("initial", ["negative", "positive", "anhysteretic"])
@pytest.mark.parametrize("name", KINDS)
def test_compiled_is_plain(name: str, initial):
    """Bit for bit where there is arithmetic only; surfaces may differ in the last bits of tanh and exp."""
    u = walk(3 * CHUNK + 7, 11, reach=150.0 if initial == "anhysteretic" else 188.0)
    plain, compiled = Preisach(KINDS[name], compiled=False), Preisach(KINDS[name], compiled=True)
    y, z = plain.simulate(u, initial), compiled.simulate(u, initial)
    slack = 0.0 if name in ("measure", "table") else 1e-13 * np.ptp(y)
    assert np.max(np.abs(y - z)) <= slack
    assert plain.state.extrema == compiled.state.extrema
    assert len(plain.state.extrema) > 3


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("compiled", LOOPS)
@pytest.mark.parametrize("cut", [1, 2, 777, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK + 5])
@pytest.mark.parametrize("initial", ["negative", "anhysteretic"])
def test_split_anywhere_is_the_whole_bit_for_bit(cut: int, initial, compiled: bool):
    """A run starts where another ended, from its state in JSON, in an operator of its own."""
    u = walk(2 * CHUNK + 100, 12, reach=140.0)
    for name in ("measure", "two_e"):
        whole = Preisach(KINDS[name], compiled=compiled)
        y = whole.simulate(u, initial)
        first = Preisach(KINDS[name], compiled=compiled)
        head = first.simulate(u[:cut], initial)
        second = Preisach(KINDS[name], State.from_json(first.state.to_json()), compiled=compiled)
        assert np.array_equal(np.concatenate([head, second.follow(u[cut:])]), y)
        assert second.state == whole.state


@given(st.sampled_from(sorted(ALL)), initials, paths, st.data())
def test_a_restored_state_goes_on_bit_for_bit(name: str, initial, path, data):
    cut = data.draw(st.integers(0, len(path)))
    whole = Preisach(ALL[name], initial).follow(path)
    first = Preisach(ALL[name], initial)
    head = first.follow(path[:cut])
    restored = Preisach(ALL[name], State.from_json(first.state.to_json()))
    assert restored.state == first.state
    assert [*head, *restored.follow(path[cut:])] == whole.tolist()


@given(st.sampled_from(sorted(ALL)), initials, paths, inputs, paths)
@example("two_e", "anhysteretic", [30.0], 100.0, [50.0, -20.0])  # a look beyond what has left B* so far
@example("two_e", "anhysteretic", [30.0], 190.0, [50.0, -20.0])
def test_a_look_ahead_changes_nothing_that_comes_later(name: str, initial, before, look: float, path):
    op, other = Preisach(ALL[name], initial), Preisach(ALL[name], initial)
    op.follow(before)
    other.follow(before)
    op.peek(look)
    assert [op.step(u) for u in path] == other.follow(path).tolist()


def test_a_growing_oscillation_from_the_diagonal_leaves_it_again_at_each_turn():
    """Every second sample uses the integral along B_ℓ; the outputs equal those of a single move from B_ℓ."""
    h = thesis_surface("two_e")
    reach = np.linspace(1.0, 180.0, 40)
    u = np.column_stack([reach, -reach]).ravel()
    y = Preisach(h).simulate(u, "anhysteretic")
    alone = [Preisach(h, "anhysteretic").step(v) for v in u.tolist()]
    assert np.allclose(y[::2], alone[::2], rtol=0, atol=1e-12 * 35)
    assert np.allclose(y[1::2], alone[1::2], rtol=0, atol=1e-12 * 35)  # −r is the mirror image of r: a tie


@pytest.mark.parametrize("compiled", LOOPS)
def test_deep_memory_is_held_and_wiped_out(compiled: bool):
    """A decaying swing remembers every turn, past any one chunk; one large move forgets them all."""
    turns = 2 * CHUNK
    u = 184.0 * np.linspace(1, 0.001, turns) * np.where(np.arange(turns) % 2, -1.0, 1.0)
    op = Preisach(thesis_surface("two_c"), compiled=compiled)
    y = op.simulate([*u, 184.5])
    assert op.state.extrema == (-185.0,)
    assert y[-1] == Preisach(thesis_surface("two_c")).step(184.5)
    op.simulate(u)
    assert len(op.state.extrema) == turns
    assert op.state.extrema[-1] == u[-2]


# --- memory and speed are bounded by construction -----------------------------------------------------


@pytest.mark.long("takes a second")
def test_memory_does_not_grow_beyond_the_arrays():
    u = walk(100_000, 13)
    op = Preisach(KINDS["measure"], compiled=False)
    op.simulate(u[:100])
    tracemalloc.start()
    try:
        op.simulate(u)
        peak_MB = tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()
    assert peak_MB < 10


class Counted:
    """A hysteresis that counts the evaluations of F: y = u² / 2, everything reversible."""

    lower, upper, y_lower = -1.0, 1.0, 0.0

    def __init__(self) -> None:
        self.calls = 0

    def everett(self, alpha: float, beta: float) -> float:
        self.calls += 1
        return alpha - beta

    def swept(self, alpha, beta):
        return np.subtract(alpha, beta)

    def rise_from_diagonal(self, centre: float, u: float) -> float:
        return u - centre

    def fall_from_diagonal(self, centre: float, u: float) -> float:
        return centre - u


@pytest.mark.parametrize("shape", ["walk", "decaying", "growing"])
def test_cost_is_flat_in_memory_depth(shape: str):
    """F is evaluated once per sample at any memory depth; a user's own class uses the same loop."""
    n = 4000
    oscillation = np.where(np.arange(n) % 2, -1.0, 1.0) * np.linspace(0.999, 0.001, n)
    u = {"walk": walk(n, 14) / 190, "decaying": oscillation, "growing": oscillation[::-1]}[shape]
    h = Counted()
    op = Preisach(h)
    evaluations = h.calls
    y = op.simulate(u)
    assert h.calls - evaluations <= n
    assert np.allclose(y, u + 1.0, atol=1e-9)  # all relays on α = β: no hysteresis


# --- scalar and array forms of one hysteresis ----------------------------------------------------------


@given(st.sampled_from(sorted(ALL)), st.lists(st.tuples(inputs, inputs), min_size=1, max_size=20))
def test_swept_agrees_with_everett(name: str, pairs):
    h = ALL[name]
    a, b = (np.clip(x, h.lower, h.upper) for x in (np.max(pairs, axis=1), np.min(pairs, axis=1)))
    one_by_one = np.array([h.everett(p, q) for p, q in zip(a.tolist(), b.tolist(), strict=True)])
    assert np.max(np.abs(h.swept(a, b) - one_by_one)) <= 1e-12 * 35
    assert h.swept(a[:, None], b).shape == (a.size, b.size)


@given(st.sampled_from(sorted(ALL)), st.floats(-185, 185, width=32), st.lists(inputs, min_size=1, max_size=8))
def test_leaving_a_diagonal_in_arrays_agrees_with_one_by_one(name: str, centre: float, path):
    h = ALL[name]
    u = np.clip(path, h.lower, h.upper)
    rise, fall = h.rise_from_diagonal, h.fall_from_diagonal
    one_by_one = [rise(centre, v) if v >= centre else -fall(centre, v) for v in u.tolist()]
    assert np.allclose(from_diagonal(h, centre, u), one_by_one, rtol=0, atol=1e-12 * 35)


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_swept_is_the_difference_of_outputs(name: str):
    """F(α, β) = y(α, α) − y(α, β), from the surface's own values."""
    s = thesis_surface(name)
    a, b = np.meshgrid(*[np.linspace(s.lower, s.upper, 60)] * 2, indexing="ij")
    assert np.allclose(s.swept(a, b), s.y(a, a) - s.y(a, b), rtol=0, atol=1e-13 * (s.y_upper - s.y_lower))


@needs_numba
@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("spread", ["even", "clustered", "one", "two the same but for rounding"])
def test_the_compiled_search_finds_what_numpy_finds(side: Literal["left", "right"], spread: str):
    import numba

    rng = np.random.default_rng(15)
    levels = {
        "even": np.linspace(-1, 1, 101),
        "clustered": np.unique(np.concatenate([rng.normal(0, 1e-6, 300), [-5.0, 7.0]])),
        "one": np.array([0.25]),
        "two the same but for rounding": np.array([0.1, np.nextafter(0.1, 1), 0.3]),
    }[spread]
    near = np.concatenate([levels, np.nextafter(levels, -9), np.nextafter(levels, 9)])
    u = np.concatenate([near, rng.uniform(-6, 8, 500), [-1e300, 1e300]])
    find, table = numba.njit(rank), bucketed(levels, side)
    assert [find(table, v) for v in u.tolist()] == np.searchsorted(levels, u, side).tolist()


# --- states as values ----------------------------------------------------------------------------------

GOOD = State((-185.0, 100.0, -20.0), (-16.0, 9.0, 2.0), 30.0, 4.0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"extrema": [-185.0, 100.0, 120.0]}, "120 does not lie between -185 and 100"),
        ({"extrema": [-185.0, -200.0, -20.0]}, "-200 does not lie between -185 and inf"),
        ({"u": 100.0}, "100 does not lie between -20 and 100"),
        ({"u": -30.0}, "-30 does not lie between -20 and 100"),
        ({"extrema": [0.0, 100.0, -150.0], "diagonal": True}, "-150 does not lie between -100 and 100"),
        ({"extrema": [0.0, -50.0, 10.0], "u": 20.0, "diagonal": True}, "20 does not lie between -50 and 10"),
        ({"outputs": [-16.0, 9.0]}, "at least one extremum and one output for each; got 2 for 3"),
        ({"extrema": [], "outputs": []}, "got 0 for 0"),
        ({"y": float("nan")}, "not finite"),
        ({"u": 10**400}, "too large for an input"),
        ({"extrema": "high"}, "extrema must be numbers"),
        ({"extrema": [-185.0, True, -20.0]}, "extrema must be numbers"),
        ({"diagonal": 1}, "'diagonal' must be true or false"),
    ],
)
def test_a_state_that_is_none_is_refused(change: dict, sentence: str):
    data = {**json.loads(GOOD.to_json()), **change}
    with pytest.raises(DataError, match=sentence):
        State.from_json(json.dumps(data))


@pytest.mark.parametrize(
    "text",
    ["", "[1, 2]", '{"extrema": [0.0]}', "nonsense", "null", "[" * 100_000, None, 5],
    ids=lambda x: str(x)[:9],
)
def test_a_text_that_is_no_state_is_refused(text):
    with pytest.raises(DataError, match="This is not a Preisach state"):
        State.from_json(text)


@pytest.mark.parametrize(
    "state",
    [
        State((0.0, 90.0), (0.0, 9.0), 30.0, 4.0),  # begins above this hysteresis's saturation
        State((-185.0, 200.0), (0.0, 9.0), 30.0, 4.0),
        State((-300.0, 90.0), (0.0, 9.0), 30.0, 4.0),
        State((190.0,), (0.0,), 190.0, 0.0, True),
    ],
)
def test_a_state_of_another_hysteresis_is_refused(state: State):
    op = Preisach(thesis_surface("two_e"))
    before = op.state
    with pytest.raises(DataError, match=r"does not belong to a hysteresis over \[-185, 185\]"):
        op.reset(state)
    assert op.state == before


def test_a_state_that_is_not_nested_is_refused():
    with pytest.raises(DataError, match="must alternate and be nested"):
        Preisach(thesis_surface("two_e"), State((-185.0, 50.0, 70.0), (0.0, 1.0, 2.0), 60.0, 1.0))


def test_a_present_point_kept_as_an_extremum_is_one_point():
    """A state that ends in its last extremum continues in both directions like the operator at that point."""
    op = Preisach(thesis_surface("two_e"))
    op.simulate([100.0, -20.0])
    twice = State((*op.state.extrema, op.u), (*op.state.outputs, op.y), op.u, op.y)
    for u in (-60.0, 40.0, 130.0):
        assert Preisach(thesis_surface("two_e"), twice).step(u) == op.peek(u)


# --- refusals --------------------------------------------------------------------------------------------


@settings(max_examples=20)
@given(st.sampled_from(sorted(ALL)), initials, paths, st.integers(0, 24))
def test_nan_in_a_run_is_refused_where_it_stands_and_nothing_moves(name: str, initial, path, where: int):
    op = Preisach(ALL[name], initial)
    op.follow(path)
    before = op.state
    where = min(where, len(path))
    with pytest.raises(DataError, match=rf"NaN at sample {where}\."):
        op.follow([*path[:where], float("nan"), *path[where:], float("nan")])
    assert op.state == before


def test_what_has_no_compiled_form_is_refused():
    if not compiled_available():
        with pytest.raises(UsageError, match=r"install 'smarig\[fast\]'"):
            Preisach(thesis_surface("two_e"), compiled=True).simulate([1.0])
    with pytest.raises(UsageError, match="no compiled form"):
        Preisach(Mirrored(thesis_surface("two_e")), compiled=True).simulate([1.0])


def test_without_numba_everything_runs_plain(monkeypatch):
    """As on a machine without the extra: the long run below would be compiled where numba is."""
    import smarig.preisach.compiled as fast

    monkeypatch.setattr(fast, "compiled_available", lambda: False)
    monkeypatch.setattr(fast, "WORTH", 10)
    monkeypatch.setattr(fast, "compiled_loop", lambda *functions: pytest.fail("numba was asked for"))
    u = walk(200, 16)
    assert np.array_equal(
        Preisach(thesis_surface("two_e")).simulate(u), Preisach(thesis_surface("two_e")).follow(u)
    )
    with pytest.raises(UsageError, match=r"compiled=True needs the extra 'fast'"):
        Preisach(thesis_surface("two_e"), compiled=True).simulate(u)
