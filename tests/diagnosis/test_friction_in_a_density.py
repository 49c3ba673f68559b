"""A friction makes every loop wider, and so does a density: what a density has taken up is looked for as well."""

from dataclasses import dataclass

import numpy as np
import pytest

import smarig
from smarig.diagnosis import diagnose_commanded
from smarig.diagnosis.comparison.commanded.effect_trials import weaker
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part, Trial
from smarig.plant.effect_catalogue import effect_types, effects_from_pairs
from smarig.rig.twin import TwinSettings
from smarig.runner.session import Session

FRICTION = next(k for k in effect_types() if k.name == "coulomb_friction")


@dataclass(frozen=True)
class Fitted:
    """A model with effects."""

    effects: tuple


class Scores:
    """A subject whose score is best at a strength of 0.5."""

    def with_density(self, effects, _start):
        return Fitted(tuple(effects))

    def trial(self, fitted):
        strength = fitted.effects[-1].strength
        parameters = {"coulomb_friction.half_width_K": strength}
        return Trial(parameters, np.array([-100 * (strength - 0.5) ** 2]), np.zeros(1))


@pytest.mark.parametrize(("start", "linear", "best"), [(2.0, 0.0, 0.5), (4.0, 0.0, 0.5), (2.0, -300.0, 2.0)])
def test_a_strength_is_halved_while_its_score_is_below_that_of_the_trace(start, linear, best):
    subject, fitted = Scores(), Fitted((FRICTION(start),))
    found = ComparedHypothesis((Part("effect", "coulomb_friction"),), (subject.trial(fitted),))
    hypothesis, model = weaker(subject, fitted, (found, fitted), linear)
    assert model.effects[-1].strength == best
    assert hypothesis.best.parameters == {"coulomb_friction.half_width_K": best}


@pytest.mark.long("takes a minute")
def test_a_friction_is_named_although_a_density_imitates_it(tmp_path):
    """Without smaller strengths, `accommodation` was named with 0.9: it explained what the density left."""
    effects = effects_from_pairs(["coulomb_friction=3"])
    for seed, name in ((1, "first_order_descending"), (2, "validation")):
        with Session("one_wire_twin", twin=TwinSettings(seed=seed, effects=effects)) as session:
            session.run(name, {}, tmp_path / f"{name}.run.sqlite")
    train, held_out = (tmp_path / f"{n}.run.sqlite" for n in ("first_order_descending", "validation"))
    model = smarig.identify([train], surface="exponential").model
    assert diagnose_commanded(model, train, held_out).verdict.names == ("coulomb_friction",)
