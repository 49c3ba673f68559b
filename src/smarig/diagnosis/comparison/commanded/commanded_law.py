"""The law of a variable that a model of commanded runs has in place of effects, with what it removes of the error."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.looks_like import PLANT_EFFECTS
from smarig.plant import LEARNED, Effect, EffectType, LearnedShape


@dataclass(frozen=True)
class CommandedLaw:
    """A learned ``effect``. ``gain_blocks`` is the share of the rms error on left-out blocks that it removes.

    ``looks_like`` are the effects that leave an error which depends on the same variable.
    """

    effect: Effect
    gain_blocks: float
    looks_like: tuple[str, ...]

    @classmethod
    def of(
        cls,
        effect: Effect,
        hypotheses: Sequence[ComparedHypothesis],
        parts: tuple[Part, ...],
        possible: Iterable[EffectType],
    ) -> "CommandedLaw":
        """The law of the hypothesis that has only these parts, on a rig with these possible effects."""
        names = {kind.name for kind in possible}
        similar = tuple(n for n in PLANT_EFFECTS.get(effect.kind.shape.variable, ()) if n in names)
        trials = next(h for h in hypotheses if h.parts == parts).trials
        own = [t for t in trials if any(name.startswith(f"{LEARNED}.") for name in t.parameters)]
        nothing = next(h for h in hypotheses if not h.parts).best
        left = max(own, key=lambda t: t.score).squares.sum()
        return cls(effect, 1.0 - float(np.sqrt(left / nothing.squares.sum())), similar)

    @property
    def shape(self) -> LearnedShape:
        """Variable, place and knots."""
        return self.effect.kind.shape

    @property
    def points(self) -> list[list[float]]:
        """[variable, value] at each knot, in their units."""
        values = (0.0, *self.effect.values.values())
        return [[z, value] for z, value in zip(self.shape.knots_in_unit, values)]

    def to_json(self) -> dict[str, Any]:
        """The object ``learned`` of the command line, as for measured inputs."""
        shape = self.shape
        term = {"variables": [shape.variable], "enters": shape.enters, "formula": None, "points": self.points}
        whole = {"gain_blocks": self.gain_blocks, "looks_like": list(self.looks_like)}
        units = {"unit": shape.unit, "variable_unit": shape.variable_unit}
        return term | whole | {"terms": [term | {"form": shape.enters} | units]}
