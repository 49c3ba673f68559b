"""The zero of an increasing function whose least slope is known, with what the function computed there."""

from collections.abc import Callable
from typing import TypeVar

MAX_EVALUATIONS = 80

Result = TypeVar("Result")
Evaluated = tuple[float, Result]


def increasing_root(
    f: Callable[[float], Evaluated[Result]],
    x: float,
    at_x: Evaluated[Result],
    least_slope: float,
    share: float = 1.0,
    end: float | None = None,
    tolerance: float = 1e-9,
) -> tuple[float, Result]:
    """x and the result at f(x) = 0, to ``tolerance`` in x, from a point whose value is known.

    ``f`` returns its value and a result; its slope is at least ``least_slope``. So the zero lies between ``x`` and
    x − f/least_slope, or ``end`` if that is nearer; the first trial goes a ``share`` of that way, then secants and the
    Illinois variant of false position follow.

    >>> x, result = increasing_root(lambda x: (x**3 + x - 10.0, "found"), 0.0, (-10.0, ""), 1.0)
    >>> round(x, 9), result
    (2.0, 'found')
    """
    a, (at_a, result) = x, at_x
    close = tolerance * least_slope
    if abs(at_a) <= close:
        return a, result
    b, at_b = (x - at_a / least_slope if end is None else end), 0.0  # at_b = 0: not evaluated
    slope, trial, moved_b = least_slope, a + share * (b - a), False
    for _ in range(MAX_EVALUATIONS):
        value, result = f(trial)
        if abs(value) <= close:
            break
        if (value > 0) == (at_a > 0):
            if trial in (a, b):  # the end, or two neighbouring numbers
                break
            slope = max((value - at_a) / (trial - a), least_slope)
            a, at_a = trial, value
            at_b *= 1.0 if moved_b else 0.5
            moved_b = False
        else:
            b, at_b = trial, value
            at_a *= 0.5 if moved_b else 1.0
            moved_b = True
        trial = a - at_a * (b - a) / (at_b - at_a) if at_b else _not_beyond(b, a, a - at_a / slope)
    return trial, result


def _not_beyond(end: float, start: float, x: float) -> float:
    return min(x, end) if end > start else max(x, end)
