"""An analogue output of an NI device that commands a current amplifier or a voltage stage. Untested on hardware."""

import math
import time

from pydantic import Field

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError, Number, SmarigError, UsageError
from smarig.device.drivers._analogue_stage import StageSettings
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._ni import (
    NiInput,
    NiInputs,
    close_task,
    closed_on_failure,
    device_name,
    identity_of,
    ni_errors,
    ni_package,
)
from smarig.device.drivers._ni_watchdog import NiWatchdog
from smarig.device.encoding.link_faults import Silent
from smarig.device.roles.polled import Electrical

OFF_SHARE = 0.02  # of the largest current: what is measured at 0 V
OFF_READINGS = 20  # until the current must have fallen
OFF_WAIT_S = 0.01  # between two of them


class NiOutputSettings(StageSettings):
    """[links.amplifier.settings] of ni_output. Either ``amperes_per_volt`` or ``volts_per_volt``."""

    channel: str = Field(min_length=1, max_length=40)  # output: "ao0"
    largest_V: Number = Field(default=10.0, gt=0, le=60)  # what the output can give
    current_input: NiInput  # measures the current, in A: shunt or monitor output
    voltage_input: NiInput | None = None  # measures the voltage across the wire, in V
    watchdog: bool = False  # whether the device has a watchdog that sets its output to 0 V


def ni_output(where: LinkFile, rig: RigFile) -> "NiOutput":
    """The analogue output of a rig file, at 0 V: a current output, or a voltage output if its stage is one."""
    settings = settings_of(where, NiOutputSettings)
    largest_V = settings.largest_V_of(rig)
    if largest_V > settings.largest_V:
        raise ConfigError(
            f"The largest output of the rig needs {largest_V:.3g} V at {settings.channel}, which gives at most "
            f"{settings.largest_V:g} V. Lower limits.current_max_A, or change the scale of the amplifier."
        )
    kind = NiCurrent if settings.drives_current else NiVoltage
    return kind(where, settings, rig)


class NiOutput:
    """What both kinds share. Opening sets the output to 0 V; ``off`` is confirmed by the measured current."""

    def __init__(self, where: LinkFile, settings: NiOutputSettings, rig: RigFile) -> None:
        self._device, self._settings = device_name(where), settings
        largest_A = max(rig.limits.current_max_A, -rig.limits.current_min_A)
        self._off_A = OFF_SHARE * largest_A
        self.tripped, self.has_lease, self._closed = "", False, False
        channel = f"{self._device}/{settings.channel}"
        self._watchdog = NiWatchdog(self._device, channel, rig.lease_s) if settings.watchdog else None
        self._lease_s = rig.lease_s
        with ni_errors(self._device):
            self._task = ni_package().Task()
        with closed_on_failure(self._task):
            with ni_errors(self._device):
                self._task.ao_channels.add_ao_voltage_chan(
                    channel, min_val=-settings.largest_V, max_val=settings.largest_V
                )
            self._write(0.0)  # first: a killed host may have left it on
            self.identity = f"{identity_of(self._device)}, {settings.channel}"
            voltage = settings.voltage_input
            self._inputs = NiInputs(self._device, [settings.current_input, *([voltage] if voltage else [])])

    def arm(self) -> None:
        """0 V, a trip cleared, the watchdog started and read back."""
        self.has_lease = False
        if self._watchdog is not None:
            self._watchdog.start()
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        self.has_lease = self._watchdog is not None
        self.tripped = ""

    def measure(self) -> Electrical:
        """Current and voltage across the wire now. It feeds the watchdog."""
        self._notice_trip()
        current_A, *voltage_V = self._inputs.values()
        return Electrical(current_A, voltage_V[0] if voltage_V else NAN)

    def off(self) -> str:
        """0 V, confirmed by the measured current. Never raises; returns "", or a sentence."""
        try:
            self._write(0.0)
            current_A = NAN
            for _ in range(OFF_READINGS):
                current_A = self._inputs.values()[0]
                if abs(current_A) <= self._off_A:
                    return ""
                time.sleep(OFF_WAIT_S)
            problem = f"is set to 0 V, but {current_A:.4g} A are measured"
        except SmarigError:
            problem = "did not confirm 0 V"
        text = f"{self._settings.channel} of {self._device} {problem}."
        if self.has_lease:
            return f"{text} Its watchdog sets it to 0 V within {self._lease_s:g} s. Check that the current stops."
        return f"{text} It has no lease: switch the amplifier off by hand now."

    def close(self) -> None:
        """Give output and inputs back; the output keeps its voltage."""
        self._closed = True
        close_task(self._task)
        self._inputs.close()
        if self._watchdog is not None:
            self._watchdog.close()

    def _drive(self, output_V: float) -> None:
        """Set the output; after a trip, nothing."""
        if not math.isfinite(output_V):
            raise UsageError(f"An output of {output_V:g} V cannot be driven.")
        if not self.tripped:
            self._notice_trip()
        if not self.tripped:
            self._write(output_V)

    def _write(self, output_V: float) -> None:
        if self._closed:
            raise Silent(f"{self._device} is not open. {Silent.remedy}")
        with ni_errors(self._device):
            self._task.write(output_V, auto_start=True)

    def _notice_trip(self) -> None:
        if self._watchdog is None or self.tripped:
            return
        if self._watchdog.expired():
            self.tripped = (
                f"The watchdog of {self._device} switched {self._settings.channel} off after {self._lease_s:g} s "
                "without the host. Check whether the host was too slow, and the cable."
            )
        else:
            self._watchdog.feed()


class NiCurrent(NiOutput):
    """Output → external current amplifier: i = amperes_per_volt · V."""

    def set_current(self, current_A: float) -> None:
        """Drive a current. Raises LinkFault if the device does not take it, UsageError for NaN."""
        self._drive(current_A / self._settings.scale)


class NiVoltage(NiOutput):
    """Output → external voltage stage: V_wire = volts_per_volt · V."""

    def set_voltage(self, voltage_V: float) -> None:
        """Apply a voltage. Raises LinkFault if the device does not take it, UsageError for NaN."""
        self._drive(voltage_V / self._settings.scale)
