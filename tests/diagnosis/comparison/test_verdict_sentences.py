"""The sentences of a verdict: what is about as likely is told, and sums above 1 are explained."""

import pytest

from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.verdict_rules import Verdict
from smarig.diagnosis.comparison.verdict_sentences import verdict_lines


def lines(verdict: Verdict, **causes: float) -> str:
    kinds = {"cycle": "variable", "time": "variable", "level": "variable"}
    parts = {Part(kinds.get(name, "effect"), name): p for name, p in causes.items()}
    return " ".join(verdict_lines(verdict, [], parts, "Silent."))


@pytest.mark.parametrize(("time", "is_named"), [(0.35, True), (0.2, False)])
def test_a_variable_that_is_about_as_likely_is_told_too(time: float, is_named: bool) -> None:
    found = lines(Verdict("unknown", "variable", (), "cycle"), cycle=0.6, time=time)
    assert ("the number of cycles or on the time" in found) is is_named


def test_a_single_candidate_does_not_compete() -> None:
    found = lines(Verdict("unknown", "confounded", ("wire_lag",)), wire_lag=1.0)
    assert "The likeliest cause: wire_lag (1.00)." in found
    assert "competes" not in found


@pytest.mark.parametrize(("walking", "is_named"), [(0.6, True), (0.3, False)])
def test_a_sum_above_one_is_explained(walking: float, is_named: bool) -> None:
    found = lines(Verdict("ambiguous", "shared", ("slip", "walking")), slip=0.6, walking=walking)
    assert ("so the sum exceeds 1" in found) is is_named
