"""A driver of your own for an instrument with a text protocol, on a serial port or a TCP socket.

This example speaks SCPI to a box that is a current source and a position sensor. Change the texts in quotes to those of
your instrument.

Name it in a rig file in the same folder, for one or both of these roles:

    [links.amplifier]
    driver = "./my_driver.py"
    framing = "lines"                # of text; line_end, if they end otherwise than with a line feed
    url = "tcp://HOST:PORT"          # or a serial port: /dev/serial/by-id/…

    [links.encoder_daq]
    driver = "./my_driver.py"
    framing = "lines"
    url = "tcp://HOST:PORT"          # the same: both roles share the line

Then run: smarig check ./my_rig.toml --driver ./my_driver.py, and with --role encoder_daq. It checks each method on the
instrument. The page "Your own bench in ten minutes" goes on from here; smarig.device.roles.polled lists what each role
needs.

An instrument without a lease keeps its current on when the host fails. Let it drive a wire only behind an independent
cut-out and with somebody at the bench.
"""

import contextlib
import math

from smarig.config import LinkFile, RigFile
from smarig.core import ConfigError
from smarig.device import Electrical, Garbled, SharedTextLine, Silent, WrongDevice, shared_text_line
from smarig.plant import Actuator

HEADROOM = 1.2  # times the voltage of the largest current through the largest resistance


def my_driver(where: LinkFile, rig: RigFile) -> "SourceAndSensor":
    """Open the instrument, verify its identity, and leave it off. The function has the name of the file."""
    if rig.limits.current_min_A < 0:
        raise ConfigError(f"Rig '{rig.name}' has a negative current_min_A, but this source is unipolar.")
    heating = Actuator.named(rig.actuator).file.heating
    ohm = max(heating.resistance_martensite.value, heating.resistance_austenite.value)
    # acknowledged=True for an instrument that answers each command, such as with OK
    line = shared_text_line(where, who="*IDN?", acknowledged=False)
    try:
        return SourceAndSensor(line, rig.lease_s, HEADROOM * rig.limits.current_max_A * ohm)
    except BaseException:
        line.close()
        raise


class SourceAndSensor:
    """A current output and a position.

    A bench calls ``set_current`` when the current changes, ``measure`` and ``position`` once in each tick. A watchdog
    that any command renews is served by these queries. One that wants more, such as a register that changes, is served
    in ``measure``, while the output is on.
    """

    unit = "mm"  # of the position: "mm", "deg" or "count"
    absolute = (
        True  # whether the zero of the position survives a restart, as that of a laser; a counter's does not
    )

    def __init__(self, line: SharedTextLine, lease_s: float, voltage_V: float) -> None:
        self.line, self._lease_s, self._voltage_V = line, lease_s, voltage_V
        self.has_lease = False  # whether it switches itself off when the host stops sending commands
        self.tripped = ""  # why it has switched itself off, as a sentence; "" if it has not
        self._on = False
        line.write("OUTP OFF")  # first of all: a host that was killed may have left the output on
        self.identity = line.identify()
        if self.identity.count(",") < 2:
            raise WrongDevice(f"The device at {line.where} answers '{self.identity}', not an SCPI identity.")

    # --- source: the link `amplifier` --------------------------------------------------------------------------------

    def arm(self) -> None:
        """Prepare for operation at zero current, clear a latched trip, and start the watchdog."""
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self.line.write("OUTP:PROT:CLE")
        self.line.write(f"VOLT {self._voltage_V:.3f}")
        self.tripped = ""
        self.line.write(
            f"SYST:WDOG {self._lease_s:g}"
        )  # an instrument without a watchdog: delete this line and the next
        self.has_lease = math.isclose(self.line.number("SYST:WDOG?"), self._lease_s)

    def set_current(self, current_A: float) -> None:
        """Set the current and read the setting back. The bench refuses NaN before it comes here."""
        self.line.write(f"CURR {current_A:.6f}")
        if not self._on:  # only then: what its watchdog has switched off must stay off
            self._on = True
            self.line.write("OUTP ON")
        accepted_A = self.line.number("CURR?")
        if not abs(accepted_A - current_A) <= 2e-3:  # also true for nan
            self.off()
            raise Garbled(
                f"{self.line.where} set {accepted_A:g} A instead of {current_A:g} A. "
                f"{Garbled.remedy_at(self.line.where)}"
            )

    def measure(self) -> Electrical:
        """The current and the voltage now, and the temperature of the wire if the instrument measures it."""
        if self._on and self.line.number("OUTP?") == 0:
            self._on = False
            self.tripped = (
                f"{self.identity} has switched off or was never on: check watchdog, protection, key, OUTP ON."
            )
        return Electrical(self.line.number("MEAS:CURR?"), self.line.number("MEAS:VOLT?"))

    def off(self) -> str:
        """Set the current to zero and verify it. Never raises; returns "", or a sentence if the reply is missing.

        Orders by ``write``: it sends at once, also if nothing is answered any more; ``ask`` would wait. An instrument
        without OUTP? confirms by CURR?, or else by the measured current.
        """
        self._on = False
        for _ in range(2):  # the second time over a line that was found broken and is opened again
            with contextlib.suppress(Silent, Garbled):
                self.line.write("CURR 0")
                self.line.write("OUTP OFF")
                if self.line.number("OUTP?") == 0:
                    return ""
        text = f"The source at {self.line.where} did not confirm that it is off."
        if not self.has_lease:
            return f"{text} It has no lease: switch it off by hand now."
        return f"{text} Its watchdog switches it off within {self._lease_s:g} s of silence; if not, do so by hand."

    # --- sensor: the link `encoder_daq` ------------------------------------------------------------------------------

    def position(self) -> float:
        """The position now, in ``unit``; NaN if the sensor sees nothing. Heating must make it larger."""
        return self.line.number("MEAS:POS?")

    # --- both --------------------------------------------------------------------------------------------------------

    def close(self) -> None:
        """Leave the line. Never raises."""
        self.line.close()
