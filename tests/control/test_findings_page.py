"""docs/explanation/control_findings.md agrees with the code."""

from pathlib import Path

import pytest

from control import findings_page

TEXT = (Path(__file__).parents[2] / "docs" / "explanation" / "control_findings.md").read_text(
    encoding="utf-8"
)
TABLES = {
    "| rig | gain | k_e |": findings_page.velocity_rows,
    "| controller | a = b = c = 0 |": findings_page.class_rows,
    "| gain, K per degree |": findings_page.position_rows,
    "| model | way to the second state |": lambda: [findings_page.indistinguishable_row()],
}


def rows_under(head: str) -> list[str]:
    following = TEXT[TEXT.index(head) :].splitlines()[2:]
    return following[: following.index("")]


@pytest.mark.long
@pytest.mark.parametrize("head", TABLES)
def test_the_page_shows_what_is_computed(head: str):
    assert rows_under(head) == TABLES[head]()
