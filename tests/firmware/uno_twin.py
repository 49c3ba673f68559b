"""The Uno's bench with the twin's wire, and the rig files of a host for it."""

import math
from pathlib import Path

from smarig.config import load_rig
from smarig.plant import Actuator
from smarig.rig import TwinSettings
from smarig.rig.specimen import plant_of

COUPLE_MS = 25
# device time follows the host, so a busy machine is never late: the host need not wait for its clock
OPTIONS = ("--speed", "0", "--wait", "110", "--couple", str(COUPLE_MS))
REST_counts = 1000.0
TIMEOUT_S = 5.0  # of a reply: device time waits, but a busy machine takes its own time


class TwinWire:
    """The wire of an actuator file without noise, advanced by the current that flowed on the board."""

    def __init__(self, actuator_name: str = "gorbet_one_wire") -> None:
        file = load_rig("uno_one_wire")
        actuator = Actuator.named(actuator_name)
        file = file.model_copy(update={"period_s": COUPLE_MS / 1000})
        self._plant = plant_of(file, actuator, TwinSettings(noise=False))
        self._per_count = actuator.position_per_count(file.encoder.counts_per_rev)
        self._rest = self._plant.position

    def __call__(self, square_A2: float) -> str:
        """Resistance, counts and ambient temperature after an interval with this mean square of the current."""
        current_A = math.sqrt(square_A2)
        position = self._plant.step(current_A)
        counts = REST_counts + (position - self._rest) / self._per_count
        return f"{self._plant.resistance_ohm(current_A):.5f} {counts:.4f} 22.0"


def host_rig(folder: Path, port: str, **more: str) -> Path:
    """The rig file of a host on the board's port: the shipped template with its url."""
    path = folder / "uno.toml"
    lines = [f"{key} = {value}" for key, value in more.items()]
    path.write_text(
        "\n".join(
            [
                'name = "uno"',
                'base = "uno_one_wire"',
                f'wire = "uno {folder.name}"',
                *lines,
                f'links.amplifier = {{ url = "{port}", timeout_s = {TIMEOUT_S} }}',
                f'links.encoder_daq = {{ url = "{port}", timeout_s = {TIMEOUT_S} }}',
            ]
        ),
        encoding="utf-8",
    )
    return path


def twin_rig(folder: Path, actuator: str) -> Path:
    """The same rig in process, without noise."""
    path = folder / "twin.toml"
    path.write_text(
        f'name = "uno_twin"\nbase = "one_wire_twin"\nactuator = "{actuator}"\n'
        "encoder = { counts_per_rev = 4096, noise_counts = 0.0 }\n"
        "amplifier = { current_noise_A = 0.0, voltage_noise_V = 0.0 }\n",
        encoding="utf-8",
    )
    return path
