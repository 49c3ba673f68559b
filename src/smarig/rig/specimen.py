"""The wire on its rig, in software: plant and instruments, one tick at a time, as register values.

The in-process twin and the simulated devices share it, so their readings are equal. Readings are the integers of
``firmware_protocol``, so they have the resolution of the registers.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from smarig.config import RigFile
from smarig.core import UsageError
from smarig.device import load_register_map
from smarig.plant import Actuator, Plant, SupportsHooks, ThermomechanicalPlant, load_of, mystery_effects
from smarig.preisach import Everett, Initial

_COUNTS, _CURRENT, _VOLTAGE, _AMBIENT_FLUCTUATION = range(4)


_BLOCK = 4096


@dataclass(frozen=True)
class TwinSettings:
    """Settings in which two twins of one rig file may differ."""

    seed: int = 0
    noise: bool = True
    hysteresis: Everett | None = None
    initial: Initial | None = None
    effects: Sequence[SupportsHooks] = ()


class RawReading(NamedTuple):
    """The readings of one tick as register values; ``counts`` since power-up."""

    current: int
    voltage: int
    counts: int
    ambient: int
    temperature: int
    saturated: bool


class RegisterScales(NamedTuple):
    """Scales of the registers, in words per unit."""

    per_A: float
    per_V: float
    per_degC: float
    no_temperature: int


def register_scales() -> RegisterScales:
    """Scales of the registers that hold readings."""
    amplifier = {f.name: f for f in load_register_map("amplifier")["ring"].field}
    ambient = next(f for f in load_register_map("encoder_daq")["ring"].field if f.name == "ambient")
    none = amplifier["temperature"].none
    return RegisterScales(
        amplifier["current"].per_unit,
        amplifier["voltage"].per_unit,
        ambient.per_unit,
        none if none is not None else 0,
    )


class Specimen:
    """A wire with amplifier output, encoder and thermometer. ``advance`` lets one tick pass."""

    def __init__(self, rig: RigFile, actuator: Actuator, settings: TwinSettings) -> None:
        if settings.seed < 0:
            raise UsageError(f"Seed {settings.seed} is negative. Give a whole number ≥ 0.")
        self.tick = 0
        self.file, self.actuator = rig, actuator
        self.plant = plant_of(rig, actuator, settings)
        load = load_of(rig, actuator)
        self._force = load.force() if load and load.changes and settings.hysteresis is None else None
        self.position_per_count = actuator.resolution(rig.encoder)
        self._scales = register_scales()
        self._noise = [TickNoise(settings.seed, channel) for channel in range(4)]
        scale = 1.0 if settings.noise else 0.0
        self._sd_counts = scale * rig.encoder.noise_counts
        self._sd_A = scale * rig.amplifier.current_noise_A
        self._sd_V = scale * rig.amplifier.voltage_noise_V
        self._sd_K = scale * rig.temperature_noise_K
        self._ambient_fluctuation_K = 0.0
        self._ambient_fluctuation_decay = math.exp(-rig.period_s / rig.temperature_noise_time_s)
        self._ambient_innovation = math.sqrt(1 - self._ambient_fluctuation_decay**2)
        self._power_up_counts = math.floor(
            self._encoder_counts() + 0.5
        )  # an incremental encoder starts at 0 at its present position
        self._max_A = rig.amplifier.saturation_A
        self._min_A = -self._max_A if actuator.two_wire else 0.0

    def limited_A(self, output_A: float) -> float:
        """The commanded current, limited to the range of the amplifier."""
        return min(max(output_A, self._min_A), self._max_A)

    def advance(self, output_A: float) -> RawReading:
        """Let one tick pass at a commanded current and return its readings."""
        self.tick = tick = self.tick + 1
        limited_A = self.limited_A(output_A)
        if self._sd_K:
            innovation = self._noise[_AMBIENT_FLUCTUATION].at(tick) * self._ambient_innovation
            self._ambient_fluctuation_K = (
                self._ambient_fluctuation_K * self._ambient_fluctuation_decay + self._sd_K * innovation
            )
        self._step(limited_A)
        counts = self.plant.sensed(self._encoder_counts())
        if self._sd_counts:
            counts += self._sd_counts * self._noise[_COUNTS].at(tick)
        current = self.plant.current(limited_A)
        measured = current + self._sd_A * self._noise[_CURRENT].at(tick) if self._sd_A else current
        voltage = current * self.plant.resistance_ohm(current)
        if self._sd_V:
            voltage += self._sd_V * self._noise[_VOLTAGE].at(tick)
        s = self._scales
        return RawReading(
            round(measured * s.per_A),
            round(voltage * s.per_V),
            math.floor(counts + 0.5) - self._power_up_counts,
            round((self.file.ambient_degC + self.plant.now.ambient_K) * s.per_degC),
            s.no_temperature,
            limited_A != output_A,
        )

    def _step(self, limited_A: float) -> None:
        plant = self.plant
        if self._force is None or not isinstance(plant, ThermomechanicalPlant):
            plant.step(limited_A, self._ambient_fluctuation_K)
        else:
            force_N = self._force(self.tick * self.file.period_s)
            plant.step(limited_A, self._ambient_fluctuation_K, force_N)

    def counts_now(self) -> int:
        """The present counts since power-up, without noise."""
        return math.floor(self._encoder_counts() + 0.5) - self._power_up_counts

    @property
    def wire_K(self) -> list[float]:
        """The temperature of each wire above ambient."""
        plant = self.plant
        return plant.wire_K if isinstance(plant, ThermomechanicalPlant) else plant.heating.wire_K

    def _encoder_counts(self) -> float:
        return self.plant.position / self.position_per_count


def plant_of(rig: RigFile, actuator: Actuator, settings: TwinSettings) -> Plant | ThermomechanicalPlant:
    """The plant of an actuator file, or that of the settings' hysteresis, which replaces the file's.

    Raises UsageError if a thermomechanical wire is given effects or an initial state: both are those of the operator.
    """
    if actuator.file.thermomechanical is not None and settings.hysteresis is None:
        if settings.effects or rig.hidden_effect:
            raise UsageError(
                f"Effects act on a Preisach operator, and the wire of {actuator.name} has none. Use a rig whose "
                "actuator has no table [thermomechanical]."
            )
        if settings.initial is not None:
            raise UsageError(
                f"The wire of {actuator.name} starts cold under its load. Give no initial state."
            )
        load = load_of(rig, actuator)
        force_N = load.force()(0.0) if load else None
        return ThermomechanicalPlant(actuator, rig.period_s, rig.ambient_degC, force_N)
    hidden = mystery_effects(settings.seed, actuator.file.arrangement) if rig.hidden_effect else ()
    return Plant(
        actuator,
        settings.hysteresis or actuator.hysteresis,
        settings.initial or actuator.file.hysteresis.initial,
        rig.period_s,
        (*hidden, *settings.effects),
        phase_heating=actuator.file.heating.twin_heat == "phase_resistance",
    )


class TickNoise:
    """Standard normal numbers by tick.

    >>> a, b = TickNoise(seed=3, channel=1), TickNoise(seed=3, channel=1)
    >>> late = b.at(9000)
    >>> [a.at(k) for k in range(9001)][-1] == late
    True
    """

    def __init__(self, seed: int, channel: int) -> None:
        self._key = np.array([seed, channel], dtype=np.uint64)
        self._block = -1
        self._values: list[float] = []

    def at(self, tick: int) -> float:
        """The number of one tick."""
        block, offset = divmod(tick, _BLOCK)
        if block != self._block:
            counter = np.array([0, 0, 0, block], dtype=np.uint64)
            generator = np.random.Generator(np.random.Philox(key=self._key, counter=counter))
            self._block, self._values = block, generator.standard_normal(_BLOCK).tolist()
        return self._values[offset]
