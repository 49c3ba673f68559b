"""The interface for effects: without an effect, or with a neutral one, no bit changes; an effect acts at its
stage."""

import pytest

from smarig.plant.actuator import Actuator
from smarig.plant.effect import Stage
from smarig.plant.plant import Plant
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface


class Effect:
    """One hook at one stage."""

    def __init__(self, stage, hook):
        self._hooks = {stage: hook}

    def hooks(self, setup):
        return self._hooks


def positions(effects):
    plant = Plant(Actuator.named("gorbet_two_wire"), thesis_surface("two_e"), "anhysteretic", 0.1, effects)
    return [plant.step(i) for i in [0.9] * 150 + [-0.6] * 150 + [0.4] * 150]


@pytest.mark.parametrize("stage", list(Stage))
def test_a_neutral_effect_is_the_identity_bit_for_bit(stage):
    assert positions([Effect(stage, lambda value, now: value)]) == positions([])


def test_an_additive_effect_adds():
    shifted = positions([Effect(Stage.ADDITIVE, lambda value, now: value + 0.5)])
    assert shifted == [y + 0.5 for y in positions([])]


def test_an_input_effect_sees_time_and_output():
    observed = []

    def look(value, now):
        observed.append((now.tick, now.output))
        return value

    positions([Effect(Stage.INPUT, look)])
    assert [tick for tick, _ in observed] == list(range(1, 451))
    assert len({output for _, output in observed}) > 300
