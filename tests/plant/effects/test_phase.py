"""A strength with a phase may have either sign: half a turn is the opposite."""

from types import SimpleNamespace
from typing import Any

import pytest

from smarig.plant import Actuator, effect_types
from smarig.plant.effect import Effect

WITH_PHASE = [kind for kind in effect_types() if any(p.unit == "turn" for p in kind.parameters)]
CONTEXT: Any = SimpleNamespace(actuator=Actuator.named("gorbet_one_wire"))


def changes(effect: Effect, values=(0.0, 1.3, 4.0, 11.9), hours=(0.0, 0.7, 5.0)):
    return [
        change(value, SimpleNamespace(t_s=3600 * h))
        for change in effect.hooks(CONTEXT).values()
        for value in values
        for h in hours
    ]


def test_there_are_such_effects():
    assert {kind.name for kind in WITH_PHASE} >= {"ambient_drift", "eccentricity"}


@pytest.mark.parametrize("kind", WITH_PHASE, ids=lambda kind: kind.name)
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.5, 0.9])
def test_half_a_turn_is_the_opposite_sign(kind, phase):
    negative = kind(-1.2, phase=phase)
    positive = negative.with_positive_strength
    assert positive.strength == 1.2
    assert changes(positive) == pytest.approx(changes(negative), abs=1e-12)
    assert changes(positive) != pytest.approx(changes(kind(1.2, phase=phase)), abs=1e-3)
    assert positive.with_positive_strength == positive
