"""Every settled point is one linear equation, checked against the operator, which sums no surface values."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from identification.made_runs import PARTITION, driven_run, fod_inputs, made_run
from smarig.core.errors import DataError
from smarig.identification.fod_data import fod_data
from smarig.identification.positive.observations import Observations, joined_observations
from smarig.identification.positive.triangle import Triangle
from smarig.preisach.operator import Preisach

TRIANGLE = Triangle(np.array([-10.0, -7.0, -6.0, -2.0, 0.0, 1.0, 4.0, 10.0]))


def truth(seed):
    masses = np.random.default_rng(seed).uniform(0, 1, TRIANGLE.cells)
    table = TRIANGLE.table(masses, -3.0)
    return table, np.append(table.values[TRIANGLE.i + 1, TRIANGLE.j + 1], -3.0)


def history(seed, n=40):
    """Random turning points, then a full swing so that the range is the triangle's."""
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-9.9, 9.9, n), [10.0, -10.0], rng.uniform(-10, 10, n)])


@pytest.mark.parametrize("initial", ["negative", "positive", "anhysteretic"])
@given(seed=st.integers(0, 10_000))
def test_rows_agree_with_the_operator(initial, seed):
    table, theta = truth(seed)
    u = history(seed)
    y = Preisach(table).simulate(u, initial)
    found = Observations.of_runs([made_run(u, y, initial=initial)])
    assert len(found) == u.size
    assert np.allclose(found.matrix(TRIANGLE) @ theta, found.y, atol=1e-10)


def test_a_wrong_history_is_detected():
    table, theta = truth(1)
    u = history(1)
    y = Preisach(table).simulate(u, "positive")
    found = Observations.of_runs([made_run(u, y, initial="negative")])
    assert np.abs(found.matrix(TRIANGLE) @ theta - found.y).max() > 0.1


def test_points_before_the_memory_is_known_are_left_out():
    table, theta = truth(2)
    u = np.concatenate([[3.0, -2.0, 5.0], history(2)])
    y = Preisach(table).simulate(u, "anhysteretic")
    found = Observations.of_runs([made_run(u, y, initial="")])
    assert len(found) == u.size - 3 - 40
    assert np.allclose(found.matrix(TRIANGLE) @ theta, found.y, atol=1e-10)


def test_an_unknown_memory_is_reported():
    run = made_run([1.0, 2.0, 1.0], [1.0, 2.0, 1.5], initial="")
    other = made_run([0.0, 3.0], [0.0, 3.0], initial="", name="b.run.sqlite")
    assert len(Observations.of_runs([run, other])) == 1 + 1, "the other run saturates, this one does not"
    with pytest.raises(DataError, match="known memory|settled points"):
        Observations.of_runs([made_run([], [], initial="")])


def test_the_parts_of_one_record_have_the_curves_of_the_whole():
    u = np.array([-10.0, 10.0, -10.0, 4.0, -3.0, 3.0, -10.0, 10.0, -10.0])
    y = np.tanh(u)
    whole = made_run(u, y)

    def cut(*metas):
        parts = [made_run(u[:4], y[:4]), made_run(u[4:], y[4:], initial="continued")]
        parts[1].columns["t_s"] += parts[0]["t_s"][-1] + 1.0
        return [replace(part, meta=part.meta | more) for part, more in zip(parts, metas)]

    of_a_file = cut({"imported": {"sha256": "a"}}, {"imported": {"sha256": "b", "continues_sha256": "a"}})
    found, expected = Observations.of_runs(of_a_file), Observations.of_runs([whole])
    np.testing.assert_array_equal(found.curve, expected.curve)
    for apart in (
        [of_a_file[0], made_run(u[4:], y[4:], name="b.run.sqlite")],
        cut(*2 * [{"start_epoch": 5.0}]),
    ):
        curve = Observations.of_runs(apart).curve
        assert not set(curve[:4]) & set(curve[4:])


def test_first_order_points_are_the_same_either_way():
    run = driven_run("one_e", fod_inputs(PARTITION["one"]), seed=1)
    as_run, data = Observations.of_runs([run]), fod_data([run])
    as_fod = Observations.of_fod(data)
    triangle = Triangle(np.linspace(0, 174.1, 12))
    theta = np.random.default_rng(0).standard_normal(triangle.unknowns)
    rows = {"run": as_run, "fod": as_fod}
    values = {k: np.sort(np.round(o.matrix(triangle) @ theta - o.y, 9)) for k, o in rows.items()}
    assert np.isin(values["fod"], values["run"]).all()


def test_a_part_is_the_part_of_the_whole():
    u = history(4)
    found = Observations.of_runs([made_run(u, np.zeros(u.size), initial="anhysteretic")])
    mask = np.random.default_rng(0).random(len(found)) < 0.4
    whole, part = found.matrix(TRIANGLE).toarray(), found.where(mask).matrix(TRIANGLE).toarray()
    assert np.allclose(whole[mask], part, atol=1e-12)
    twice = joined_observations([found, found.where(mask)])
    assert np.allclose(twice.matrix(TRIANGLE).toarray(), np.vstack([whole, part]), atol=1e-12)
    assert np.unique(twice.curve).size > np.unique(found.curve).size


def test_the_mirror_image_of_a_symmetric_hysteresis_adds_no_information():
    symmetric = Triangle(np.array([-10.0, -7.0, -6.0, -2.0, 0.0, 2.0, 6.0, 7.0, 10.0]))
    grid = np.zeros((8, 8))
    grid[symmetric.i, symmetric.j] = np.random.default_rng(0).uniform(0, 1, symmetric.cells)
    grid = grid + grid[::-1, ::-1].T
    masses = grid[symmetric.i, symmetric.j]
    y_lower = -masses.sum() / 2
    table = symmetric.table(masses, y_lower)
    theta = np.append(table.values[symmetric.i + 1, symmetric.j + 1], y_lower)
    u = history(5)
    found = Observations.of_runs([made_run(u, Preisach(table).simulate(u, "negative"), initial="negative")])
    image = found.mirrored()
    assert np.allclose(image.matrix(symmetric) @ theta, image.y, atol=1e-10)
    lopsided = theta + np.append(np.arange(symmetric.cells) / 50, 0.0)
    assert np.abs(image.matrix(symmetric) @ lopsided - image.y).max() > 0.1


def test_a_range_off_centre_has_no_mirror():
    found = Observations.of_fod(fod_data([driven_run("one_e", fod_inputs(PARTITION["one"]))]))
    with pytest.raises(DataError, match="around zero"):
        found.mirrored()
