"""Selects points with a short expression such as ``curve%2==0``.

It accepts the names curve, alpha and beta, arithmetic and comparisons; other Python syntax is an error.
"""

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError

SELECTABLE_NAMES = ("curve", "alpha", "beta")
_MAX_LENGTH = 500

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Mod: operator.mod,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: np.logical_not,
    ast.And: np.logical_and,
    ast.Or: np.logical_or,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


def matches(expression: str, values: Mapping[str, NDArray]) -> NDArray[np.bool_]:
    """The mask (k,) of points for which the expression holds; ``values`` has arrays (k,) for curve, alpha and beta.

    Comparisons, and/or/not, + - * / % and numbers are allowed. Raises UsageError with the part that is not
    understood.

    >>> matches("curve % 2 == 0 and alpha > 10", {"curve": np.arange(4), "alpha": np.array([5., 20, 30, 40])})
    array([False, False,  True, False])
    """
    try:
        tree = ast.parse(expression[: _MAX_LENGTH + 1].strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _selection_error(expression, "it is not an expression") from None
    if len(expression) > _MAX_LENGTH:
        raise _selection_error(expression[:40] + "…", f"it is longer than {_MAX_LENGTH} characters")
    with np.errstate(all="ignore"):  # x/0 and x%0 compare as false, point by point
        try:
            result = np.asarray(_value(tree.body, expression, values))
        except (ZeroDivisionError, OverflowError):
            raise _selection_error(expression, "it divides by zero or overflows") from None
        except TypeError:
            raise _selection_error(expression, "it uses a condition as a number") from None
    if result.dtype != np.bool_ or result.shape != np.shape(values["curve"]):
        raise _selection_error(expression, f"it is not a condition on {', '.join(SELECTABLE_NAMES)}")
    return result


def _value(node: ast.AST, expression: str, values: Mapping[str, NDArray]) -> Any:
    def of(inner: ast.AST) -> Any:
        return _value(inner, expression, values)

    match node:
        case ast.Constant(value=float() | int() as number) if not isinstance(number, bool):
            return float(number)
        case ast.Name(id=name) if name in values:
            return values[name]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](of(left), of(right))
        case ast.UnaryOp(op=op, operand=inner) if type(op) in _OPERATORS:
            return _OPERATORS[type(op)](of(inner))
        case ast.BoolOp(op=op, values=parts):
            return _folded(_OPERATORS[type(op)], [of(part) for part in parts])
        case ast.Compare(left=left, ops=ops, comparators=rights) if all(type(op) in _OPERATORS for op in ops):
            sides = [of(left), *map(of, rights)]
            pairs = [_OPERATORS[type(op)](a, b) for op, a, b in zip(ops, sides, sides[1:])]
            return _folded(np.logical_and, pairs)
    if isinstance(node, ast.Name):
        raise _selection_error(expression, f"'{node.id}' is unknown")
    raise _selection_error(expression, f"'{ast.unparse(node)}' is not allowed")


def _folded(combine: Callable[..., Any], parts: list[Any]) -> Any:
    result = parts[0]
    for part in parts[1:]:
        result = combine(result, part)
    return result


def _selection_error(expression: str, why: str) -> UsageError:
    return UsageError(
        f"Selection '{expression}' is not understood: {why}. "
        f"Use {', '.join(SELECTABLE_NAMES)} with == != < <= > >=, and, or, not, + - * / %, for example curve%2==0."
    )
