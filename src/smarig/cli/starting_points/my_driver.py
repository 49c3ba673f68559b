"""A driver of your own, for a current source that speaks lines of text over a serial port (at first SCPI).

It goes into a rig file, relative to it:

    [links.amplifier]
    driver = "./my_driver.py"
    framing = "lines"                # for drivers that use it; this one does not
    url = "/dev/serial/by-id/…"

Then: smarig check ./my_rig.toml. What a current source must be able to do stands in smarig.device.drivers._roles as
CurrentSource; a position sensor has since(), tick(), zero(), identity and close() instead.

An instrument without a lease keeps its current on when the host dies: it may drive a wire only behind an independent
cut-out, with somebody at the bench.
"""

import contextlib

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError, Quality
from smarig.device import (  # a sentence each, with a remedy # no late answer passes for the answer to another question
    CurrentReading,
    Garbled,
    Silent,
    TextLine,
    WrongDevice,
)
from smarig.plant import Actuator

HEADROOM = 1.2  # of the voltage that the largest current needs over the largest resistance


def my_driver(where: LinkFile, rig: RigFile) -> "Source":
    """The function has the file's name. It opens the instrument, proves who it is, and leaves it off."""
    if rig.limits.current_min_A < 0:
        raise ConfigError(f"Rig '{rig.name}': this source drives one way only.")
    heating = Actuator.named(rig.actuator).file.heating
    ohm = max(heating.resistance_martensite.value, heating.resistance_austenite.value)
    return Source(where, HEADROOM * rig.limits.current_max_A * ohm)


class Source:
    """A current source as a bench sees it."""

    has_lease = False  # whether it switches itself off when the host falls silent
    tripped = ""  # why it has switched itself off, a sentence; "" where it has not

    def __init__(self, where: LinkFile, voltage_V: float) -> None:
        self.where, self._voltage_V = where.url, voltage_V
        self._line = TextLine(where.url, where.baud, where.timeout_s, who="*IDN?")
        self._line.write("OUTP OFF")  # before anything else: a host that was killed may have left it on
        self.identity = self._line.identify()
        if self.identity.count(",") < 2:
            raise WrongDevice(f"At {self.where} answers '{self.identity}', which is no SCPI identity.")
        self.arm()

    def arm(self) -> None:
        """Get ready at zero current; a latched trip is cleared."""
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self._line.write(f"VOLT {self._voltage_V:.3f}")

    def set(self, current_A: float) -> int | None:
        """A current from now on. Returns the last tick before it, None where the instrument counts none."""
        self._line.write(f"CURR {current_A:.6f}")
        self._line.write("OUTP ON")
        taken = self._line.number("CURR?")
        if not abs(taken - current_A) <= 2e-3:  # true for nan, too
            self.off()
            raise Garbled(f"{self.where} took {taken:g} A, not {current_A:g} A. {Garbled.remedy}")
        return None

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """Readings from a tick on. One measurement stands for all of them; all but the last are marked as stale."""
        current_A, voltage_V = self._line.number("MEAS:CURR?"), self._line.number("MEAS:VOLT?")
        marks = [Quality.STALE] * (at_most - 1) + [Quality.GOOD]
        return [CurrentReading(tick + k, current_A, voltage_V, NAN, mark) for k, mark in enumerate(marks)]

    def tick(self) -> int:
        """The last tick it has; 0 where it counts none."""
        return 0

    def off(self) -> str:
        """Current to zero, and asked whether it is. Never raises; "", or a sentence where it could not be told."""
        with contextlib.suppress(Silent, Garbled):
            self._line.write("CURR 0")
            self._line.write("OUTP OFF")
            if self._line.number("OUTP?") == 0:
                return ""
        return f"The source at {self.where} does not say that it is off: switch it off by hand, now."

    def close(self) -> None:
        """Let go of the port. Never raises."""
        self._line.close()
