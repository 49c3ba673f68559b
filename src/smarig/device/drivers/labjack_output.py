"""A DAC of a LabJack that commands a current amplifier, or a voltage stage; analogue inputs measure both quantities."""

import math

from pydantic import Field

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError, SmarigError, UsageError
from smarig.device.drivers import _labjack_registers as reg
from smarig.device.drivers._analogue_stage import StageSettings
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._labjack import AnalogueChannel, LabJack
from smarig.device.drivers._labjack_watchdog import arm_watchdog, whole_seconds
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.roles.polled import Electrical

TOLERANCE_V = 0.012  # two steps of the T4's DAC of 10 bits, and what is left at 0 V


class LabJackOutputSettings(StageSettings):
    """[links.amplifier.settings] of labjack_output. Either ``amperes_per_volt`` or ``volts_per_volt``."""

    dac: int = Field(ge=0, le=1)  # output: 0 for DAC0
    current_input: AnalogueChannel  # measures the current, in A: shunt or monitor output
    voltage_input: AnalogueChannel | None = None  # measures the voltage across the wire, in V
    watchdog: bool = True  # whether the box sets the DAC to 0 V when the host is silent


def labjack_output(where: LinkFile, rig: RigFile) -> "LabJackOutput":
    """The DAC of a rig file, at 0 V: a current output, or a voltage output if its stage is one."""
    settings = settings_of(where, LabJackOutputSettings)
    if rig.limits.current_min_A < 0:
        raise ConfigError(
            f"Rig '{rig.name}' has current_min_A = {rig.limits.current_min_A:g} A. The DAC of a LabJack gives current "
            "of one sign only."
        )
    timeout_s = whole_seconds(rig.lease_s) if settings.watchdog else None
    kind = LabJackCurrent if settings.drives_current else LabJackVoltage
    return kind(where, settings, timeout_s, settings.largest_V_of(rig))


class LabJackOutput:
    """What both kinds share. Opening sets the DAC to 0 V. It reads the DAC back before every write and measurement."""

    def __init__(
        self, where: LinkFile, settings: LabJackOutputSettings, timeout_s: int | None, largest_V: float
    ) -> None:
        self._box = LabJack(where)
        self._settings, self._timeout_s = settings, timeout_s
        self._dac = reg.DAC + 2 * settings.dac
        self._set_V = 0.0
        self.tripped, self.has_lease = "", False
        with self._box.let_go_on_failure():
            self._box.write_number(self._dac, 0.0)  # first: a killed host may have left it on
            full_scale_V = reg.DAC_FULL_SCALE_V[self._box.product]
            if largest_V > full_scale_V:
                raise ConfigError(
                    f"The largest output of the rig needs {largest_V:.3g} V at DAC{settings.dac}, which gives at most "
                    f"{full_scale_V:g} V. Lower limits.current_max_A, or change the scale of the amplifier."
                )
            self._box.configure(self._inputs)

    @property
    def identity(self) -> str:
        """The box and its output."""
        return f"{self._box.identity}, DAC{self._settings.dac}"

    def arm(self) -> None:
        """0 V, a trip cleared, the watchdog armed and read back."""
        self.has_lease = False
        shutdown_unconfirmed = self.off()
        if shutdown_unconfirmed:
            raise Silent(shutdown_unconfirmed)
        if self._timeout_s is not None:
            arm_watchdog(self._box, self._settings.dac, self._timeout_s)
            self.has_lease = True
        self.tripped = ""

    def measure(self) -> Electrical:
        """Current and voltage across the wire now."""
        self._notice_trip()
        current_A, *voltage_V = self._box.values(*self._inputs)
        return Electrical(current_A, voltage_V[0] if voltage_V else NAN)

    def off(self) -> str:
        """0 V, read back. Never raises; returns "", or a sentence if the box did not confirm."""
        self._set_V = 0.0
        try:
            self._box.write_number(self._dac, 0.0)
            if abs(self._box.number(self._dac)) <= TOLERANCE_V:
                return ""
            problem = "is not at 0 V"
        except SmarigError:
            problem = "did not confirm 0 V"
        text = f"DAC{self._settings.dac} of the LabJack at {self._box.where} {problem}."
        if self.has_lease:
            return f"{text} Its watchdog sets it to 0 V within {self._timeout_s} s of silence on all its connections."
        return f"{text} It has no lease: switch the amplifier off by hand now."

    def close(self) -> None:
        """Leave the connection; the watchdog stays armed."""
        self._box.close()

    @property
    def _inputs(self) -> tuple[AnalogueChannel, ...]:
        voltage = self._settings.voltage_input
        return (self._settings.current_input, *((voltage,) if voltage else ()))

    def _drive(self, dac_V: float) -> None:
        """Set the DAC and read it back. After a trip, nothing."""
        if not math.isfinite(dac_V):
            raise UsageError(f"An output of {dac_V:g} V cannot be driven.")
        if not self.tripped:
            self._notice_trip()
        if self.tripped:
            return
        self._box.write_number(self._dac, dac_V)
        self._set_V = dac_V
        found_V = self._box.number(self._dac)
        if not abs(found_V - dac_V) <= TOLERANCE_V:
            self.off()
            raise Garbled(
                f"DAC{self._settings.dac} of the LabJack at {self._box.where} is at {found_V:.4g} V instead of "
                f"{dac_V:.4g} V. {Garbled.remedy}"
            )

    def _notice_trip(self) -> None:
        """A DAC that is not where it was set: the watchdog, a restart of the box, or another program."""
        found_V = self._box.number(self._dac)
        if abs(found_V - self._set_V) <= TOLERANCE_V:
            return
        name, set_V = f"DAC{self._settings.dac} of the LabJack at {self._box.where}", self._set_V
        self.off()
        if abs(found_V) <= TOLERANCE_V:
            after = f" after {self._timeout_s} s without requests" if self.has_lease else ""
            self.tripped = (
                f"{name} went from {set_V:.4g} V to 0 V by itself: its watchdog switched it off{after}, or the box "
                "restarted. Check whether the host was too slow, the cable and the power of the box."
            )
        else:
            self.tripped = (
                f"{name} is at {found_V:.4g} V instead of {set_V:.4g} V. Another program may use the box."
            )


class LabJackCurrent(LabJackOutput):
    """DAC → external current amplifier: i = amperes_per_volt · V_DAC."""

    def set_current(self, current_A: float) -> None:
        """Drive a current. Raises LinkFault if the DAC does not take it, UsageError for NaN."""
        self._drive(current_A / self._settings.scale)


class LabJackVoltage(LabJackOutput):
    """DAC → external voltage stage: V = volts_per_volt · V_DAC."""

    def set_voltage(self, voltage_V: float) -> None:
        """Apply a voltage. Raises LinkFault if the DAC does not take it, UsageError for NaN."""
        self._drive(voltage_V / self._settings.scale)
