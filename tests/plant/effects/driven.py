"""Plants driven with effects, from a cold start, in steps long enough to settle."""

import numpy as np

from smarig.core.catalogue import catalogue_entry, catalogue_names
from smarig.plant.actuator import Actuator
from smarig.plant.plant import Plant
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface

CATALOGUE = catalogue_names("smarig.plant.effects")
WIRES = {
    "one_wire": (Actuator.named("gorbet_one_wire"), thesis_surface("one_e"), "negative"),
    "two_wire": (Actuator.named("gorbet_two_wire"), thesis_surface("two_c"), "negative"),
}


def kind(name):
    """An effect by its name."""
    return catalogue_entry("smarig.plant.effects", name)


def wire_of(name):
    """The arrangement an effect needs."""
    arrangement = kind(name).arrangement
    return arrangement if arrangement in WIRES else "one_wire"  # untrained: any wire


def driven(currents, *effects, wire="one_wire", hold_s=40.0, dt_s=0.1):
    """Sensed positions after every tick, (steps, ticks of a hold)."""
    actuator, hysteresis, initial = WIRES[wire]
    plant = Plant(actuator, hysteresis, initial, dt_s, effects)
    ticks = round(hold_s / dt_s)
    return np.array([[plant.sensed(plant.step(i)) for _ in range(ticks)] for i in currents])


def settled(currents, *effects, wire="one_wire", hold_s=40.0):
    """Where each hold ends, (steps,)."""
    return driven(currents, *effects, wire=wire, hold_s=hold_s)[:, -1]
