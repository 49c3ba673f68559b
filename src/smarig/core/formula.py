"""A profile over time given as text, such as T(t) or a load F(t): arithmetic of t, never executed as Python.

The text is parsed into a syntax tree, and only numbers, t, pi, e, + − * / **, parentheses and a few functions are
evaluated; every other element is refused by name.
"""

import ast
import math
import operator
import warnings
from collections.abc import Callable

from smarig.core.errors import UsageError
from smarig.core.shown_text import shown

LONGEST_TEXT = 500
_OPERATORS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
}
_CONSTANTS = {"pi": math.pi, "e": math.e}
_FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "sin": (1, math.sin),
    "cos": (1, math.cos),
    "tan": (1, math.tan),
    "exp": (1, math.exp),
    "log": (1, math.log),
    "sqrt": (1, math.sqrt),
    "abs": (1, math.fabs),
    "min": (2, lambda a, b: a + b if math.isnan(a + b) else min(a, b)),  # not a number stays none
    "max": (2, lambda a, b: a + b if math.isnan(a + b) else max(a, b)),
}
_Evaluated = Callable[[float], float]


class Formula:
    """A function of t from text. Raises UsageError for text that is not one, and for values that are not finite.

    Calls of anything but the listed functions, attributes, comparisons and all other Python are refused.

    >>> profile = Formula("87 + 60*sin(2*pi*t/600)*exp(-t/1800)")
    >>> profile(0.0), round(profile(150.0), 3)
    (87.0, 142.203)
    """

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        if not self.text or len(self.text) > LONGEST_TEXT:
            raise UsageError(f"A formula must have 1 to {LONGEST_TEXT} characters.")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", SyntaxWarning)  # of what is refused anyhow
                tree = ast.parse(self.text, mode="eval")
        except (SyntaxError, ValueError):
            raise self._error(
                "cannot be read; write a function of t, such as 87+60*sin(2*pi*t/600)*exp(-t/1800)"
            ) from None
        except (RecursionError, MemoryError):
            raise self._error("is nested too deeply") from None
        try:
            self._value = self._compiled(tree.body)
        except RecursionError:
            raise self._error("is nested too deeply") from None

    def __call__(self, t: float) -> float:
        """The value at t."""
        try:
            value = float(self._value(t))
        except ZeroDivisionError:
            raise self._error(f"divides by zero at t = {t:g}") from None
        except (ArithmeticError, ValueError, RecursionError):
            raise self._error(f"has no finite value at t = {t:g}") from None
        if not math.isfinite(value):
            raise self._error(f"has no finite value at t = {t:g}")
        return value

    def _compiled(self, node: ast.expr) -> _Evaluated:
        match node:
            case ast.Constant():
                number = self._number(node.value)
                return lambda _: number
            case ast.Name(id="t"):
                return lambda t: t
            case ast.Name(id=name) if name in _CONSTANTS:
                return lambda _: _CONSTANTS[name]
            case ast.Name(id=name):
                raise self._error(f"contains '{name:.40}'; it may use t, pi, e and {', '.join(_FUNCTIONS)}")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self._compiled(operand)
                return lambda t: -inner(t)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self._compiled(operand)
            case ast.BinOp(op=op) if type(op) in _OPERATORS:
                combine, left, right = (
                    _OPERATORS[type(op)],
                    self._compiled(node.left),
                    self._compiled(node.right),
                )
                return lambda t: combine(left(t), right(t))
            case ast.BinOp(op=ast.BitXor()):
                raise self._error("contains ^; powers are written with **")
            case ast.Call():
                return self._call(node)
        raise self._error("may contain only numbers, t, pi, e, + - * / **, parentheses and functions of them")

    def _call(self, node: ast.Call) -> _Evaluated:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name not in _FUNCTIONS:
            raise self._error(f"calls something other than {', '.join(_FUNCTIONS)}")
        size, function = _FUNCTIONS[name]
        if len(node.args) != size or node.keywords:
            raise self._error(f"gives {name} a wrong number of arguments; it takes {size}")
        arguments = [self._compiled(a) for a in node.args]
        return lambda t: function(*(a(t) for a in arguments))

    def _number(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._error(f"contains {shown(value, 20)}, which is not a real number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isinf(number):
            raise self._error("contains a number that is too large")
        return number

    def _error(self, reason: str) -> UsageError:
        return UsageError(f"The formula {shown(self.text)} {reason}.")
