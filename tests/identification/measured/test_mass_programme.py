"""The fits of measured runs solve the programme of the positive identification, however they are started."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix, diags_array, hstack

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.identification import measured_problem
from smarig.identification.measured import left_out_errors, mass_programme
from smarig.identification.measured.mass_programme import unknowns_of_masses
from smarig.identification.measured.reading_plan import reading_plan
from smarig.identification.positive.quadratic_programme import MeasureProblem
from smarig.measurement import input_records

SMOOTHING = 1e-10


@pytest.fixture(scope="module")
def problem():
    """Two runs of one wire, the first with a term and uneven weights."""
    wire, runs = RelayWire(2), []
    for k, peaks in enumerate(((85.0, 62.0, 80.0, 57.0, 85.0), (80.0, 60.0, 85.0))):
        u = triangles(peaks)
        runs.append(as_run(f"run_{k}", u, wire.strain(u, stroke=4.0 + k), dt=1.0, seed=k))
    plan = reading_plan(input_records(runs))
    weight = np.random.default_rng(0).uniform(0.5, 1.5, len(plan))
    time = plan.of([r.t for r in plan.records])[:, None]
    return measured_problem(plan, extra_terms=time, weight=weight)


def as_surface(problem, gains):
    """The same programme with the surface at the nodes as unknowns."""
    sign = problem.sign * gains[problem.plan.record[problem.observations.term]]
    own = replace(problem.observations, sign=problem.observations.sign * sign)
    rows = hstack([own.matrix(problem.triangle), csr_matrix(problem.terms / problem.term_scale)])
    weighted = csr_matrix(diags_array(problem.weight) @ csr_matrix(rows))
    free = own.offsets + problem.terms.shape[1]
    return MeasureProblem(problem.triangle, weighted, problem.weight * problem.centred / problem.scale, free)


def test_the_solution_is_that_of_the_surface_programme(problem):
    gains = np.array([1.0, 0.8])
    x = problem.programme(gains).solved(SMOOTHING)
    surface = as_surface(problem, gains)
    expected = surface.solved(SMOOTHING, accuracy=1e-11).x
    n = problem.triangle.unknowns
    theta = np.concatenate([unknowns_of_masses(problem.triangle.nodes.size - 1) @ x[:n], x[n:]])
    assert x[: n - 1].min() > -1e-11
    assert np.abs(surface.rows @ (theta - expected)).max() < 1e-6


def test_a_block_left_out_gives_what_a_fit_from_scratch_gives(problem):
    within = problem.plan.record == 0
    fold = problem.plan.folds(within)[1]
    programme = problem.programme(np.ones(2))
    left_out = programme.solved_without(SMOOTHING, within, fold)
    scratch = problem.programme(np.array([1.0, 1.0 + 1e-15])).solved(SMOOTHING, within & ~fold)
    assert np.abs(programme.rows @ (left_out - scratch)).max() < 1e-8


def test_it_is_solved_where_the_exchange_of_constraints_fails(problem, monkeypatch):
    exact = problem.programme(np.array([0.9, 1.0])).solved(SMOOTHING)
    monkeypatch.setattr(mass_programme, "solve_by_pivoting", lambda *_: None)
    again = problem.programme(np.array([0.9, 1.0 + 1e-15]))
    assert np.abs(again.rows @ (again.solved(SMOOTHING) - exact)).max() < 1e-4


def test_less_smoothing_must_be_worth_it(problem, monkeypatch):
    def chosen(errors):
        of = dict(zip(left_out_errors.SMOOTHINGS, errors))
        monkeypatch.setattr(
            left_out_errors, "held_out_rms", lambda _problem, smoothing, _mask, gains: of[smoothing]
        )
        return left_out_errors.chosen_smoothing(problem)

    assert chosen((1.0, 1.0, 1.0005)) == 1e-10
    assert chosen((1.0, 1.0005, 1.3)) == 1e-12
    assert chosen((1.0, 1.01, 1.02)) == 1e-14
