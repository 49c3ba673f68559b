"""The plant against the complete base model on one page: current in; temperature, position and counts out."""

import numpy as np
import pytest

from plant.reference_model import counts_along, input_along, output_along
from preisach.relay_reference import Printed
from smarig.plant.actuator import Actuator
from smarig.plant.effect import Stage
from smarig.plant.heating import temperature_along
from smarig.plant.plant import Plant
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

CASES = [
    ("gorbet_one_wire", "one_c", "negative"),
    ("gorbet_one_wire", "one_p", "negative"),
    ("gorbet_one_wire", "one_e", "negative"),
    ("gorbet_one_wire", "one_e", "anhysteretic"),
    ("gorbet_two_wire", "two_c", "anhysteretic"),
    ("gorbet_two_wire", "two_p", "anhysteretic"),
    ("gorbet_two_wire", "two_e", "anhysteretic"),
    ("gorbet_two_wire", "two_e", "negative"),
]


def record(rig: str, seed: int) -> np.ndarray:
    """A current held for a few ticks at a time, loops within loops, full swings among them; (n,) in A."""
    rng = np.random.default_rng(seed)
    levels = rng.uniform(0 if rig == "gorbet_one_wire" else -1, 1, 40)
    levels[[12, 25]] = 1.0
    levels[18] = 0.0 if rig == "gorbet_one_wire" else -1.0
    return np.repeat(levels, rng.integers(1, 9, levels.size))


@pytest.mark.parametrize(("rig", "name", "initial"), CASES)
def test_the_plant_is_the_page(rig: str, name: str, initial):
    actuator, dt_s, current = Actuator.named(rig), 2.0, record(rig, 1)
    u = input_along(rig, current, dt_s)
    y = output_along(name, u, initial == "anhysteretic")
    range_ = Printed(name).range
    assert np.ptp(u) > 0.8 * (thesis_surface(name).upper - thesis_surface(name).lower) * (
        1 if rig.endswith("two_wire") else 0.9
    )
    assert np.ptp(y) > 0.8 * range_
    assert np.allclose(temperature_along(actuator, current, dt_s), u, rtol=0, atol=1e-10)
    plant = Plant(actuator, thesis_surface(name), initial, dt_s)
    position = np.array([plant.step(i) for i in current.tolist()])
    assert np.max(np.abs(position - y)) <= 1e-11 * range_
    counts = position / actuator.position_per_count(2000)
    assert np.allclose(counts, counts_along(rig, y), rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", ["one_p", "two_p", "two_e"])
@pytest.mark.parametrize("anhysteretic", [False, True])
def test_the_operator_is_its_boundary_integral(name: str, anhysteretic: bool):
    """Without heating, over the whole plane and past both saturations; inputs at no particular levels."""
    p = Printed(name)
    rng = np.random.default_rng(5)
    inputs = rng.uniform(p.lower - 10, p.upper + 10, 150) * rng.uniform(0.3, 1, 150)
    here = Preisach(thesis_surface(name)).simulate(inputs, "anhysteretic" if anhysteretic else "negative")
    assert np.max(np.abs(here - output_along(name, inputs, anhysteretic))) <= 1e-12 * p.range


class Nothing:
    """An effect that hooks every stage and changes nothing."""

    def hooks(self, setup):
        """Identity at every stage."""
        return dict.fromkeys(Stage, lambda value, now: value)


@pytest.mark.parametrize("rig", ["gorbet_one_wire", "gorbet_two_wire"])
def test_hooks_that_change_nothing_change_nothing(rig: str):
    """The long way through the plant is the short way, bit for bit; negative currents too."""
    actuator = Actuator.named(rig)
    h, initial = thesis_surface("one_e" if rig == "gorbet_one_wire" else "two_e"), "anhysteretic"
    short, long = Plant(actuator, h, initial, 0.1), Plant(actuator, h, initial, 0.1, [Nothing()])
    for i in np.random.default_rng(2).uniform(-1, 1, 500).tolist():
        assert long.step(i, 0.3) == short.step(i, 0.3)
    assert long.austenite == short.austenite
    assert long.sensed(12.3) == short.sensed(12.3) == 12.3
