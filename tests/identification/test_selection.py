"""Selection of points by an expression: arithmetic works, code is refused."""

import numpy as np
import pytest

from smarig.core.errors import UsageError
from smarig.identification.point_selection import matches

VALUES = {
    "curve": np.array([0, 1, 2, 3]),
    "alpha": np.array([10.0, 20.0, 30.0, 40.0]),
    "beta": np.array([0.0, 20.0, -5.0, 10.0]),
}


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("curve%2==0", [1, 0, 1, 0]),
        ("curve % 2 == 1 and alpha > 20", [0, 0, 0, 1]),
        ("not (beta < 0) or curve == 2", [1, 1, 1, 1]),
        ("0 <= beta < alpha - 5", [1, 0, 0, 1]),
        ("alpha/10 - 1 == curve", [1, 1, 1, 1]),
        ("(alpha + beta) * 2 >= 80", [0, 1, 0, 1]),
        ("-beta > 0", [0, 0, 1, 0]),
        ("curve % 0 == 0", [0, 0, 0, 0]),
    ],
)
def test_expressions(expression, expected):
    assert matches(expression, VALUES).astype(int).tolist() == expected


@pytest.mark.parametrize(
    "expression",
    [
        "",
        "curve ==",
        "curve",
        "1 < 2",
        "gamma > 1",
        "curve.size > 1",
        "__import__('os').system('true') == 0",
        "[c for c in curve] == 1",
        "curve ** 9 == 0",
        "curve == 'a'",
        "curve == True",
        "(lambda: curve == 1)()",
        "1/0 == curve",
        "alpha > 1" + " and alpha > 1" * 100,
        "(" * 400 + "curve==1" + ")" * 400,
    ],
)
def test_anything_else_is_refused_with_one_sentence(expression):
    with pytest.raises(UsageError, match="is not understood") as refused:
        matches(expression, VALUES)
    assert "\n" not in str(refused.value)
