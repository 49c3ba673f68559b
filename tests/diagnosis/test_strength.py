"""The maximum of an evidence and its curvature from few tried strengths."""

import math

import numpy as np
import pytest

from smarig.diagnosis.refit.evidence_maximum import MAX_TRIED, EvidenceMaximum, maximise_evidence

BOUNDS = (-20.0, 20.0)


def search_explanations(evidence, start, guess, bounds=BOUNDS):
    """The top from a start, and how many strengths were tried besides."""
    asked = []

    def tried(s):
        asked.append(s)
        return evidence(s), f"at {s}"

    return maximise_evidence(
        tried, EvidenceMaximum(start, evidence(start), f"at {start}", guess), bounds
    ), asked


@pytest.mark.parametrize("sd", [0.02, 0.5, 3.0])
@pytest.mark.parametrize("start", [2.0, 3.4, 5.0])
@pytest.mark.parametrize("guess", [0.1, 1.0])
def test_a_parabolas_top_and_its_sd_are_found(start, guess, sd):
    found, asked = search_explanations(lambda s: 40.0 - (s - 3.0) ** 2 / (2 * sd**2), start, guess)
    assert abs(found.strength - 3.0) < 0.35 * sd
    assert found.sd == pytest.approx(sd, rel=1e-3)
    assert found.at == f"at {found.strength}"
    assert len(asked) <= MAX_TRIED


def test_the_top_of_what_is_no_parabola_is_found_with_the_curvature_there():
    found, _ = search_explanations(lambda s: -50.0 * (math.cosh((s - 1.0) / 2) - 1), 6.0, 0.5)
    assert abs(found.strength - 1.0) < 0.1
    assert found.sd == pytest.approx(1 / math.sqrt(12.5), rel=0.15)


def test_a_top_at_a_bound_is_the_bound():
    found, asked = search_explanations(lambda s: s, 0.0, 1.0, (-2.0, 3.0))
    assert found.strength == 3.0
    assert max(asked) <= 3.0


def test_a_flat_evidence_has_no_sd():
    found, asked = search_explanations(lambda s: 0.0, 1.0, 0.1)
    assert found.sd == math.inf or found.sd > 5.0
    assert len(asked) <= MAX_TRIED


def test_roughness_of_a_nat_does_not_mislead():
    rng = np.random.default_rng(4)
    rough = {}

    def evidence(s):
        return rough.setdefault(s, -0.5 * (s - 3.0) ** 2 + rng.uniform(-0.5, 0.5))

    found, _ = search_explanations(evidence, 2.0, 1.0)
    assert abs(found.strength - 3.0) < 1.5
    assert 0.6 < found.sd < 1.8


@pytest.mark.parametrize("seed", range(5))
def test_an_evidence_much_broader_than_guessed_is_sampled_far_enough(seed):
    """Near the top a tenth of a nat of roughness is all there is."""
    rng = np.random.default_rng(seed)
    rough = {}

    def evidence(s):
        return rough.setdefault(s, -0.5 * (s - 3.0) ** 2 + rng.uniform(-0.05, 0.05))

    found, asked = search_explanations(evidence, 3.0, 0.1)
    assert found.sd == pytest.approx(1.0, rel=0.3)
    assert max(abs(s - 3.0) for s in asked) > 1.0
