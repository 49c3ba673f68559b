"""Both devices as chips with a wire between them, and the rig file of their host."""

import threading
import time
from pathlib import Path

import numpy as np

from smarig.config import load_rig
from smarig.core.resources import shipped
from smarig.plant.actuator import Actuator
from smarig.rig.specimen import Specimen, TwinSettings

PERIOD_S = 0.1  # of the twin's wire
QUICKER = 5  # is the wire between chips
RIG = """
name = "mortal"
simulator = {{ start = false, speed = {speed} }}
base = "one_wire_twin"
kind = "bench"
wire = "{wire}"
actuator = "{actuator}"
period_s = {period}
lease_s = {lease}
links.amplifier = {{ driver = "smarig_amplifier", framing = "lines", url = "{amplifier}", timeout_s = {timeout} }}
links.encoder_daq = {{ driver = "smarig_encoder_daq", framing = "lines", url = "{daq}", timeout_s = {timeout} }}
limits.current_rate_A_per_s = {slew}
protection.slew_max_A_per_s = {slew}
protection.resistance_min_ohm = 1.0
protection.resistance_max_ohm = 20.0
protection.heat_max_A2s = 20.0
protection.heat_settle_s = 10.0
"""


class Chips:
    """Both devices' firmware under an emulator in real time: the twin's wire between them, five times as quick."""

    period_s = PERIOD_S / QUICKER
    speed = 1.0
    lease_s = 1.5  # a busy machine keeps a host from its devices for a while
    lease_ticks = 75

    def __init__(self, folder: Path, start, seed: int = 2, timeout_s: float | None = None) -> None:
        file = load_rig("one_wire_twin")
        self._specimen = Specimen(file, Actuator.named(file.actuator), TwinSettings(seed=seed))
        self._counts, self._ambient = 0, 2200
        self._one_at_a_time = threading.Lock()
        self.amplifier = start("amplifier_lines", self._amplified)
        self._daq = start("encoder_daq_lines", self._counted)
        where = {"amplifier": self.amplifier.path, "daq": self._daq.path}
        actuator = quick_actuator(folder, QUICKER)
        self.rig = write_rig(folder, where, 1.0, self.lease_s, self.period_s, actuator, timeout_s)

    def _amplified(self, driven_uA: int) -> str:
        with self._one_at_a_time:
            r = self._specimen.advance(driven_uA / 1e6)
            self._counts, self._ambient = r.counts, r.ambient
            return f"in {r.current} {r.voltage} {r.temperature} {int(r.saturated)}"

    def _counted(self, _: int) -> str:
        with self._one_at_a_time:
            return f"in {self._counts} {self._ambient} 0"

    @property
    def behind_ms(self) -> int:
        """Real time that the machine was too busy to give the chips."""
        return self.amplifier.behind_ms + self._daq.behind_ms

    def driven(self) -> np.ndarray:
        """The output in every tick so far."""
        return np.array(self.amplifier.driven_uA)

    def ticks(self, role: str) -> int:
        """The ticks of one of the chips so far."""
        return len((self.amplifier if role == "amplifier" else self._daq).driven_uA)

    def wait(self) -> None:
        """Long enough for a lease to end."""
        time.sleep(2.5 * self.lease_s)


def quick_actuator(folder: Path, quicker: float) -> str:
    """The one-wire actuator with less heat in its wire."""
    text = (shipped("configs") / "actuators/gorbet_one_wire.toml").read_text("utf-8")
    path = folder / "quick.toml"
    path.write_text(text.replace("value = 840.0", f"value = {840.0 / quicker}"), "utf-8")
    return str(path)


def write_rig(
    folder: Path,
    where: dict[str, str],
    speed: float,
    lease_s: float,
    period_s: float,
    actuator: str,
    timeout_s: float | None = None,
):
    """The rig file of a host."""
    path = folder / "rig.toml"
    numbers = {"speed": speed, "lease": lease_s, "period": period_s, "slew": 2.5 / period_s}
    # in lock-step a busy machine may take its time
    numbers["timeout"] = timeout_s or (0.3 if speed else 5.0)
    path.write_text(RIG.format(wire=f"mortal {folder.name}", actuator=actuator, **where, **numbers))
    return path
