"""A laboratory supply on a TCP port: the dialect of its make, its voltage limit, and a watchdog where it has one."""

import threading
import time
from collections.abc import Callable

from simulators.supply_dialects import DIALECTS, Commands
from simulators.text_server import TextServer
from smarig.core import UsageError, suggestion

OHM = 5.0  # of the resistor at its terminals, unless a wire is wired to it
WATCHDOG_s = 0.002  # between two looks at the watchdog
ON_OR_OFF = ("rigol_dp800", "tdk_lambda_z")  # these answer in words
DISABLED = 2048  # bit of the watchdog in the questionable status
QUERIES = ("setting", "is_on", "current", "voltage", "both", "watched", "delay_of", "status")


class SimulatedSupply(TextServer):
    """``speed``: its seconds per second. ``drive`` is told the current, ``ohm`` tells the load's resistance.
    ``commands``: in place of those of the make.

    Commands that the make does not know are kept in ``unknown``.
    """

    def __init__(
        self,
        make: str,
        speed: float = 1.0,
        drive: Callable[[float], None] = lambda _: None,
        ohm: Callable[[], float] = lambda: OHM,
        commands: Commands | None = None,
    ) -> None:
        if commands is None and make not in DIALECTS:
            raise UsageError(f"No make '{make}' of simulated supplies{suggestion(make, list(DIALECTS))}.")
        self.identity, self._dialect = commands or DIALECTS[make]
        self._flags = ("ON", "OFF") if make in ON_OR_OFF else ("1", "0")
        self.speed, self._drive, self._ohm = speed, drive, ohm
        self.level_A, self.limit_V = 0.0, 0.0
        self.output, self.protected = False, 0
        self.delay_s: float = 60
        self.watching, self.fed_s = False, time.monotonic()
        self.off_after_s: float | None = None  # of its own seconds without a command, when the watchdog acted
        self.unknown: list[str] = []
        self._lock = threading.Lock()
        super().__init__()
        threading.Thread(target=self._watch, daemon=True).start()

    @property
    def flows_A(self) -> float:
        """The current in the load: that which is set, or what the voltage limit allows."""
        if not self.output or self.protected:
            return 0.0
        largest_A = self.limit_V / self._ohm()
        return max(-largest_A, min(self.level_A, largest_A))

    def answer(self, line: str) -> str | None:
        """Every line restarts the watchdog."""
        with self._lock:
            self.fed_s = time.monotonic()
            found = self._answer(line)
            self._drive(self.flows_A)
        return found

    def _answer(self, line: str) -> str | None:
        if line.upper() == "*IDN?":
            return self.identity
        for pattern, action in self._dialect:
            if match := pattern.match(line):
                return self._reply(action) if action in QUERIES else self._ordered(action, *match.groups())
        self.unknown.append(line)
        return None

    def _reply(self, action: str) -> str:
        flows_A = self.flows_A
        volts = self._ohm() * flows_A
        return {
            "setting": f"{self.level_A:.6f}",
            "is_on": self._flags[not self.output],
            "current": f"{flows_A:.6E}",
            "voltage": f"{volts:.6E}",
            "both": f"{volts:.6E},{flows_A:.6E}",
            "watched": str(int(self.watching)),
            "delay_of": str(self.delay_s),
            "status": str(self.protected),
        }[action]

    def _ordered(self, action: str, value: str = "0") -> None:
        if action == "set_current":
            self.level_A = float(value)
        elif action == "limit":
            self.limit_V = float(value)
        elif action in ("on", "off"):
            self.output = action == "on"
        elif action == "delay":
            self.delay_s = int(value)
        elif action == "watch":
            self.watching = True
        elif action == "clear":
            self.protected = 0

    def _watch(self) -> None:
        while not self.over.wait(WATCHDOG_s):
            with self._lock:
                silent_s = (time.monotonic() - self.fed_s) * self.speed
                acts = self.watching and self.output and not self.protected
                if acts and silent_s > self.delay_s:
                    self.protected = DISABLED  # latched; the programmed state stays
                    self.off_after_s = silent_s
                    self._drive(0.0)
