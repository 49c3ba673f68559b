"""Which extended model is offered under an unknown verdict, and what the sentences claim of it and of its errors."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.diagnosis.comparison.commanded.commanded_comparison import _variable_instead
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.measured import measured_diagnosis
from smarig.diagnosis.comparison.measured.measured_text import NO_LAW, _held_out, _learned
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge
from smarig.diagnosis.comparison.verdict_rules import Verdict, VerdictEvidence
from smarig.diagnosis.diagnosis_text import learned_gain_text
from smarig.diagnosis.held_out_gain import HeldOutGain

BACKLASH, SPEED = Part("effect", "backlash"), Part("variable", "rate")


@pytest.mark.parametrize(("reason", "offered"), [("confounded", False), ("variable", True)])
def test_no_law_is_offered_of_one_of_several_variables_that_go_together(monkeypatch, reason, offered):
    """Held-out runs of the same programme predict well with the law of any of them."""
    monkeypatch.setattr(measured_diagnosis, "extension_by_law", lambda _, variable: variable)
    verdict = Verdict("unknown", reason, ("output_drift",), "rate")
    found = measured_diagnosis._extension(None, SimpleNamespace(verdict=verdict, between_runs=False))
    assert (found == "rate") is offered
    d = SimpleNamespace(
        learned=None,
        extension=None,
        evidence=SimpleNamespace(between_runs=False),
        findings=(),
        verdict=verdict,
    )
    assert (NO_LAW in next(_learned(d))) is not offered


@pytest.mark.parametrize(
    ("word", "variable", "effect", "instead"),
    [
        ("unknown", 0.97, 0.08, True),
        ("unknown", 0.97, 0.9, False),
        ("unknown", 0.3, 0.2, False),
        ("named", 0.97, 0.08, False),
    ],
)
def test_an_unlikely_effect_is_not_offered_where_a_variable_is_likely(word, variable, effect, instead):
    evidence = VerdictEvidence(
        causes={SPEED: variable, BACKLASH: effect},
        nothing=0.0,
        size={},
        span=1.0,
        error=0.1,
        noise=0.01,
        blocks=20,
    )
    verdict = Verdict(word, "variable", depends_on="rate")
    assert _variable_instead(verdict, evidence, (BACKLASH,)) is instead


def test_errors_say_over_which_readings_they_are():
    gain = HeldOutGain(np.ones(12), np.full(12, 0.5), np.arange(12), 0.1)
    (said,) = _held_out(SimpleNamespace(gain=gain, extended=True, unit="A"))
    assert "at 12 readings" in said
    assert "smarig verify" in said


def test_effects_of_the_same_variable_are_not_said_to_resemble_the_errors():
    said = learned_gain_text(0.4, ["backlash", "creep"])
    assert said.endswith("Effects that depend on the same variable: backlash, creep.")
    assert "looks like" not in said
    assert learned_gain_text(0.4, []).endswith("left out of the fit.")


def test_missing_knowledge_is_an_upper_bound_and_denies_no_change():
    said = MissingKnowledge(0.93, (1.0, 2.0)).sentence("A")
    assert said.startswith(
        "Up to 93 % of the held-out error is missing knowledge, and nothing need have changed:"
    )
