"""Cells, nodes and slopes of the triangle against the table that the operator uses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarig.core.errors import DataError
from smarig.identification.positive.triangle import Triangle


def uneven(seed, n=9):
    rng = np.random.default_rng(seed)
    return np.concatenate([[-3.0], -3.0 + np.cumsum(rng.uniform(0.2, 2.0, n))])


def unknowns(triangle, masses, y_lower):
    """The unknowns that belong to masses, from the table's own node values."""
    values = triangle.table(masses, y_lower).values
    return np.append(values[triangle.i + 1, triangle.j + 1], y_lower)


@given(st.integers(0, 10_000))
def test_values_are_the_tables_own(seed):
    rng = np.random.default_rng(seed)
    triangle = Triangle(uneven(seed))
    masses = rng.uniform(-1, 2, triangle.cells)
    theta = unknowns(triangle, masses, 4.0)
    alpha = rng.uniform(*triangle.nodes[[0, -1]], 50)
    beta = rng.uniform(triangle.nodes[0], alpha)
    alpha[:5] = beta[:5]
    table = triangle.table(masses, 4.0)
    assert np.allclose(triangle.values(alpha, beta) @ theta, table.y(alpha, beta), atol=1e-12)
    assert np.allclose(triangle.masses @ theta, masses, atol=1e-12)


@given(st.integers(0, 10_000))
def test_slopes_are_those_of_the_values(seed):
    rng = np.random.default_rng(seed)
    triangle = Triangle(uneven(seed))
    theta = rng.standard_normal(triangle.unknowns)
    span = triangle.nodes[-1] - triangle.nodes[0]
    middles = (triangle.nodes[1:] + triangle.nodes[:-1]) / 2
    i = rng.integers(1, middles.size, 20)
    alpha, beta = middles[i], middles[rng.integers(0, i)]
    h = 1e-4 * span

    def y(a, b):
        return triangle.values(a, b) @ theta

    def F(a):
        return y(a, a) - y(a, beta)

    falling = (y(alpha, beta + h) - y(alpha, beta - h)) / (2 * h) * span
    rising = (F(alpha + h) - F(alpha - h)) / (2 * h) * span
    assert np.allclose(triangle.falling_slope(alpha, beta) @ theta, falling, atol=1e-7)
    assert np.allclose(triangle.rising_slope(alpha, beta) @ theta, rising, atol=1e-7)


def test_a_density_that_is_a_plane_is_perfectly_smooth_and_a_bump_is_not():
    triangle = Triangle(np.linspace(0, 1, 13))
    middle = (triangle.nodes[1:] + triangle.nodes[:-1]) / 2
    a, b = middle[triangle.i], middle[triangle.j]
    plane = (1 + 2 * a - b) * triangle.areas
    bump = np.exp(-100 * ((a - 0.7) ** 2 + (b - 0.3) ** 2)) * triangle.areas
    rough = [float(t @ triangle.roughness @ t) for t in (unknowns(triangle, m, 0.0) for m in (plane, bump))]
    assert rough[0] < 1e-16 * rough[1]


@pytest.mark.parametrize("power", [1, 2])
def test_roughness_is_the_integral_it_stands_for(power):
    """ρ = (α − ½)²·(β − ½)^(power − 1) has ∬ρ_αα² + 2ρ_αβ² + ρ_ββ² in closed form, whatever the cells are."""
    found = []
    for n in (24, 48):
        triangle = Triangle(np.linspace(2.0, 6.0, n + 1))
        x = (np.arange(n) + 0.5) / n - 0.5
        rho = x[triangle.i] ** 2 * x[triangle.j] ** (power - 1)
        inner = triangle.i != triangle.j
        theta = unknowns(triangle, np.where(inner, rho * triangle.areas, 0.0), 0.0)
        found.append(float(theta @ triangle.roughness @ theta))
    # power 1: 4·(½);  power 2: ρ_αα = 2b, ρ_αβ = 2a: ∬4b² + 8a² over the lower half of a unit square about 0.
    exact = {1: 2.0, 2: (4 + 8) / 24}[power]
    assert abs(found[1] - exact) < 0.15 * exact
    assert abs(found[1] - exact) < 0.6 * abs(found[0] - exact)


def test_nodes_that_do_not_increase_are_refused():
    with pytest.raises(DataError, match="increasing"):
        Triangle(np.array([0.0, 1.0, 1.0, 2.0, 3.0]))
