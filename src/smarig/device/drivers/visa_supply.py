"""A laboratory supply or source meter in constant-current mode, by VISA: the commands of its make are in makes.toml.

It has a lease only if the make has a watchdog that turns the output off without communication, and if its state and
time were read back. Without one the current stays on when the host fails, and the rig takes lower limits.
"""

from contextlib import nullcontext, suppress

from pydantic import Field

from smarig.config import LinkFile, RigFile
from smarig.core import ConfigError, TomlTable
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._makes import Make, filled, make_of, may_be_supply
from smarig.device.encoding.link_faults import Garbled, Silent, WrongDevice
from smarig.device.links.query import LARGEST
from smarig.device.links.visa_line import Backend, VisaLine
from smarig.device.polled.from_functions import FunctionOutput
from smarig.plant import Actuator, largest_voltage_V


class VisaSupplySettings(TomlTable):
    """[links.amplifier.settings] of visa_supply."""

    channel: int = Field(default=1, ge=1, le=99)  # output of a supply with several
    make: str = ""  # in place of the one that *IDN? tells
    makes: str = ""  # file with makes of your own
    backend: Backend = ""


def visa_supply(where: LinkFile, rig: RigFile) -> FunctionOutput:
    """The supply at a VISA address: off, identified, with its voltage limited."""
    settings = settings_of(where, VisaSupplySettings)
    line = VisaLine.of(where, settings.backend)
    try:
        if not may_be_supply(identity := line.identify(), settings.makes):
            raise WrongDevice(
                f"The device at {where.url} answers '{identity}', not an SCPI identity: it is no supply, or the urls "
                "of two links are exchanged."
            )
        name, make = make_of(identity, settings.make, settings.makes)
        if rig.limits.current_min_A < 0 and not make.bipolar:
            raise ConfigError(
                f"Rig '{rig.name}' has current_min_A = {rig.limits.current_min_A:g} A. A supply of make {name} gives "
                "current of one sign only."
            )
        return _output(_SupplyCommands(line, make, settings.channel, rig))
    except BaseException:
        line.close()
        raise


def _output(supply: "_SupplyCommands") -> FunctionOutput:
    """The supply as a role."""
    return FunctionOutput(
        identity=supply.line.identity,
        set_current_A=supply.set_current,
        setting_A=supply.setting_A,
        current_A=lambda: supply.measured()[1],
        voltage_V=lambda: supply.last_V,
        switch_on=lambda: supply.send(supply.make.output.on),
        switch_off=lambda: supply.send(supply.make.output.off, at_once=True),
        is_on=supply.is_on,
        prepare=supply.prepare,
        arm_watchdog=supply.arm_watchdog if supply.make.watchdog else None,
        lease_s=supply.rig.lease_s,
        close_all=supply.line.close,
        line=supply.line,
    )


class _SupplyCommands:
    """The commands of a make, filled in for one output."""

    def __init__(self, line: VisaLine, make: Make, channel: int, rig: RigFile) -> None:
        self.line, self.make, self._channel, self.rig = line, make, channel, rig
        self.last_V = 0.0
        if make.watchdog is not None and (rig.lease_s < 1 or rig.lease_s != round(rig.lease_s)):
            raise ConfigError(
                f"lease_s = {rig.lease_s:g}: the watchdog of this supply counts whole seconds. Give 1, 2, …"
            )

    def send(self, command: str, value: float = 0.0, *, at_once: bool = False) -> None:
        """A command with its values; ``at_once`` for one that takes the current away."""
        self.line.write(self._filled(command, value), at_once=at_once)

    def prepare(self) -> None:
        """Function, protections and voltage limit, while the output is off."""
        for command in self.make.prepare:
            self.send(command)
        self.send(
            self.make.voltage.set, largest_voltage_V(self.rig.limits, Actuator.named(self.rig.actuator))
        )

    def set_current(self, current_A: float) -> None:
        """Set the current."""
        self.send(self.make.current.set, current_A, at_once=current_A == 0)

    def setting_A(self) -> float:
        """The set current, read back."""
        return self.line.number(self._filled(self.make.current.query), reads=True)

    def is_on(self) -> bool:
        """Whether the output is on, and no protection has disabled it."""
        on = self.line.switched_on(self._filled(self.make.output.query))
        protection = self.make.protection
        if not on or protection is None:
            return on
        code = round(self.line.number(self._filled(protection.query)))
        return not (code & protection.bits if protection.bits else code)

    def measured(self) -> tuple[float, float]:
        """(voltage, current), also of an output that says that it is off: its relay may stick. Zero if it does not
        measure then.
        """
        is_on = self.is_on()
        found = 0.0, 0.0
        if is_on or self.make.measure.while_off:
            with nullcontext() if is_on else suppress(Silent, Garbled):
                found = self._measured()
        if not is_on and abs(found[1]) >= LARGEST:  # 9.91E37: no reading
            found = 0.0, 0.0
        self.last_V = found[0]
        return found

    def _measured(self) -> tuple[float, float]:
        measure = self.make.measure
        if measure.both:
            voltage_V, current_A = self.line.numbers(self._filled(measure.both), reads=True)[:2]
            return voltage_V, current_A
        current_A = self.line.number(self._filled(measure.current), reads=True)
        return self.line.number(self._filled(measure.voltage), reads=True), current_A

    def arm_watchdog(self, lease_s: float) -> bool:
        """Arm it, and read state and time back."""
        watchdog = self.make.watchdog
        if watchdog is None:
            return False
        for command in watchdog.arm:
            self.line.write(filled(command, channel=self._channel, lease=round(lease_s)))
        armed = self.line.switched_on(self._filled(watchdog.query))
        return armed and self.line.number(self._filled(watchdog.time)) == round(lease_s)

    def _filled(self, command: str, value: float = 0.0) -> str:
        largest_A = max(self.rig.limits.current_max_A, -self.rig.limits.current_min_A)
        return filled(command, channel=self._channel, value=f"{value:.6g}", largest=f"{largest_A:.6g}")
