"""Severities: their order, and the table that gives them by kind."""

import pytest

from smarig.core.severity import KIND_SEVERITY, LEVEL_SEVERITY, Severity, highest_severity, severity_of


def test_the_four_are_those_of_epics_in_rising_order():
    words = ["none", "minor", "major", "invalid"]
    assert [str(s) for s in Severity] == words
    for k, low in enumerate(Severity):
        assert [s.reaches(low) for s in Severity] == [False] * k + [True] * (4 - k)


def test_the_highest_is_by_rank_and_not_by_letter():
    assert highest_severity([]) == Severity.NONE
    assert highest_severity([Severity.INVALID, Severity.NONE, Severity.MINOR]) == Severity.INVALID
    assert highest_severity([Severity.MAJOR, Severity.MINOR, Severity.NONE]) == Severity.MAJOR


@pytest.mark.parametrize(
    ("kind", "level", "data", "severity"),
    [
        ("mark", "info", {}, "none"),
        ("clock", "warning", None, "minor"),
        ("jump", "error", {}, "major"),
        ("lost", "warning", {}, "minor"),
        ("lost", "error", {}, "major"),
        ("blind", "error", {}, "invalid"),
        ("end", "warning", {"severity": "major"}, "major"),
        ("blind", "error", {"severity": "minor"}, "minor"),
        ("mark", "info", {"severity": 3}, "none"),
        ("mark", "info", {"severity": ["major"]}, "none"),
        ("mark", "info", {"severity": "dreadful"}, "none"),
        ("mark", "", {}, "none"),
    ],
)
def test_stated_then_by_kind_then_by_level(kind, level, data, severity):
    assert severity_of(kind, level, data) == severity


def test_the_table_holds_only_what_no_level_implies():
    assert not set(KIND_SEVERITY.values()) & set(LEVEL_SEVERITY.values())
