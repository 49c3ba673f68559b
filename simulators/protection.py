"""The checks of an amplifier in each tick: current, voltage, heat and lease, in whole numbers like the
firmware."""

from collections.abc import Mapping

IN_A_ROW = 3  # consecutive ticks before a contact fault trips
MIN_CURRENT_uA = 50_000  # below it, resistance is not evaluated
MAX_HEAT = 2**32 - 1
NO_TEMPERATURE = -(2**15)  # no reading, or no limit


class Protection:
    """Heat and counts of suspicious ticks. ``cause`` names the first fault of a tick, or none."""

    def __init__(self) -> None:
        self.heat = 0
        self._too_hot = False
        self._thermometer = False  # whether it has read since boot
        self._ticks_in_a_row = {"open": 0, "short": 0, "resistance": 0}

    def add_heat(self, s: Mapping[str, int], current_uA: int) -> None:
        """Add one tick to the i²t integral, whether armed or not."""
        period_ms, settle_ms = s["period"], s["heat_settle"]
        lost = self.heat if period_ms > settle_ms else self.heat * period_ms // settle_ms
        current_mA = abs(current_uA) // 1000
        self.heat = min(self.heat - lost + current_mA * current_mA * period_ms // 1000, MAX_HEAT)

    def saw(self, s: Mapping[str, int], temperature: int) -> None:
        """Compare a tick's wire temperature, in 0.01 °C, with its limit; one that is not read any more is too hot."""
        self._thermometer |= temperature != NO_TEMPERATURE
        limit = s["wire_temperature_max"]
        hot = self._thermometer if temperature == NO_TEMPERATURE else temperature > limit
        self._too_hot = limit != NO_TEMPERATURE and hot

    def reset_counts(self) -> None:
        """Reset the counts: the consecutive ticks must lie within one armed state."""
        self._ticks_in_a_row = dict.fromkeys(self._ticks_in_a_row, 0)

    def cause(
        self, s: Mapping[str, int], output_uA: int, current_uA: int, voltage_uV: int, stop: bool, silent: int
    ) -> str:
        """The first cause of a tick while armed, "" for none. ``silent``: ticks since the last message."""
        self._count_rows(s, output_uA, abs(current_uA), abs(voltage_uV))
        if stop:
            return "stop"
        beyond = max(s["current_max"], -s["current_min"]) // 20
        if not s["current_min"] - beyond <= current_uA <= s["current_max"] + beyond:
            return "over_current"
        in_a_row = next((name for name, ticks in self._ticks_in_a_row.items() if ticks >= IN_A_ROW), "")
        if in_a_row:
            return in_a_row
        if self._too_hot:
            return "wire_temperature"
        if self.heat > s["heat_max"]:
            return "heat"
        return "lease" if silent > lease_ticks(s) else ""

    def _count_rows(self, s: Mapping[str, int], output_uA: int, current_uA: int, voltage_uV: int) -> None:
        enough = current_uA >= MIN_CURRENT_uA
        suspicious = {
            "open": abs(output_uA) >= MIN_CURRENT_uA and 2 * current_uA < abs(output_uA),
            "short": enough and 1000 * voltage_uV < s["resistance_min"] * current_uA,
            "resistance": enough and 1000 * voltage_uV > s["resistance_max"] * current_uA,
        }
        self._ticks_in_a_row = {
            name: self._ticks_in_a_row[name] + 1 if now else 0 for name, now in suspicious.items()
        }


def lease_ticks(s: Mapping[str, int]) -> int:
    """The lease in ticks: rounded to nearest, halves up, at least one."""
    return max((2 * s["lease"] + s["period"]) // (2 * s["period"]), 1)
