"""Derivatives of the output with respect to the remembered extrema, against differences of simulations."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarig.core.errors import UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.operator import Preisach, State
from smarig.preisach.sensitivity import sensitivity

NODES = np.array([-185.0, -130.0, -60.0, -12.0, 20.0, 75.0, 130.0, 185.0])


def _table() -> FodTable:
    a, b = np.meshgrid(NODES, NODES, indexing="ij")
    return FodTable.from_arrays(NODES, NODES, np.where(b <= a, thesis_surface("two_c").y(a, b), np.nan))


SYSTEMS: dict[str, Everett] = {
    "two_p": thesis_surface("two_p"),
    "two_e": thesis_surface("two_e"),
    "table": _table(),
    "mirror": Mirrored(thesis_surface("two_e")),
}
STEP = 1e-4


def by_differences(h: Everett, initial, path: list[float]) -> np.ndarray:
    """∂y/∂(each input of the path), central differences of simulate."""
    slopes = []
    for k in range(len(path)):
        ends = []
        for sign in (1, -1):
            moved = [*path]
            moved[k] += sign * STEP
            ends.append(Preisach(h).simulate(moved, initial)[-1])
        slopes.append((ends[0] - ends[1]) / (2 * STEP))
    return np.array(slopes)


@given(
    st.sampled_from(sorted(SYSTEMS)),
    st.sampled_from(["negative", "anhysteretic"]),
    st.lists(st.floats(0.05, 0.95), min_size=1, max_size=6),
    st.booleans(),
)
def test_slopes_are_those_of_simulations(name: str, initial, parts, up: bool):
    """Nested inputs, so that each is remembered: one that was wiped out would have slope zero."""
    low, high = -180.0, 180.0
    path = []
    for k, part in enumerate(parts):
        rising = (k % 2 == 0) == (up or initial == "negative")
        u = high - 0.45 * part * (high - low) if rising else low + 0.45 * part * (high - low)
        path.append(u)
        low, high = (low, u) if rising else (u, high)
        if initial == "anhysteretic" and k == 0:
            low, high = (-u, u) if u > 0 else (u, -u)
    assume(all(np.min(np.abs(NODES - u)) > 1e-2 and np.min(np.abs(NODES + u)) > 1e-2 for u in path))
    assume(min(np.abs(np.diff([0.0, *path])), default=1) > 1e-2)
    op = Preisach(SYSTEMS[name], initial)
    op.follow(path)
    assert op.state.extrema[1:] == tuple(path[:-1]), "every input but the last must be remembered"
    slopes = sensitivity(SYSTEMS[name], op.state)
    assert slopes.shape == (len(op.state.extrema) + 1,)
    assert slopes[0] == 0.0
    assert np.allclose(slopes[1:], by_differences(SYSTEMS[name], initial, path), rtol=1e-4, atol=2e-6)


def test_a_remembered_maximum_still_matters_and_a_wiped_one_does_not():
    h = thesis_surface("one_e")
    op = Preisach(h)
    op.follow([90.0, 40.0, 60.0])
    assert np.all(np.abs(sensitivity(h, op.state)[1:]) > 1e-3)
    op.step(95.0)
    assert sensitivity(h, op.state).size == 2


def test_noise_of_past_inputs_propagates_through_the_memory():
    """First-order propagation with these slopes is the scatter of simulations with noisy inputs."""
    h, path, sigma = thesis_surface("two_e"), [120.0, -40.0, 80.0, 10.0], 0.05
    op = Preisach(h)
    op.follow(path)
    expected = sigma * np.linalg.norm(sensitivity(h, op.state))
    rng = np.random.default_rng(31)
    outputs = [Preisach(h).simulate(path + sigma * rng.normal(size=4))[-1] for _ in range(2000)]
    assert np.std(outputs) == pytest.approx(expected, rel=4 / np.sqrt(2 * 2000))


def test_in_saturation_only_the_input_is_left():
    h = thesis_surface("two_e")
    slopes = sensitivity(h, Preisach(h, "positive").state)
    assert slopes.tolist() == [0.0, pytest.approx(float(h.strip_alpha(185.0, -185.0)))]


@pytest.mark.parametrize("h", [Preisach.from_measure([1.0], [0.0], [1.0]).hysteresis])
def test_relays_have_no_slopes(h):
    for measure in (h, Mirrored(h), Mirrored(Mirrored(h))):
        with pytest.raises(UsageError, match="has no slopes. Sensitivities need a surface or a table"):
            sensitivity(measure, State((0.0,), (-1.0,), 0.5, -1.0))
