"""A learned term in words and numbers: its variables, its values in physical units, and a formula if it is straight."""

from dataclasses import dataclass
from typing import Any

from smarig.diagnosis.looks_like import looks_like
from smarig.measurement import LearnedTerm, variable_unit


@dataclass(frozen=True)
class LearnedLaw:
    """Learned terms with the units of the records. ``gain_blocks`` is the share of the error on left-out blocks that
    they remove.
    """

    terms: tuple[LearnedTerm, ...]
    gain_blocks: float
    input_unit: str
    output_unit: str

    @property
    def variables(self) -> tuple[str, ...]:
        """All variables of the law, the one with most effect first."""
        return tuple(dict.fromkeys(v for term in self.terms for v in term.variables))

    def to_json(self) -> dict[str, Any]:
        """The object ``learned`` of the command line: the first term, and a list of all."""
        first = self.terms[0]
        return {
            "variables": list(self.variables),
            "enters": first.enters,
            "formula": self.formula(first),
            "points": points(first),
            "gain_blocks": self.gain_blocks,
            "looks_like": looks_like(first.variable),
            "terms": [
                {
                    "variables": list(term.variables),
                    "enters": term.enters,
                    "form": term.form,
                    "formula": self.formula(term),
                    "points": points(term),
                    "unit": self.value_unit(term),
                    "variable_unit": variable_unit(term.variable, self.input_unit),
                }
                for term in self.terms
            ],
        }

    def value_unit(self, term: LearnedTerm) -> str:
        """Unit of the values of a term."""
        return {"output": self.output_unit, "input": self.input_unit, "play": self.input_unit}.get(
            term.form, "1"
        )

    def formula(self, term: LearnedTerm) -> str | None:
        """The law as a text with units, or None if it is not straight between its ends."""
        if len(term.knots) != 2:
            return None
        slope = (term.values[1] - term.values[0]) / (term.knots[1] - term.knots[0])
        unit = "" if self.value_unit(term) == "1" else f" {self.value_unit(term)}"
        sign, size = ("−" if slope < 0 else "+"), f"{abs(slope):.3g}{unit}{self._per(term)}·{self._z(term)}"
        return {
            "output": f"output {sign} {size}",
            "output_gain": f"output {sign} {size}·(output {_minus(term.centre)} {self.output_unit})",
            "input": f"input {sign} {size}",
            "input_gain": f"input {sign} {size}·(input {_minus(term.centre)} {self.input_unit})",
            "play": f"input with a play of half-width {'−' if slope < 0 else ''}{size}",
        }[term.form]

    def _per(self, term: LearnedTerm) -> str:
        unit = self.output_unit if term.variable == "level" else variable_unit(term.variable, self.input_unit)
        return "" if term.variable == "rate" or unit in ("", "1") else f"/({unit})"

    def _z(self, term: LearnedTerm) -> str:
        start, unit = term.knots[0], variable_unit(term.variable, self.input_unit)
        if term.variable == "rate":
            return f"log10(rate/{10**start:.3g} {unit})"
        name = term.variable.replace("_", " ")
        return f"({name} {_minus(start)})" if abs(start) > 1e-9 else name


def _minus(value: float) -> str:
    """A number that is subtracted, with its operator.

    >>> _minus(2.0), _minus(-2.0)
    ('− 2', '+ 2')
    """
    return f"{'−' if value >= 0 else '+'} {abs(value):.3g}"


def points(term: LearnedTerm) -> list[list[float]]:
    """[variable, value] at each knot; the rate as such, not its logarithm."""
    z = [10**k for k in term.knots] if term.variable == "rate" else term.knots
    return [[float(a), float(b)] for a, b in zip(z, term.values)]
