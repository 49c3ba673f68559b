"""The software twin: plant and instruments in place of hardware, behind the same seam.

Time is the twin's own integer tick, advanced only when asked (lock-step), so eight hours take
seconds. It has the lease of the real devices: left alone for longer, its output goes off and stays off.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from smarig.config import RigFile, load_rig
from smarig.errors import LeaseExpired, UsageError
from smarig.model.actuator import Actuator
from smarig.model.effect import Effect
from smarig.model.plant import Plant
from smarig.model.planted import mystery
from smarig.preisach.everett import Everett
from smarig.preisach.gorbet_1997 import surface
from smarig.preisach.operator import Initial
from smarig.rig.noise import Noise
from smarig.sample import NAN, Quality, Sample

_COUNTS, _CURRENT, _VOLTAGE, _DRAUGHT = range(4)


@dataclass(frozen=True)
class TwinSettings:
    """What may differ between two twins of one rig file."""

    seed: int = 0
    noise: bool = True
    hysteresis: Everett | None = None
    initial: Initial | None = None
    effects: Sequence[Effect] = ()


class Twin:
    """A rig in software; ``Twin.named("one_wire_twin")``.

    >>> twin = Twin.named("one_wire_twin", seed=1)
    >>> samples = [twin.step(1.0)[0] for _ in range(600)]        # a minute at 1 A
    >>> 12.4 < samples[-1].position < 12.7
    True
    """

    def __init__(self, rig: RigFile, actuator: Actuator, settings: TwinSettings | None = None) -> None:
        s = settings or TwinSettings()
        if s.seed < 0:
            raise UsageError(f"Seed {s.seed} is negative; give a whole number from 0 up.")
        self.file, self.actuator, self.settings = rig, actuator, s
        self.tick = 0
        self.output_A = 0.0
        self.tripped = ""
        hysteresis = actuator.file.hysteresis
        hidden = mystery(s.seed, actuator.file.arrangement) if rig.hidden_effect else ()
        self.plant = Plant(
            actuator,
            s.hysteresis or surface(hysteresis.surface),
            s.initial or hysteresis.initial,
            rig.period_s,
            (*hidden, *s.effects),
        )
        self.position_per_count = actuator.position_per_count(rig.encoder.counts_per_rev)
        self._noise = [Noise(s.seed, channel) for channel in range(4)]
        scale = 1.0 if s.noise else 0.0
        self._sd_counts = scale * rig.encoder.noise_counts
        self._sd_A = scale * rig.amplifier.current_noise_A
        self._sd_V = scale * rig.amplifier.voltage_noise_V
        self._sd_K = scale * rig.temperature_noise_K
        self._draught_K, self._draught_decay = 0.0, math.exp(-rig.period_s / rig.temperature_noise_time_s)
        self._zero_counts = round(self._counts_now())

    @classmethod
    def named(cls, rig: str, **settings) -> "Twin":
        """A twin from configs/rigs by name or path; keyword arguments as in TwinSettings."""
        file = load_rig(rig)
        return cls(file, Actuator.named(file.actuator), TwinSettings(**settings))

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.file.period_s

    def step(self, current_A: float) -> tuple[Sample, ...]:
        """Apply a current for the next tick and return its sample."""
        if self.tripped:
            raise LeaseExpired(
                f"{self.file.name} has switched its output off: {self.tripped} Re-arm it with arm()."
            )
        if current_A != current_A:
            raise UsageError("The twin was given NaN as its current.")
        limit = self.file.amplifier.saturation_A
        self.output_A = min(max(current_A, -limit if self.actuator.two_wire else 0.0), limit)
        quality = Quality.SATURATED if self.output_A != current_A else Quality.GOOD
        return (self._advance(current_A, int(quality)),)

    def idle(self, seconds: float) -> None:
        """Let device time pass with the host silent; the lease trips when it runs out."""
        ticks = round(seconds / self.period_s)
        lease = round(self.file.lease_s / self.period_s)
        for k in range(ticks):
            if k >= lease and not self.tripped:
                self.output_A = 0.0
                self.tripped = f"nothing was heard from the host for {self.file.lease_s:g} s."
            self._advance(self.output_A, int(Quality.TRIPPED) if self.tripped else 0)

    def arm(self) -> None:
        """Clear a latched trip; the output stays at zero until the next step."""
        self.tripped = ""

    def zero(self) -> None:
        """Zero the relative encoder where it stands."""
        self._zero_counts = math.floor(self._counts_now() + 0.5)

    def safe(self) -> None:
        """Output to zero."""
        self.output_A = 0.0

    def _advance(self, command_A: float, quality: int) -> Sample:
        self.tick = tick = self.tick + 1
        current = self.output_A
        if self._sd_K:
            kick = self._noise[_DRAUGHT].at(tick) * math.sqrt(1 - self._draught_decay**2)
            self._draught_K = self._draught_K * self._draught_decay + self._sd_K * kick
        self.plant.step(current, self._draught_K)
        counts = self.plant.sensed(self._counts_now())
        if self._sd_counts:
            counts += self._sd_counts * self._noise[_COUNTS].at(tick)
        whole = math.floor(counts + 0.5) - self._zero_counts
        current = self.plant.current(current)
        measured = current + self._sd_A * self._noise[_CURRENT].at(tick) if self._sd_A else current
        voltage = current * self._resistance_ohm(current)
        if self._sd_V:
            voltage += self._sd_V * self._noise[_VOLTAGE].at(tick)
        return Sample(
            tick,
            tick * self.file.period_s,
            command_A,
            measured,
            voltage,
            NAN,
            whole,
            whole * self.position_per_count,
            self.file.ambient_degC + self.plant.now.ambient_K,
            quality,
        )

    def _counts_now(self) -> float:
        return self.plant.position / self.position_per_count

    def _resistance_ohm(self, current_A: float) -> float:
        austenite = self.plant.austenite
        factor = self.plant.now.resistance
        return factor * self.actuator.resistance_at_ohm(1 - austenite if current_A < 0 else austenite)
