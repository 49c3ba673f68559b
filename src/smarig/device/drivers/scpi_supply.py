"""Example of an instrument by another maker: a laboratory supply in constant-current mode, SCPI over a serial port.

It has no lease: if the host fails, the current stays on. It may drive a wire only with an independent cut-out
(docs/how_to/rig.md) and an operator at the bench. Copy this file for another instrument and put its name into the rig
file.
"""

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError, Quality
from smarig.device.encoding.link_faults import Garbled, Silent, WrongDevice
from smarig.device.links.text_line import TextLine
from smarig.device.roles.ticked import CurrentReading
from smarig.plant import Actuator, largest_voltage_V


def scpi_supply(where: LinkFile, rig: RigFile) -> "ScpiSupply":
    """The supply of a rig file: identified, switched off, with its voltage limited."""
    if rig.limits.current_min_A < 0:
        raise ConfigError(
            f"Rig '{rig.name}' has current_min_A = {rig.limits.current_min_A:g} A. A supply gives current of one "
            "sign only."
        )
    return ScpiSupply(where, largest_voltage_V(rig.limits, Actuator.named(rig.actuator)))


class ScpiSupply:
    """Uses ``CURR``, ``MEAS:CURR?``, ``MEAS:VOLT?``, ``OUTP``. It measures on request and counts no ticks."""

    def __init__(self, where: LinkFile, voltage_V: float) -> None:
        self.where = where.url
        self._line = TextLine(
            where.url,
            where.baud,
            where.timeout_s,
            line_end=where.line_end,
            serial_format=where.serial_format,
        )
        self.tripped = ""
        self.has_lease = self._on = False
        self._voltage_V = voltage_V
        self._line.write("OUTP OFF")  # first: a killed host may have left it on
        self.identity = self._line.identify()
        if self.identity.count(",") < 2:
            raise WrongDevice(
                f"The device at {self.where} identifies itself as '{self.identity}'. This is not an SCPI identity."
            )
        self.arm()

    def arm(self) -> None:
        """Switch off at zero current and limit the voltage."""
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self._line.write(f"VOLT {self._voltage_V:.3f}")

    def set(self, current_A: float) -> None:
        """Set the current, switch on and read the setting back."""
        self._line.write(f"CURR {current_A:.6f}")
        if not self._on:  # only then: what a protection has switched off must stay off
            self._on = True
            self._line.write("OUTP ON")
        taken = self._line.number("CURR?")
        if not abs(taken - current_A) <= 2e-3:
            self.off()
            raise Garbled(
                f"{self.where} accepted {taken:g} A instead of the commanded {current_A:g} A. "
                f"{Garbled.remedy_at(self.where)}"
            )

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """One measurement for all these ticks; all but the last are marked as stale."""
        current_A, voltage_V = self._line.number("MEAS:CURR?"), self._line.number("MEAS:VOLT?")
        marks = [Quality.STALE] * (at_most - 1) + [Quality.GOOD]
        return [CurrentReading(tick + k, current_A, voltage_V, NAN, mark) for k, mark in enumerate(marks)]

    def measured_A(self) -> float:
        """The current that is measured now."""
        return self._line.number("MEAS:CURR?")

    def tick(self) -> int:
        """Always 0: it counts no ticks."""
        return 0

    def off(self) -> str:
        """Set zero, switch off and query the output. Without a lease, nothing else switches it off."""
        self._on = False
        try:
            self._line.write("CURR 0")
            self._line.write("OUTP OFF")
            if self._line.number("OUTP?") == 0:
                return ""
        except (Silent, Garbled):
            pass
        return f"The supply at {self.where} did not confirm that it is off. It has no lease: switch it off by hand now."

    def close(self) -> None:
        """Close the port."""
        self._line.close()
