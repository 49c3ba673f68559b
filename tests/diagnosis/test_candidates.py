"""Candidates as whitened traces: the part of the residual that each explains, and its strength."""

from typing import Any

import numpy as np
import pytest
from smarig.diagnosis.critique.candidates import Candidate, _smooth, generic, named, whitened

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.refit.refit import NoiseEstimate, Refit
from smarig.plant.effects.backlash import backlash
from smarig.plant.effects.settling import settling
from smarig.plant.effects.walking import walking
from smarig.replay import build_timeline, predict

N = 30


NO_POSTERIOR: Any = None  # no test here uses a density


def whitening(factor, scale, noise):
    """A refit that whitens and does nothing else."""
    none = np.empty(0)
    return Refit(factor, scale, none, noise, none, 0.0, scale.size, none, NO_POSTERIOR)


def refit(n=N, seed=1, scale=0.02):
    """A covariance of no special shape."""
    rng = np.random.default_rng(seed)
    mixed = rng.standard_normal((n, n))
    factor = np.linalg.cholesky(mixed @ mixed.T / n + 0.1 * np.eye(n))
    noise = NoiseEstimate(np.ones(n), 0.0, 60.0, 1.0)
    return whitening(factor, scale * rng.uniform(0.5, 2.0, n), noise)


def made(kind, *strengths, seed=2, size=1.0, **other_readings):
    """Raw traces of no special shape, one for each strength, and the candidate of them, whitened."""
    rng = np.random.default_rng(seed)
    traces = size * rng.standard_normal((N, len(strengths)))
    raw = Candidate(kind.name, traces, kind, tuple(kind(s) for s in strengths))
    return traces, whitened(raw, refit())


def orthogonal(traces, seed=3):
    """A vector at right angles to all of them."""
    v = np.random.default_rng(seed).standard_normal(traces.shape[0])
    q = np.linalg.qr(traces)[0]
    return v - q @ (q.T @ v)


def test_whitening_undoes_the_covariance():
    r = refit()
    C = r.factor @ r.factor.T * np.outer(r.scale, r.scale)
    white = r.whitened(np.eye(N))
    np.testing.assert_allclose(white @ C @ white.T, np.eye(N), atol=1e-9)


def test_named_traces_have_unit_length_and_their_size_is_for_one_unit_of_strength():
    traces, candidate = made(walking, 0.1, -0.5)
    np.testing.assert_allclose(np.linalg.norm(candidate.traces, axis=0), 1.0)
    white = refit().whitened(traces)
    np.testing.assert_allclose(candidate.size, np.linalg.norm(white, axis=0) / [0.1, 0.5])


def test_generic_traces_are_an_orthonormal_basis_without_the_superfluous():
    rng = np.random.default_rng(5)
    three = rng.standard_normal((N, 3))
    raw = Candidate("?time", np.column_stack([three, three[:, 0] + three[:, 1]]), depends_on="time")
    candidate = whitened(raw, refit())
    assert candidate.traces.shape == (N, 3)
    np.testing.assert_allclose(candidate.traces.T @ candidate.traces, np.eye(3), atol=1e-9)
    white = refit().whitened(raw.traces)
    np.testing.assert_allclose(
        candidate.traces @ (candidate.traces.T @ white), white, atol=1e-8 * np.abs(white).max()
    )


@pytest.mark.parametrize("kind", [walking, settling])
def test_a_candidate_explains_all_of_its_own_trace_and_nothing_at_right_angles(kind):
    _, candidate = made(kind, 0.2, 0.4)
    assert candidate.explained_share(7.0 * candidate.traces[:, 1])[0] == pytest.approx(1.0)
    assert candidate.explained_share(orthogonal(candidate.traces))[0] == pytest.approx(0.0, abs=1e-12)
    both = candidate.traces[:, 0] * 3.0 + 4.0 * _unit(orthogonal(candidate.traces))
    assert candidate.explained_share(both)[0] == pytest.approx(9 / 25)


def test_a_generic_candidate_explains_every_mixture_of_its_traces():
    raw = Candidate("?hold", np.random.default_rng(6).standard_normal((N, 4)), depends_on="hold")
    candidate = whitened(raw, refit())
    mixture = candidate.traces @ np.array([1.0, -2.0, 0.5, 3.0])
    assert candidate.explained_share(mixture)[0] == pytest.approx(1.0)
    assert candidate.explained_share(-mixture)[0] == pytest.approx(1.0)
    assert candidate.explained_share(orthogonal(candidate.traces))[0] == pytest.approx(0.0, abs=1e-12)


def test_variants_of_a_name_are_alternatives_not_a_mixture():
    _, candidate = made(settling, 0.5, 0.5)
    a, b = candidate.traces.T
    share = candidate.explained_share(a + b)[0]
    assert share == pytest.approx(((a + b) @ a) ** 2 / ((a + b) @ (a + b)))
    assert share < 0.9


def test_a_strength_of_one_sign_does_not_explain_the_negative():
    _, one = made(settling, 0.5)
    _, both = made(walking, 0.5)
    assert (one.signed, both.signed) == (False, True)
    assert one.explained_share(-one.traces[:, 0])[0] == 0.0
    assert both.explained_share(-both.traces[:, 0])[0] == pytest.approx(1.0)


def test_many_data_at_once_are_explained_one_by_one():
    _, candidate = made(settling, 0.5, 1.0)
    data = np.random.default_rng(8).standard_normal((N, 6))
    each = [candidate.explained_share(column)[0] for column in data.T]
    assert candidate.explained_share(data).tolist() == pytest.approx(each)
    assert candidate.gain(data).tolist() == pytest.approx([candidate.gain(column)[0] for column in data.T])


def test_a_gain_is_the_log_likelihood_ratio_with_the_noises_size_fitted_to_each():
    """N(0, σ² 1): log L = −N/2 log(|y|²/N) + …, before and after the trace is taken out."""
    _, candidate = made(walking, 0.5)
    y = np.random.default_rng(9).standard_normal(N) + 4.0 * candidate.traces[:, 0]
    trace = candidate.traces[:, 0]
    rest = y - trace * (trace @ y)
    by_hand = N / 2 * (np.log(y @ y / N) - np.log(rest @ rest / N))
    assert candidate.gain(y)[0] == pytest.approx(by_hand)
    assert np.isfinite(candidate.gain(trace)[0])


@pytest.mark.parametrize(("kind", "strength"), [(walking, 1.7), (walking, -0.4), (settling, 3.0)])
def test_the_injected_strength_is_found(kind, strength):
    tried = 0.25 * kind.primary.typical
    traces, candidate = made(kind, tried, tried)
    data = refit().whitened(traces[:, 1] * strength / tried)
    planted, worth = candidate.best(data)
    assert planted.kind is kind
    assert planted.strength == pytest.approx(strength)
    assert worth == pytest.approx(np.linalg.norm(data))


def test_a_negative_injected_trace_is_found_with_its_sign():
    traces, candidate = made(walking, -0.5)
    assert candidate.best(refit().whitened(2.4 * traces[:, 0]))[0].strength == pytest.approx(-1.2)
    assert candidate.best(refit().whitened(-2.4 * traces[:, 0]))[0].strength == pytest.approx(1.2)


def test_a_strength_ends_at_its_bounds():
    traces, candidate = made(settling, 0.5)
    assert candidate.best(refit().whitened(1000 * traces[:, 0]))[0].strength == settling.primary.upper
    assert candidate.best(refit().whitened(-1000 * traces[:, 0]))[0].strength == settling.primary.lower


def test_an_effect_with_a_threshold_is_taken_no_farther_than_its_trace_is_true():
    tries = backlash.primary.tries
    traces, candidate = made(backlash, *tries)
    planted, _ = candidate.best(refit().whitened(100 * traces[:, 1]))
    assert planted.strength == pytest.approx(3 * tries[1])
    planted, _ = candidate.best(refit().whitened(1.5 * traces[:, 1]))
    assert planted.strength == pytest.approx(1.5 * tries[1])


def test_what_cannot_stand_out_of_the_noise_is_no_candidate():
    faint = 1e-4 * 0.5 / settling.primary.upper
    _, candidate = made(settling, 0.5, 0.5, size=faint)
    assert candidate.traces.shape == (N, 0)
    assert candidate.variants == ()
    assert candidate.explained_share(np.ones(N)).tolist() == [0.0]
    assert candidate.gain(np.ones((N, 3))).tolist() == [0.0] * 3


def test_of_several_variants_only_visible_ones_stay():
    traces, _ = made(settling, 0.5, 0.5)
    planted = (settling(0.5, time_constant_s=100.0), settling(0.5, time_constant_s=900.0))
    raw = Candidate("settling", traces * [1.0, 1e-9], settling, planted)
    candidate = whitened(raw, refit())
    assert candidate.variants == planted[:1]
    assert candidate.size.size == candidate.traces.shape[1] == 1


def _unit(v):
    return v / np.linalg.norm(v)


@pytest.mark.parametrize(
    "z", [np.arange(40.0), np.random.default_rng(1).normal(size=25), np.repeat([1.0, 5.0, 9.0], 7)]
)
def test_smooth_functions_are_bounded_and_follow_only_the_order_of_values(z):
    basis = _smooth(z)
    assert basis.shape == (z.size, min(5, np.unique(z).size - 1))
    assert np.abs(basis).max() <= 1.0
    assert np.linalg.matrix_rank(np.column_stack([np.ones(z.size), basis])) == basis.shape[1] + 1
    np.testing.assert_array_equal(_smooth(3.0 * z - 8.0), basis)
    shuffle = np.random.default_rng(2).permutation(z.size)
    np.testing.assert_array_equal(_smooth(z[shuffle]), basis[shuffle])
    first = basis[np.argsort(z, kind="stable"), 0]
    assert np.all(np.diff(first) <= 0)
    assert first[0] > 0 > first[-1]


@pytest.mark.parametrize("z", [np.zeros(9), np.full(9, 3.0), 3.0 + 1e-12 * np.arange(9), np.array([7.0])])
def test_a_variable_that_does_not_vary_has_no_functions(z):
    assert _smooth(z).shape == (z.size, 0)


@pytest.fixture(scope="module")
def recorded_timeline(tmp_path_factory):
    """A timeline of a session with its plant model, a prediction, and whitening of readings by noise of one
    count."""
    runs = session_runs(tmp_path_factory.mktemp("candidates"), LISTED, LONG)
    plant_model, per_count = twin_plant_model()
    timeline = build_timeline(runs, plant_model.actuator.tau_s)
    n = sum(len(r) for r in timeline.all_readings)
    scale = np.concatenate(
        [np.full(len(r), 0.03 * per_count if r.unit == "mm" else 1.0) for r in timeline.all_readings]
    )
    noise = NoiseEstimate(np.ones(n), 0.0, 60.0, per_count)
    white = whitening(np.eye(n), scale, noise)
    return timeline, plant_model, predict(timeline, plant_model), white


@pytest.mark.parametrize(("kind", "strength"), [(walking, 0.8), (walking, -0.3), (settling, 0.9)])
def test_an_injected_effect_is_found_along_a_timeline_at_about_its_strength(
    recorded_timeline, kind, strength
):
    timeline, plant_model, base, white = recorded_timeline
    every = {c.name: whitened(c, white) for c in named(timeline, plant_model, base, (walking, settling))}
    planted = kind(strength)
    data = white.whitened(
        predict(timeline, plant_model, [planted]).stacked(timeline) - base.stacked(timeline)
    )
    found, _ = every[kind.name].best(data)
    other = next(c for name, c in every.items() if name != kind.name)
    assert found.strength == pytest.approx(strength, rel=0.1)
    assert every[kind.name].explained_share(data)[0] > 0.98
    assert other.explained_share(data)[0] < every[kind.name].explained_share(data)[0]


def test_a_named_candidate_has_a_variant_for_every_combination_worth_trying(recorded_timeline):
    timeline, plant_model, base, _ = recorded_timeline
    found = {c.name: c for c in named(timeline, plant_model, base, (walking, settling, backlash))}
    assert [p.strength for p in found["walking"].variants] == [0.25 * walking.primary.typical]
    assert {p.values["time_constant_s"] for p in found["settling"].variants} == set(
        settling.parameters[1].tries
    )
    assert [p.strength for p in found["backlash"].variants] == list(backlash.primary.tries)
    for candidate in found.values():
        assert candidate.traces.shape == (base.stacked(timeline).size, len(candidate.variants))
        assert np.abs(candidate.traces).max(axis=0).min() > 0


def test_generic_candidates_touch_only_the_readings_they_speak_of(recorded_timeline):
    timeline, plant_model, base, _ = recorded_timeline
    slope = np.ones(base.output.size)
    rows = {}
    at = 0
    for r in timeline.all_readings:
        rows[r.kind] = slice(at, at + len(r))
        at += len(r)
    positions = rows["settled"].stop - rows["settled"].start + rows["moving"].stop - rows["moving"].start
    found = {c.name: c for c in generic(timeline, plant_model, base, slope)}
    assert {"?time", "?level", "?hold", "?history", "?time of resistance", "?level of room"} <= set(found)
    for name, candidate in found.items():
        assert candidate.generic
        touched = np.flatnonzero(np.any(candidate.traces != 0, axis=1))
        if " of " in name:
            kind = name.split(" of ")[1]
            assert touched.min() >= rows[kind].start
            assert touched.max() < rows[kind].stop
        else:
            assert touched.max() < positions
    assert found["?hold"].depends_on == "hold"
