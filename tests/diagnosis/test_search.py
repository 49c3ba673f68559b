"""The search for explanations begins where something stands out, and only there."""

from types import SimpleNamespace

import pytest

from smarig.diagnosis.search import searched


def test_nothing_is_searched_where_nothing_stands_out():
    def judge(subject):
        pytest.fail("a silent critique was judged again")

    assert searched(SimpleNamespace(silent=True), None, judge, 0.0) == []
