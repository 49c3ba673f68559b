"""A current source and a position sensor in one box that speaks text over TCP: that of ``smarig new driver``."""

import re
from collections.abc import Callable

from simulators.supply import SimulatedSupply
from simulators.supply_dialects import BOX, NUMBER

_WATCHDOG = re.compile(f"syst:wdog {NUMBER}$", re.IGNORECASE)


class SimulatedBox(SimulatedSupply):
    """A supply with a watchdog of any length, and with a sensor. ``position``: what it measures, in mm or deg."""

    def __init__(
        self,
        speed: float,
        drive: Callable[[float], None],
        ohm: Callable[[], float],
        position: Callable[[], float],
    ) -> None:
        self._position = position
        super().__init__("", speed, drive, ohm, BOX)

    @property
    def url(self) -> str:
        """Its address."""
        return f"tcp://127.0.0.1:{self.port}"

    def _answer(self, line: str) -> str | None:
        match line.upper():
            case "MEAS:POS?":
                return f"{self._position():.6f}"
            case "SYST:WDOG?":
                return f"{self.delay_s * self.watching:g}"
            case "OUTP?":
                return str(int(self.output and not self.protected))
        if watchdog := _WATCHDOG.match(line):
            self.delay_s, self.watching = float(watchdog[1]), float(watchdog[1]) > 0
            return None
        return super()._answer(line)
