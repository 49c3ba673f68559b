"""The current amplifier as a state machine. Inputs are ticks and exchanges, outputs are current and
registers."""

from simulators.layout import BAD_VALUE, NOT_NOW
from simulators.protection import Protection, lease_ticks
from simulators.register_device import RegisterDevice
from smarig.device import Refusal, load_register_map, to_words

RING_SAMPLES = 256
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
        self._silent_ticks = 0
        self._protection = Protection()

    def tick(self, current_uA: int, voltage_uV: int, temperature: int, hardware: int) -> None:
        """Process the readings of a period in which the output flowed."""
        self._protection.add_heat(self.stored, current_uA)
        self._silent_ticks += 1
        if self.state == "armed":
            stop = bool(hardware & STOP)
            measured = (self.output_uA, current_uA, voltage_uV, stop, self._silent_ticks)
            cause = self._protection.cause(self.stored, *measured)
            if cause:
                self._trip(cause)
        marks = _MARK["saturated"] if hardware & SATURATED else 0
        marks |= _MARK["tripped"] if self.state == "tripped" else 0
        self.ring.put([*to_words(current_uA, 2), *to_words(voltage_uV, 2), temperature & 0xFFFF, marks])

    def status(self) -> dict[str, int]:
        """State, trip, output, lease and heat."""
        left = lease_ticks(self.stored) - self._silent_ticks if self.state == "armed" else 0
        return {
            "state": _STATE[self.state],
            "trip": _FAULT[self.trip] if self.trip else 0,
            "output": self.output_uA,
            "lease_left": left * self.stored["period"],
            "heat": self._protection.heat,
        }

    def refuses_command(self, values: dict[str, int]) -> Refusal | None:
        """Refuse an order that is not allowed in this state, and a current that must not flow."""
        order, current_uA = _ORDER[values.get("order", 0)], values.get("current", 0)
        follows = self.state in _MAY_FOLLOW.get(order, (self.state,))
        drives = self.state == "armed" or order in _MAY_FOLLOW
        if not follows or (current_uA and not drives):
            return Refusal(NOT_NOW)
        within = self.stored["current_min"] <= current_uA <= self.stored["current_max"]
        return None if within else Refusal(BAD_VALUE)

    def refuses_settings(self) -> Refusal | None:
        """Refuse settings while current may flow."""
        return Refusal(NOT_NOW) if self.state == "armed" else None

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
        self.state, self.trip, self.output_uA = state, "", 0
        self._protection.reset_counts()

    def _trip(self, cause: str) -> None:
        self.state, self.trip, self.output_uA = "tripped", cause, 0
