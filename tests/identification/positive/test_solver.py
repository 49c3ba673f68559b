"""The quadratic programme against scipy's active-set non-negative least squares, and its optimality
conditions."""

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.sparse import csr_matrix, eye_array, random_array
from threadpoolctl import threadpool_info, threadpool_limits

from identification.made_runs import fod_run
from smarig.identification.identify import identify
from smarig.identification.positive import Observations, fit_positive
from smarig.identification.positive.interior_point import NewtonSystem, solve
from smarig.identification.positive.positive_fit import fit_table
from smarig.identification.positive.quadratic_programme import solve_by_pivoting


def problem(seed, m=30, n=24, border=0, coupling=3):
    """A well-posed least-squares problem whose rows reach at most ``coupling`` columns away, but for the border."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((m, n))
    inner = n - border
    place = rng.integers(0, inner, m)
    near = np.abs(np.arange(n)[None, :] - place[:, None]) <= coupling
    near[:, inner:] = True
    return csr_matrix(np.where(near, A, 0.0)), rng.standard_normal(m)


def solved(A, b, D, border, ridge=1e-3):
    H = csr_matrix(A.T @ A + ridge * eye_array(A.shape[1]))
    return solve(NewtonSystem(H, D, border), H, A.T @ b)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("n", "border"), [(24, 0), (60, 2)], ids=["dense", "banded with a border"])
def test_it_agrees_with_an_active_set_method(seed, n, border):
    A, b = problem(seed, m=2 * n, n=n, border=border)
    D = csr_matrix(eye_array(n))
    ours = solved(A, b, D, border)
    stacked = np.vstack([A.toarray(), np.sqrt(1e-3) * np.eye(n)])
    theirs, _ = nnls(stacked, np.concatenate([b, np.zeros(n)]))
    assert np.abs(ours.x - theirs).max() < 1e-7
    assert 0 < np.sum(theirs == 0) < n, "some constraints must hold, and some must not"
    assert NewtonSystem(csr_matrix(A.T @ A), D, border).banded == bool(border)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("guess", ["all", "none", "wrong"])
def test_pivoting_agrees_with_it_from_any_guess(seed, guess):
    A, b = problem(seed, m=48, n=24)
    stacked = np.vstack([A.toarray(), np.sqrt(1e-3) * np.eye(24)])
    theirs, _ = nnls(stacked, np.concatenate([b, np.zeros(24)]))
    positive = {"all": None, "none": np.zeros(24, dtype=bool), "wrong": theirs == 0}[guess]
    ours = solve_by_pivoting(stacked.T @ stacked, A.T @ b, 24, positive)
    assert ours is not None
    assert np.abs(ours - theirs).max() < 1e-9


def test_pivoting_leaves_free_unknowns_free_and_refuses_a_singular_problem():
    A, b = problem(2, m=48, n=24)
    H = (A.T @ A + 1e-3 * eye_array(24)).toarray()
    found = solve_by_pivoting(H, A.T @ b, 0)
    assert found is not None
    assert found == pytest.approx(np.linalg.solve(H, A.T @ b))
    assert found.min() < 0
    assert solve_by_pivoting(np.zeros((2, 2)), np.ones(2), 2) is None


def test_the_conditions_of_optimality_hold_with_constraints_on_differences():
    A, b = problem(3, m=40, n=30)
    D = csr_matrix(np.diff(np.eye(30), axis=0))  # a rising x
    H = csr_matrix(A.T @ A + 1e-3 * eye_array(30))
    found = solve(NewtonSystem(csr_matrix(abs(H) + abs(D).T @ abs(D)), D, 0), H, A.T @ b)
    assert (D @ found.x).min() > -1e-9
    assert found.z.min() > -1e-12
    assert np.abs(H @ found.x - A.T @ b - D.T @ found.z).max() < 1e-6
    assert float(found.s @ found.z) < 1e-6


def test_the_factor_solves_its_system():
    rng = np.random.default_rng(0)
    A, _ = problem(1, m=90, n=60, border=2)
    D = csr_matrix(random_array((40, 60), density=0.03, rng=rng) + eye_array(40, 60))
    H = csr_matrix(A.T @ A + eye_array(60))
    w = rng.uniform(0, 5, 40)
    newton = NewtonSystem(csr_matrix(abs(H) + abs(D).T @ abs(D)), D, 2)
    whole = (H + D.T @ (D.multiply(w[:, None]))).toarray()
    b = rng.standard_normal((60, 3))
    assert np.allclose(newton.factor(newton.packed(H), w)(b), np.linalg.solve(whole, b), atol=1e-9)


def blas_threads():
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def product_points():
    """Exact points of y = αβ."""
    u = np.linspace(0.0, 1.0, 12)
    i, j = np.tril_indices(u.size)
    return Observations.of_points(u[i], u[j], u[i] * u[j], i.astype(np.int64), (0.0, 1.0))


COMPUTATIONS = {
    "fit": lambda: fit_positive(product_points()),
    "table": lambda: fit_table(product_points()),
    "choice of a surface": lambda: identify(fod_run("one_c", seed=0)),
}


@pytest.mark.long("takes a second", cases=("fit",))
@pytest.mark.parametrize(
    "name",
    [
        name if name == "fit" else pytest.param(name, marks=pytest.mark.long("takes three seconds"))
        for name in COMPUTATIONS
    ],
)
def test_every_factor_is_computed_by_one_thread(monkeypatch, name):
    """Threads of BLAS share a narrow band badly: they wait for each other, most of all on a busy machine."""
    seen, factor = [], NewtonSystem.factor

    def observed(self, kept, w):
        seen.append(blas_threads())
        return factor(self, kept, w)

    monkeypatch.setattr(NewtonSystem, "factor", observed)
    with threadpool_limits(2, "blas"):
        outside = blas_threads()
        COMPUTATIONS[name]()
        assert blas_threads() == outside, "the caller's threads must be as before"
    assert len(seen) > 10
    assert all(threads == {1} for threads in seen)
