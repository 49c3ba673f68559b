"""The tests of §5.3 as statistical tests: small violations are found, noise is not, and "holds" states its limit."""

import os

import numpy as np
import pytest

from smarig.identification import congruency, wiping_out
from smarig.identification.surface.representation_tests import difference_test
from smarig.plant import effects_from_pairs
from smarig.record import load_run
from smarig.rig import TwinSettings
from smarig.runner import Session

K = 18
RNG_SEED = 5


def run_of_twin(folder, protocol, seed, effects=()):
    twin = TwinSettings(seed=seed, effects=effects_from_pairs(effects))
    with Session("one_wire_twin", twin=twin, wire=f"representation {os.getpid()}") as session:
        return load_run(session.run(protocol, {}, folder / f"{protocol}{seed}.run.sqlite"))


@pytest.mark.long("takes five seconds")
def test_a_twin_that_is_a_preisach_model_passes_both_tests(tmp_path):
    found = [congruency(run_of_twin(tmp_path, "congruency", seed)) for seed in range(2)]
    found.append(wiping_out(run_of_twin(tmp_path, "wiping_out", 0)))
    assert all(f.holds for f in found)
    assert min(f.p_value for f in found) > 0.01
    for f in found:
        assert 0.3 * f.noise < f.hidden < 3 * f.noise


def test_a_non_congruency_of_a_tenth_of_a_count_is_found(tmp_path):
    found = congruency(run_of_twin(tmp_path, "congruency", 1, ["noncongruency=1.5"]))
    assert found.max_abs < 1.0 * found.per_count
    assert found.p_value < 0.01
    assert not found.holds
    assert "p = " in found.verdict


@pytest.mark.long("takes five seconds")
def test_what_a_figure_can_show_is_what_is_tested(tmp_path):
    """The differences without the offset of the corner, over their own σ: their sum of squares is χ²."""
    for name, test, free in (("congruency", congruency, 1), ("wiping_out", wiping_out, 0)):
        found = test(run_of_twin(tmp_path, name, 0, ["walking=0.6"]))
        over_sigma = (found.second - found.first - found.common) / found.spread
        freedom = found.input.size - free
        assert np.sqrt(np.sum(over_sigma**2) / freedom) == pytest.approx(found.times_noise)
        assert bool(found.common) == bool(free)


def test_p_values_are_uniform_on_noise_alone():
    rng = np.random.default_rng(RNG_SEED)
    sd = rng.uniform(0.5, 2.0, K)
    for free in (False, True):
        p = [
            difference_test(sd * rng.standard_normal(K) + 3.0 * free, sd, free_offset=free).p_value
            for _ in range(800)
        ]
        assert np.quantile(p, [0.05, 0.5, 0.95]) == pytest.approx([0.05, 0.5, 0.95], abs=0.05)


def test_a_violation_at_precise_points_is_seen_although_imprecise_ones_dominate_the_rms():
    sd = np.array([0.1, 0.1, 0.1, 5.0, 5.0, 5.0])
    difference = np.array([0.5, -0.5, 0.5, 0.1, -0.1, 0.1])
    found = difference_test(difference, sd, free_offset=False)
    assert np.sqrt(np.mean(difference**2)) < np.sqrt(np.mean(sd**2))
    assert found.times_noise == pytest.approx(np.sqrt(np.mean((difference / sd) ** 2)))
    assert found.times_noise > 3
    assert found.p_value < 1e-6


def test_a_difference_of_the_stated_size_would_rarely_have_looked_so_small():
    rng = np.random.default_rng(RNG_SEED)
    sd = np.full(K, 0.7)
    seen = sd * rng.standard_normal(K) * 1.1
    hidden = difference_test(seen, sd, free_offset=False).hidden
    shape = np.sin(np.arange(K))
    shape *= hidden / np.sqrt(np.mean(shape**2))
    drawn = shape + sd * rng.standard_normal((4000, K))
    small = np.sum((drawn / sd) ** 2, axis=1) <= np.sum((seen / sd) ** 2)
    assert np.mean(small) == pytest.approx(0.05, abs=0.015)
