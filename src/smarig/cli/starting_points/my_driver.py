"""A driver of your own for a current source with a text protocol on a serial port. This example speaks SCPI.

Name it in a rig file in the same folder:

    [links.amplifier]
    driver = "./my_driver.py"
    framing = "lines"                # this driver does not use it
    url = "/dev/serial/by-id/…"

Then run: smarig check --driver ./my_driver.py --url /dev/serial/by-id/… It checks each method on the instrument.
smarig.device.roles.polled lists what each role needs: a position sensor has position() and unit in place of
set_current(), measure(), arm() and off().

An instrument without a lease keeps its current on when the host fails. Let it drive a wire only behind an independent
cut-out and with somebody at the bench.
"""

import contextlib

from smarig.config import LinkFile, RigFile
from smarig.core import ConfigError
from smarig.device import Electrical, Garbled, Silent, TextLine, WrongDevice
from smarig.plant import Actuator

HEADROOM = 1.2  # times the voltage of the largest current through the largest resistance


def my_driver(where: LinkFile, rig: RigFile) -> "Source":
    """Open the instrument, verify its identity, and leave it off. The function has the name of the file."""
    if rig.limits.current_min_A < 0:
        raise ConfigError(f"Rig '{rig.name}' has a negative current_min_A, but this source is unipolar.")
    heating = Actuator.named(rig.actuator).file.heating
    ohm = max(heating.resistance_martensite.value, heating.resistance_austenite.value)
    return Source(where, HEADROOM * rig.limits.current_max_A * ohm)


class Source:
    """A current output with the methods that a bench calls, once in each tick."""

    has_lease = False  # whether it switches itself off when the host stops sending commands
    tripped = ""  # why it has switched itself off, as a sentence; "" if it has not

    def __init__(self, where: LinkFile, voltage_V: float) -> None:
        self.where, self._voltage_V = where.url, voltage_V
        self._line = TextLine(where.url, where.baud, where.timeout_s, who="*IDN?")
        self._line.write("OUTP OFF")  # first of all: a host that was killed may have left the output on
        self.identity = self._line.identify()
        if self.identity.count(",") < 2:
            raise WrongDevice(f"The device at {self.where} answers '{self.identity}', not an SCPI identity.")
        self.arm()

    def arm(self) -> None:
        """Prepare for operation at zero current, and clear a latched trip."""
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self._line.write(f"VOLT {self._voltage_V:.3f}")

    def set_current(self, current_A: float) -> None:
        """Set the current and read the setting back. The bench refuses NaN before it comes here."""
        self._line.write(f"CURR {current_A:.6f}")
        self._line.write("OUTP ON")
        accepted_A = self._line.number("CURR?")
        if not abs(accepted_A - current_A) <= 2e-3:  # also true for nan
            self.off()
            raise Garbled(f"{self.where} set {accepted_A:g} A instead of {current_A:g} A. {Garbled.remedy}")

    def measure(self) -> Electrical:
        """The current and the voltage now, and the temperature of the wire if the instrument measures it."""
        return Electrical(self._line.number("MEAS:CURR?"), self._line.number("MEAS:VOLT?"))

    def off(self) -> str:
        """Set the current to zero and verify it. Never raises; returns "", or a sentence if the reply is missing."""
        with contextlib.suppress(Silent, Garbled):
            self._line.write("CURR 0")
            self._line.write("OUTP OFF")
            if self._line.number("OUTP?") == 0:
                return ""
        return f"The source at {self.where} did not confirm that it is off. Switch it off by hand now."

    def close(self) -> None:
        """Close the port. Never raises."""
        self._line.close()
