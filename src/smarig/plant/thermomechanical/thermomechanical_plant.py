"""A plant whose wires follow Brinson's model and their own heat balance, in place of (5.1) and a Preisach operator.

It has what a specimen needs of a plant. The constants of the table [heating] do not enter, except R/hA if the table
[thermomechanical] asks for a constant heat transfer coefficient.
"""

import math

from smarig.plant.actuator import Actuator
from smarig.plant.effect import PlantState
from smarig.plant.thermomechanical.mechanisms import Antagonists, DeadWeight, WireMechanism
from smarig.plant.thermomechanical.wire import Energy, Heating, Wire

MAX_PART = 0.05  # of the time constant: longer ticks are subdivided
AMBIENT_DEGC, REST_TICKS = 22.0, 100  # of the travel: ten time constants


class ThermomechanicalPlant:
    """The wires of an actuator file with a table [thermomechanical], cold and loaded at the start.

    ``force_N``: the load of a single wire, in place of that of the file.

    >>> plant = ThermomechanicalPlant(Actuator.named("thermomechanical_one_wire"), dt_s=0.1, ambient_degC=22.0)
    >>> for _ in range(600):
    ...     position_mm = plant.step(1.0)
    >>> round(position_mm, 1), [round(xi, 3) for xi in plant.austenite]
    (12.5, [1.0])
    """

    def __init__(
        self, actuator: Actuator, dt_s: float, ambient_degC: float, force_N: float | None = None
    ) -> None:
        file = actuator.file
        constant_h = file.thermomechanical is not None and file.thermomechanical.heat_loss == "constant"
        wires = [
            Wire(file, actuator.h_W_per_m2_K if constant_h else None)
            for _ in range(2 if actuator.two_wire else 1)
        ]
        self.actuator, self.ambient_degC = actuator, ambient_degC
        self.mechanism: WireMechanism = (
            Antagonists((wires[0], wires[1]), file, ambient_degC)
            if actuator.two_wire
            else DeadWeight(wires[0], file, ambient_degC, force_N)
        )
        parts = max(1, math.ceil(dt_s / (MAX_PART * actuator.tau_s)))
        self._parts, self._part_s = parts, dt_s / parts
        self.now = PlantState(dt_s=dt_s)
        self._update(0.0)

    def step(self, current_A: float, disturbance_K: float = 0.0, force_N: float | None = None) -> float:
        """Advance one tick at constant current and return the position.

        The disturbance is added to the ambient temperature. ``force_N``: the load of a single wire at the end of the
        tick; None: that of the start.
        """
        ambient_degC = self.ambient_degC + disturbance_K
        heating = Heating(current_A, ambient_degC, self._part_s)
        each = (heating,)
        if self.actuator.two_wire:
            idle = Heating(0.0, ambient_degC, self._part_s)
            each = (heating, idle) if current_A >= 0 else (idle, heating)
        for _ in range(self._parts):
            self.mechanism.advance(each, force_N)
        self.now.tick += 1
        self.now.t_s = self.now.tick * self.now.dt_s
        self._update(current_A)
        return self.position

    def _update(self, current_A: float) -> None:
        now = self.now
        now.command_A = now.current_A = current_A
        self.position = now.output = self.mechanism.position
        now.austenite = self.austenite[self._index(current_A)]

    def sensed(self, counts: float) -> float:
        """Counts that the sensor indicates, before quantisation: those of the position."""
        return counts

    def current(self, command_A: float) -> float:
        """The current that flowed in the last step: the commanded one."""
        return command_A

    def resistance_ohm(self, current_A: float) -> float:
        """Resistance of the wire that carries this current."""
        return self._wire(current_A).state.resistance_ohm

    @property
    def austenite(self) -> tuple[float, ...]:
        """Austenite fraction 1 − ξ of each wire."""
        return tuple(1.0 - wire.state.phase.martensite for wire in self.mechanism.wires)

    @property
    def wire_K(self) -> list[float]:
        """Temperature of each wire above ambient."""
        return [wire.state.temperature_degC - self.ambient_degC for wire in self.mechanism.wires]

    @property
    def stress_MPa(self) -> float:
        """The stress of wire 1; that of wire 2 is equal without a torque on the shaft."""
        return self.mechanism.wires[0].state.stress_MPa

    @property
    def energy(self) -> tuple[Energy, ...]:
        """Sums of each wire in joules since the start."""
        return tuple(wire.energy for wire in self.mechanism.wires)

    def _wire(self, current_A: float) -> Wire:
        return self.mechanism.wires[self._index(current_A)]

    def _index(self, current_A: float) -> int:
        """The diodes steer the current by its sign."""
        return 1 if current_A < 0 and self.actuator.two_wire else 0


def thermomechanical_travel(actuator: Actuator) -> float:
    """The way between both ends: each wire is heated in turn to the temperature of [heating], in the rig's unit.

    >>> round(thermomechanical_travel(Actuator.named("thermomechanical_one_wire")), 1)
    13.0
    """
    plant = ThermomechanicalPlant(actuator, actuator.tau_s / 10, ambient_degC=AMBIENT_DEGC)
    current_A = actuator.file.heating.reference_current.value
    positions = [plant.position]
    for share in (1.0, 0.0, -1.0) if actuator.two_wire else (1.0,):
        positions += [plant.step(share * current_A) for _ in range(REST_TICKS)]
    return max(positions) - min(positions)
