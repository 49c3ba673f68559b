"""docs/explanation/dissipativity.md agrees with the code."""

from pathlib import Path

import pytest

from theory.energy.dissipativity_page import rows

PAGE = Path(__file__).parents[3] / "docs" / "explanation" / "dissipativity.md"


@pytest.fixture(scope="module")
def tables() -> tuple[list[str], list[str]]:
    return rows()


def lines_between(text: str, head: str) -> list[str]:
    """The rows of the table under a header line."""
    following = text[text.index(head) :].splitlines()[2:]
    return following[: following.index("")]


@pytest.mark.long("takes three seconds")
def test_the_page_shows_the_certificates_as_computed(tables):
    head = "| model | dissipative | smallest loop area |"
    assert lines_between(PAGE.read_text(encoding="utf-8"), head) == tables[0]


def test_the_page_shows_the_violations_as_computed(tables):
    head = "| model | from | approach cost |"
    assert lines_between(PAGE.read_text(encoding="utf-8"), head) == tables[1]


def test_the_comparison_would_notice_another_digit(tables):
    changed = PAGE.read_text(encoding="utf-8").replace("-0.04587", "-0.04588")
    assert lines_between(changed, "| model | dissipative | smallest loop area |") != tables[0]
