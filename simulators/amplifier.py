"""The current amplifier as a state machine. Inputs are ticks and exchanges, outputs are current and
registers."""

from simulators.layout import BAD_VALUE, NOT_NOW
from simulators.protection import NO_TEMPERATURE, Protection, lease_ticks
from simulators.register_device import RegisterDevice
from smarig.device import Refusal, crc16, load_register_map, to_words

RING_SAMPLES = 256
BOARD_MAX_uA = 2_000_000  # of the simulated board, as the firmware is built
SATURATED, STOP = 1, 2  # bits of a tick's ``hardware``

_MAP = load_register_map("amplifier")
_STATE = {name: int(number) for number, name in _MAP["state"].values.items()}
_ORDER = {int(number): name for number, name in _MAP["order"].values.items()}
_FAULT = {fault.name: code for code, fault in _MAP.faults.items()}
_MARK = {name: 1 << int(bit) for bit, name in _MAP["ring"].field[-1].flags.items()}
_MAY_FOLLOW = {"arm": ("off",), "rearm": ("off", "tripped")}  # orders that are allowed in some states only


class Amplifier(RegisterDevice):
    """An amplifier that is off at boot, drives only while armed, and stays tripped until it is re-armed."""

    def __init__(self, boot_count: int = 1) -> None:
        super().__init__("amplifier", boot_count, RING_SAMPLES)

    def boot(self, boot_count: int) -> None:
        """Boot: off, output 0, safe settings."""
        super().boot(boot_count)
        self.state, self.trip = "off", ""
        self.output_uA = 0
        self._orders = 0  # executed since boot
        self._silent_ticks = 0
        self._protection = Protection()

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """Process the readings of a period in which the output flowed."""
        driven_uA = self.output_uA  # during this tick, also if it ends with a trip
        self._protection.add_heat(self.stored, current_uA)
        self._protection.saw(self.stored, temperature)
        self._silent_ticks += 1
        if self.state == "armed":
            stop = bool(hardware & STOP)
            measured = (self.output_uA, current_uA, voltage_uV, stop, self._silent_ticks)
            cause = self._protection.cause(self.stored, *measured)
            if cause:
                self._trip(cause)
        marks = _MARK["saturated"] if hardware & SATURATED else 0
        marks |= _MARK["tripped"] if self.state == "tripped" else 0
        measured_words = [
            word for value in (current_uA, voltage_uV, driven_uA) for word in to_words(value, 2)
        ]
        self.ring.put([*measured_words, temperature & 0xFFFF, marks])

    @property
    def arm_nonce(self) -> int:
        """What the next arm or rearm must carry: another number after every order and boot."""
        return (self.boot_count & 0xFFFF) << 16 | self._orders & 0xFFFF

    def status(self) -> dict[str, int]:
        """State, trip, output, lease, heat, settings and the nonce."""
        left = lease_ticks(self.stored) - self._silent_ticks if self.state == "armed" else 0
        return {
            "state": _STATE[self.state],
            "trip": _FAULT[self.trip] if self.trip else 0,
            "output": self.output_uA,
            "lease_left": left * self.stored["period"],
            "heat": self._protection.heat,
            "settings_crc": self._settings_crc(),
            "arm_nonce": self.arm_nonce,
            "board_max": BOARD_MAX_uA,
        }

    def _settings_crc(self) -> int:
        words = self.map.encode("settings", {name: self.stored[name] for name in self.map.names["settings"]})
        if self.stored["wire_temperature_max"] == NO_TEMPERATURE:  # as hosts of the first version compute it
            words = words[: self.map.size("settings", self.map.first_version)]
        return crc16(b"".join(word.to_bytes(2, "big") for word in words))

    def refuses_command(self, values: dict[str, int]) -> Refusal | None:
        """Refuse an order that is not allowed in this state, and a current that must not flow."""
        order, current_uA = _ORDER[values.get("order", 0)], values.get("current", 0)
        follows = self.state in _MAY_FOLLOW.get(order, (self.state,))
        drives = self.state == "armed" or order in _MAY_FOLLOW
        if not follows or (current_uA and not drives):
            return Refusal(NOT_NOW)
        if order in _MAY_FOLLOW and values.get("nonce") != self.arm_nonce:
            return Refusal(NOT_NOW)
        within = self.stored["current_min"] <= current_uA <= self.stored["current_max"]
        return None if within else Refusal(BAD_VALUE)

    def refuses_settings(self, values: dict[str, int]) -> Refusal | None:
        """Refuse settings while current may flow, beyond the board, or with ticks that are too long for the lease."""
        if self.state == "armed":
            return Refusal(NOT_NOW)
        s = {**self.stored, **values}
        within_board = s["current_max"] <= BOARD_MAX_uA and s["current_min"] >= -BOARD_MAX_uA
        return None if within_board and 2 * s["period"] <= s["lease"] else Refusal(BAD_VALUE)

    def carry_out(self, values: dict[str, int]) -> None:
        """Restart the lease, carry out the order, then set the current."""
        self._silent_ticks = 0
        order = _ORDER[values.get("order", 0)]
        if order == "off":
            self._switch_off("off")
        elif order in _MAY_FOLLOW:
            self._switch_off("armed")
        if self.state != "armed" or "current" not in values:
            return
        step_uA = abs(values["current"] - self.output_uA)
        if step_uA > self.stored["slew_max"] * self.stored["period"]:  # mA/s · ms = µA
            self._trip("slew")
        else:
            self.output_uA = values["current"]

    def _switch_off(self, state: str) -> None:
        self._orders += 1
        self.state, self.trip, self.output_uA = state, "", 0
        self._protection.reset_counts()

    def _trip(self, cause: str) -> None:
        self.state, self.trip, self.output_uA = "tripped", cause, 0
