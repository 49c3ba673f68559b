"""Example of a foreign instrument: a laboratory supply in constant-current mode, SCPI text over a serial port.

It has no lease: if the host dies, the current stays on. So it may drive a wire only behind an independent cut-out
(docs/how_to/rig.md), and an operator at the bench. Copy this file for another instrument; its name goes into the rig
file.
"""

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError, Quality
from smarig.device.drivers._roles import CurrentReading
from smarig.device.links.text_line import TextLine
from smarig.device.wire.link_faults import Garbled, Silent, WrongDevice
from smarig.plant import Actuator

HEADROOM = 1.2  # of the voltage that the largest current needs over the largest resistance


def scpi_supply(where: LinkFile, rig: RigFile) -> "ScpiSupply":
    """The supply of a rig file: identified, off, its voltage limited."""
    if rig.limits.current_min_A < 0:
        raise ConfigError(f"Rig '{rig.name}': a supply drives one way only.")
    heating = Actuator.named(rig.actuator).file.heating
    ohm = max(heating.resistance_martensite.value, heating.resistance_austenite.value)
    volts = HEADROOM * rig.limits.current_max_A * ohm
    return ScpiSupply(where, volts)


class ScpiSupply:
    """``CURR``, ``MEAS:CURR?``, ``MEAS:VOLT?``, ``OUTP``; it measures when it is asked, and counts no ticks."""

    def __init__(self, where: LinkFile, voltage_V: float) -> None:
        self.where = where.url
        self._line = TextLine(where.url, where.baud, where.timeout_s)
        self.tripped = ""
        self.has_lease = False
        self._voltage_V = voltage_V
        self._line.write("OUTP OFF")  # first of all: a host that was killed may have left it on
        self.identity = self._line.identify()
        if self.identity.count(",") < 2:
            raise WrongDevice(f"At {self.where} answers '{self.identity}', which is no SCPI identity.")
        self.arm()

    def arm(self) -> None:
        """Off, at zero current, its voltage limited."""
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self._line.write(f"VOLT {self._voltage_V:.3f}")

    def set(self, current_A: float) -> None:
        """Set and switched on; what it took is read back."""
        self._line.write(f"CURR {current_A:.6f}")
        self._line.write("OUTP ON")
        taken = self._line.number("CURR?")
        if not abs(taken - current_A) <= 2e-3:
            self.off()
            raise Garbled(
                f"{self.where} took {taken:g} A where {current_A:g} A were asked for. {Garbled.remedy}"
            )

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """One measurement for all these ticks; all but the last are marked as stale."""
        current_A, voltage_V = self._line.number("MEAS:CURR?"), self._line.number("MEAS:VOLT?")
        marks = [Quality.STALE] * (at_most - 1) + [Quality.GOOD]
        return [CurrentReading(tick + k, current_A, voltage_V, NAN, mark) for k, mark in enumerate(marks)]

    def tick(self) -> int:
        """It counts none."""
        return 0

    def off(self) -> str:
        """Zero, then off, and asked whether it is. Without a lease, nobody else does it."""
        try:
            self._line.write("CURR 0")
            self._line.write("OUTP OFF")
            if self._line.number("OUTP?") == 0:
                return ""
        except (Silent, Garbled):
            pass
        return f"The supply at {self.where} does not say that it is off, and has no lease: switch it off by hand, now."

    def close(self) -> None:
        """Let go of the port."""
        self._line.close()
