"""The software twin: a specimen in place of hardware, with the interface of a rig.

Time is the twin's own integer tick and advances only with a request (lock-step), so eight hours take seconds. The
twin has the lease of the real devices: after a longer time without commands its output switches off and stays off.
"""

from smarig.config import RigFile, load_rig
from smarig.core import NAN, LeaseExpired, Quality, Sample, UsageError
from smarig.device import load_register_map
from smarig.plant import Actuator
from smarig.rig.rig import Alarm
from smarig.rig.specimen import Specimen, TwinSettings, register_scales


class Twin:
    """A rig in software, for example ``Twin.named("one_wire_twin")``.

    >>> twin = Twin.named("one_wire_twin", seed=1)
    >>> samples = [twin.step(1.0)[0] for _ in range(600)]        # a minute at 1 A
    >>> 12.4 < samples[-1].position < 12.7
    True
    """

    def __init__(self, rig: RigFile, actuator: Actuator, settings: TwinSettings | None = None) -> None:
        self.file, self.actuator, self.settings = rig, actuator, settings or TwinSettings()
        self.output_A = self._command_A = self._quantised_A = 0.0
        self.tripped = ""
        self.specimen = Specimen(rig, actuator, self.settings)
        self.position_per_count = self.specimen.position_per_count
        self._current_register = load_register_map("amplifier")["current"].value
        self._scales = register_scales()
        self._zero_counts = 0

    @classmethod
    def named(cls, rig: str, **settings) -> "Twin":
        """A twin from configs/rigs by name or path; keyword arguments as in TwinSettings."""
        file = load_rig(rig)
        return cls(file, Actuator.named(file.actuator), TwinSettings(**settings))

    @property
    def tick(self) -> int:
        """Ticks since power-up."""
        return self.specimen.tick

    @property
    def period_s(self) -> float:
        """Length of a tick."""
        return self.file.period_s

    def step(self, current_A: float, at_most: int = 1) -> tuple[Sample, ...]:
        """Apply a current for the next tick and return its sample."""
        del at_most  # a twin works tick by tick; blocks save nothing
        if self.tripped:
            raise LeaseExpired(
                f"{self.file.name} has switched its output off: {self.tripped} Re-arm it with arm()."
            )
        if current_A != current_A:
            raise UsageError("The current of the twin is NaN. Give a number.")
        if current_A != self._command_A:
            self._command_A, self._quantised_A = current_A, self._current_register.rounded(current_A)
        self.output_A = self._quantised_A
        return (self._advance(current_A),)

    def idle(self, seconds: float) -> None:
        """Let device time pass without commands; the lease trips when it expires."""
        ticks = round(seconds / self.period_s)
        lease = round(self.file.lease_s / self.period_s)
        for k in range(ticks):
            if k >= lease and not self.tripped:
                self.output_A = 0.0
                self.tripped = f"no command from the host for {self.file.lease_s:g} s."
            self._advance(self.output_A, Quality.TRIPPED if self.tripped else Quality.GOOD)

    def arm(self) -> None:
        """Clear a latched trip; the output stays at zero until the next step."""
        self.tripped = ""

    def zero(self) -> None:
        """Zero the incremental encoder at its present position."""
        self._zero_counts = self.specimen.counts_now()

    def safe(self) -> None:
        """Set the output to zero."""
        self.output_A = 0.0

    @property
    def shutdown_unconfirmed(self) -> str:
        """Always "": the twin is in the same process."""
        return ""

    def alarms(self) -> list[Alarm]:
        """Always empty."""
        return []

    def close(self) -> None:
        """Do nothing: a twin holds no resources."""

    def _advance(self, command_A: float, quality: Quality = Quality.GOOD) -> Sample:
        reading, s = self.specimen.advance(self.output_A), self._scales
        counts = reading.counts - self._zero_counts
        return Sample(
            tick=self.tick,
            t_s=self.tick * self.file.period_s,
            current_command_A=command_A,
            current_A=reading.current / s.per_A,
            voltage_V=reading.voltage / s.per_V,
            temperature_degC=NAN,
            counts=counts,
            position=counts * self.position_per_count,
            ambient_degC=reading.ambient / s.per_degC,
            quality=int(quality) | int(Quality.SATURATED) if reading.saturated else int(quality),
        )
