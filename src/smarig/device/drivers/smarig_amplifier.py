"""The current amplifier of firmware_protocol/amplifier.toml, which has its own lease, limits and trips.

Every reply says what the amplifier drives, in which state, with which settings. Each is compared with what was ordered:
after a difference the amplifier is switched off and counts as tripped.
"""

import math
from collections.abc import Mapping

from smarig.config import LinkFile, RigFile
from smarig.core import ConfigError, Quality, SmarigError
from smarig.device.drivers._conversation import Status
from smarig.device.drivers._line_device import LineDevice
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.link_faults import Rebooted, Refused
from smarig.device.encoding.register import load_register_map
from smarig.device.links.link import Link, let_go_on_failure
from smarig.device.links.opening import opened
from smarig.device.roles.ticked import CurrentReading

TRIES_OFF = 3


def smarig_amplifier(where: LinkFile, rig: RigFile) -> "SmarigAmplifier":
    """The amplifier of a rig file, after its handshake: off, with its settings written."""
    with let_go_on_failure(opened(where, load_register_map("amplifier").device.default_address)) as link:
        return SmarigAmplifier(link, _settings(rig))


def _settings(rig: RigFile) -> dict[str, float]:
    """Values of the settings block, in units."""
    p = rig.protection
    if p is None:
        raise ConfigError(f"Rig '{rig.name}' has no table [protection]. Its amplifier requires it.")
    return {
        "period": rig.period_s,
        "lease": rig.lease_s,
        "current_min": rig.limits.current_min_A,
        "current_max": rig.limits.current_max_A,
        "slew_max": p.slew_max_A_per_s,
        "resistance_min": p.resistance_min_ohm,
        "resistance_max": p.resistance_max_ohm,
        "heat_max": p.heat_max_A2s,
        "heat_settle": p.heat_settle_s,
    }


class SmarigAmplifier(LineDevice):
    """Off until a current is set. ``settings``: values in units by register of the settings block."""

    def __init__(self, link: Link, settings: dict[str, float]) -> None:
        super().__init__(link, "amplifier")
        self._settings = {name: self.map[name].value.encode(value) for name, value in settings.items()}
        self._orders = {name: int(code) for code, name in self.map["order"].values.items()}
        self._states = {name: int(code) for code, name in self.map["state"].values.items()}
        self._current = self.map["current"].value
        self._fields = self.map.fields("current", "voltage", "output", "temperature", "marks")
        self._marks = {name: 1 << int(bit) for bit, name in self._fields[-1].flags.items()}
        self._limit = self.map["wire_temperature_max"].value
        self._thermometer = False  # whether it has measured the wire temperature
        self._limited = False  # whether it trips beyond a wire temperature
        self._raw, self._armed, self._nonce = 0, False, 0
        self._contradiction = ""  # how a reply contradicted the order
        self.tripped = ""
        self.has_lease = True
        self.arm()

    def arm(self) -> None:
        """Check the device, switch off, clear a trip and write the settings."""
        now = self.talk.handshake()
        self._check_board(now["board_max"])
        self._raw, self._armed, self._contradiction = 0, False, ""
        status = self.talk.command({"order": self._orders["off"], "ring_next": now["tick"]}, 1)
        self._look(status)
        for record in status.records:
            self._reading(0, record, Quality.GOOD)
        self._write_settings(self.map["wire_temperature_max"].safe or 0)

    @property
    def holds_wire_limit(self) -> bool:
        """Whether it has a thermometer on the wire, and a register for the limit of its temperature."""
        return self._thermometer and self.talk.version >= self.map["wire_temperature_max"].since

    @property
    def lacks_wire_limit(self) -> bool:
        """Whether current may flow without the limit that it could hold: its thermometer first read after arming."""
        return self._armed and not self.tripped and not self._limited and self.holds_wire_limit

    def limit_wire_temperature(self, largest_degC: float) -> None:
        """Let it trip beyond this measured wire temperature, until it is armed again; nothing if current may flow.

        Raises ConfigError for a temperature that its thermometer cannot tell.
        """
        if self._armed or self.tripped or not self.holds_wire_limit:
            return
        low, high = (raw / self._limit.per_unit for raw in self._limit.span)
        if not low < largest_degC <= high:
            raise ConfigError(
                f"The {self.talk.name} can limit the wire temperature to at most {high:g} °C, not to "
                f"{largest_degC:.2f} °C. Lower limits.temperature_max_K."
            )
        self._write_settings(self._limit.encode(largest_degC))

    def _write_settings(self, wire_temperature_max: int) -> None:
        """Write the settings with this limit, as far as the device has them, and keep the check word they must have."""
        values = self._settings | {"wire_temperature_max": wire_temperature_max}
        self.talk.settings(values)
        self._limited = wire_temperature_max != self._limit.none
        version = self.map.device.version if self._limited else self.map.first_version
        words = self.map.encode("settings", values)[: self.map.size("settings", version)]
        self._settings_crc = crc16(b"".join(word.to_bytes(2, "big") for word in words))

    def _check_board(self, most: int) -> None:
        """Raise ConfigError if the rig file asks for more current than the board is built for."""
        largest = max(self._settings["current_max"], -self._settings["current_min"])
        if largest > most:
            raise ConfigError(
                f"The {self.talk.name} is built for at most {self._current.decode(most):g} A; the rig file allows "
                f"{self._current.decode(largest):g} A. Lower limits.current_max_A and current_min_A."
            )

    def set(self, current_A: float) -> int:
        """Apply the current from the next tick on; nothing after a trip, whose cause is in ``tripped``."""
        if self.tripped:
            return self.tick()
        raw = self._current.encode(current_A)
        if not self._armed:  # at zero current: an arm frame that arrives late heats nothing
            self._ordered({"order": self._orders["arm"], "nonce": self._nonce, "current": 0}, armed=True)
            if self.tripped:  # pyrefly: ignore [redundant-condition]
                return self.tick()
        status = self._ordered({"current": raw}, armed=True)
        self._raw = 0 if self.tripped else raw  # pyrefly: ignore [redundant-condition]
        return status.values["tick"]

    def since(self, tick: int, at_most: int) -> list[CurrentReading]:
        """Readings from a tick on. The exchange renews the lease."""
        status = self._ordered({"current": self._raw, "ring_next": tick}, at_most, armed=self._armed)
        first = self.talk.first_tick(status, tick)
        mark = Quality.RETRIED if status.retried else Quality.GOOD
        mark |= Quality.SUSPECT if self._contradiction else Quality.GOOD
        return [self._reading(first + k, record, mark) for k, record in enumerate(status.records)]

    def measured_A(self) -> float:
        """The current of the last tick; NaN if its record is not there."""
        readings = self.since(self.tick(), 1)
        return readings[-1].current_A if readings else math.nan

    def _reading(self, tick: int, record: tuple[int, ...], mark: Quality) -> CurrentReading:
        current, voltage, output, temperature, marks = (f.decode(raw) for f, raw in zip(self._fields, record))
        self._thermometer |= not math.isnan(temperature)
        quality = int(mark)
        quality |= Quality.SATURATED if int(marks) & self._marks["saturated"] else 0
        quality |= Quality.TRIPPED if int(marks) & self._marks["tripped"] else 0
        return CurrentReading(tick, current, voltage, temperature, Quality(quality), output)

    def tick(self) -> int:
        """The last tick of the device."""
        return self._ordered({"current": self._raw}, armed=self._armed).values["tick"]

    def _ordered(self, values: Mapping[str, int], records: int = 0, *, armed: bool) -> Status:
        """Send a command and compare the reply with it. ``armed``: whether the amplifier must be armed afterwards."""
        status = self._command_or_trip_status(values, records)
        self._look(status)
        if not self.tripped:
            self._contradict(self._difference(status, values["current"] if armed else 0, armed))
        return status

    def _command_or_trip_status(self, values: Mapping[str, int], records: int = 0) -> Status:
        """Send a command. If it is refused after a trip or by another state, return the status at zero current."""
        try:
            return self.talk.command(values, records)
        except Refused as refused:
            at_zero = {**values, "order": self._orders["none"], "current": 0, "nonce": 0}
            status = self.talk.command(at_zero, records)
            changed = self._armed and status.values["state"] != self._states["armed"]
            if not status.values["trip"] and not changed:
                raise refused
            return status

    def _look(self, status: Status) -> None:
        """Read from the status whether the amplifier is armed or has tripped. After a trip the command is 0."""
        self._armed = status.values["state"] == self._states["armed"]
        self._nonce = status.values["arm_nonce"]
        code = status.values["trip"]
        if code:
            fault = self.map.faults.get(code)
            what = f"{fault.name}. {fault.cause} {fault.remedy}" if fault else f"cause {code}."
            self._raw, self.tripped = 0, f"The {self.talk.name} has switched its output off: {what}"
        else:
            self.tripped = self._contradiction

    def _difference(self, status: Status, raw: int, armed: bool) -> str:
        """How the reply differs from what was ordered; "" if it does not."""
        drives, decoded = status.values["output"], self._current.decode
        if drives != raw:
            return f"it drives {decoded(drives):.6g} A, but {decoded(raw):.6g} A is ordered"
        if (status.values["state"] == self._states["armed"]) != armed:
            return f"it is {'not ' if armed else ''}armed, against its order"
        if status.values["settings_crc"] != self._settings_crc:
            return "its settings are not those that were written"
        return ""

    def _contradict(self, difference: str) -> None:
        """After a difference, switch the output off and keep the reason."""
        if not difference:
            return
        self._contradiction = self.tripped = (
            f"The {self.talk.name} contradicts its order: {difference}. Another program may use it, or its line "
            "changes words."
        )
        self._raw = 0
        self.off()  # if the line fails, the lease does it

    def off(self) -> str:
        """Set the output to zero and disarm. Returns "" after confirmation, else a sentence that names the lease."""
        self._raw = 0
        try:
            for _ in range(TRIES_OFF):
                status = self.talk.command({"order": self._orders["off"]})
                self._look(status)
                if not self._armed and not status.values["output"]:
                    return ""
            problem = "reports that it still drives the wire"
        except Rebooted:  # off since it started
            return ""
        except SmarigError:
            problem = "did not confirm that it switched off"
        lease_s = self.map["lease"].value.decode(self._settings["lease"])
        return (
            f"The {self.talk.name} {problem}. Without further commands its lease switches it off within "
            f"{lease_s:g} s."
        )

    def close(self) -> None:
        """Close the line."""
        self.talk.link.close()
