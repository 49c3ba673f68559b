"""A term learned from records: a piecewise linear function of one variable, times a second one, with its knots.

    output:   y = P[v] + f(z) s          s: 1, or the output of the hysteresis minus a centre
    input:    v = u + f(z) s             s: 1, or the input minus a centre
    play:     v follows u with a play of half-width f(z) ≥ 0, and leads it by |f(z)| where f < 0

z is one of ``learned_variables`` or the output of the hysteresis (``level``). Beyond its end knots, f is constant.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from smarig.core import Array, DataError, stored_number
from smarig.measurement.input_record import InputRecord
from smarig.measurement.learned_variables import LEVEL, branch_directions, variable_of

NAME = "learned"
FORMS = {  # form: (where it enters, second variable)
    "output": ("output", ""),
    "output_gain": ("output", LEVEL),
    "input": ("input", ""),
    "input_gain": ("input", "input"),
    "play": ("input", "direction"),
}


@dataclass(frozen=True)
class LearnedTerm:
    """f by its ``values`` at increasing ``knots`` of a ``variable``, in one of ``FORMS``.

    Values have the unit of the output (form ``output``), of the input (``input``, ``play``), or 1. ``centre`` is
    that of the second variable of a gain.
    """

    variable: str
    form: str
    knots: tuple[float, ...]
    values: tuple[float, ...]
    centre: float = 0.0

    @property
    def enters(self) -> str:
        """``output`` or ``input``."""
        return FORMS[self.form][0]

    @property
    def variables(self) -> tuple[str, ...]:
        """The variables of the law: z, and the second one if there is one."""
        second = FORMS[self.form][1]
        return (self.variable, second) if second else (self.variable,)

    def at(self, z: Array) -> Array:
        """f(z), shape of z.

        >>> LearnedTerm("time", "output", (0.0, 10.0), (0.0, 2.0)).at(np.array([-5.0, 5.0, 20.0])).tolist()
        [0.0, 1.0, 2.0]
        """
        return np.interp(z, self.knots, self.values)

    def functions(self, z: Array) -> Array:
        """The functions (n, knots − 1) of z whose coefficients are the values at all knots but the first."""
        hats = np.eye(len(self.knots))[1:]
        return np.column_stack([np.interp(z, self.knots, hat) for hat in hats])

    def with_values(self, free: Array) -> "LearnedTerm":
        """The term with values at all knots but the first, where it is 0."""
        return replace(self, values=(0.0, *(float(v) for v in free)))

    def to_json(self) -> dict[str, Any]:
        """Plain values, as stored in a model file."""
        return {
            "name": NAME,
            "variable": self.variable,
            "form": self.form,
            "knots": list(self.knots),
            "values": list(self.values),
            "centre": self.centre,
        }

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "LearnedTerm":
        """The term of a model file. Raises DataError for a damaged one."""
        try:
            knots, values = (
                tuple(stored_number(v, f"one of its {key}") for v in stored[key])
                for key in ("knots", "values")
            )
            centre = stored_number(stored["centre"], "its centre")
            term = cls(str(stored["variable"]), str(stored["form"]), knots, values, centre)
        except (DataError, KeyError, TypeError, ValueError) as error:
            raise DataError(f"a learned term of the model is damaged: {error}") from None
        damage = _damage(term)
        if damage:
            raise DataError(f"a learned term of the model is damaged: {damage}")
        return term


def _damage(term: LearnedTerm) -> str:
    if term.form not in FORMS:
        return f"its form {term.form!r:.40} is none of {', '.join(FORMS)}"
    if len(term.knots) < 2 or len(term.knots) != len(term.values):
        return "it needs as many values as knots, and two or more"
    if min(np.diff(term.knots)) <= 0:
        return "its knots do not increase"
    if term.variable == LEVEL and term.form != "output":
        return "only an output can depend on the level"
    return ""


def learned_input(record: InputRecord, u: Array, terms: Sequence[LearnedTerm]) -> Array:
    """The input (n,) of the hysteresis: u (n,) of a record under the terms that enter at the input, in turn."""
    for term in terms:
        if term.enters == "input":
            f = term.at(variable_of(record, term.variable))
            u = (
                _with_play(u, f, branch_directions(record))
                if term.form == "play"
                else u + f * _factor(term, u)
            )
    return u


def learned_output(record: InputRecord, level: Array, terms: Sequence[LearnedTerm]) -> Array:
    """What the terms that enter at the output add, (n,), for the output of the hysteresis ``level`` (n,)."""
    added = np.zeros(level.size)
    for term in terms:
        if term.enters == "output":
            z = level if term.variable == LEVEL else variable_of(record, term.variable)
            added = added + term.at(z) * _factor(term, level)
    return added


def _factor(term: LearnedTerm, x: Array) -> Array:
    return x - term.centre if term.form in ("output_gain", "input_gain") else np.ones(x.size)


def _with_play(u: Array, half_width: Array, direction: Array) -> Array:
    """u (n,) behind a play of half-width (n,) where that is positive, and ahead by it where negative."""
    width, found = np.maximum(half_width, 0.0), np.empty(u.size)
    if not width.any():
        return u - half_width * direction
    follows = float(u[0] - width[0] * direction[0])
    for k, (low, high) in enumerate(zip((u - width).tolist(), (u + width).tolist())):
        follows = min(max(follows, low), high)
        found[k] = follows
    return found + np.maximum(-half_width, 0.0) * direction
