"""The seam for effects: none, or a neutral one, changes no bit; a planted one acts at its stage."""

import pytest

from smarig.model.actuator import Actuator
from smarig.model.effect import Stage
from smarig.model.plant import Plant
from smarig.preisach.gorbet_1997 import surface


class Planted:
    """One hook at one stage."""

    def __init__(self, stage, hook):
        self._hooks = {stage: hook}

    def hooks(self, setup):
        return self._hooks


def positions(effects):
    plant = Plant(Actuator.named("gorbet_two_wire"), surface("two_e"), "anhysteretic", 0.1, effects)
    return [plant.step(i) for i in [0.9] * 150 + [-0.6] * 150 + [0.4] * 150]


@pytest.mark.parametrize("stage", list(Stage))
def test_a_neutral_effect_is_the_identity_bit_for_bit(stage):
    assert positions([Planted(stage, lambda value, now: value)]) == positions([])


def test_an_additive_effect_adds():
    shifted = positions([Planted(Stage.ADDITIVE, lambda value, now: value + 0.5)])
    assert shifted == [y + 0.5 for y in positions([])]


def test_an_input_effect_sees_time_and_output():
    seen = []

    def look(value, now):
        seen.append((now.tick, now.output))
        return value

    positions([Planted(Stage.INPUT, look)])
    assert [tick for tick, _ in seen] == list(range(1, 451))
    assert len({output for _, output in seen}) > 300
