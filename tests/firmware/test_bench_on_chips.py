"""A bench on the firmware under simavr, both devices, in real time: the wire is the twin's, five times as quick."""

import threading

import numpy as np

from smarig.config import load_rig
from smarig.model.actuator import Actuator
from smarig.rig.opening import opened
from smarig.rig.specimen import Specimen, TwinSettings

TICK_S = 0.02  # on the chips; the wire's own are 0.1 s
LEVELS_A = (0.75, 0.5)
HOLD, WINDOW = 350, 100  # ticks: six time constants and more, and what is averaged
RIG = """
name = "chips"
base = "one_wire_serial"
period_s = {period}
lease_s = 0.5
protection.slew_max_A_per_s = 100.0
protection.resistance_min_ohm = 1.0
protection.resistance_max_ohm = 20.0
protection.heat_max_A2s = 20.0
protection.heat_settle_s = 10.0
links.amplifier = {{ driver = "smarig_amplifier", framing = "lines", url = "{amplifier}" }}
links.encoder_daq = {{ driver = "smarig_encoder_daq", framing = "lines", url = "{daq}" }}
"""


class Wire:
    """The twin's wire between two chips: lives on with every tick of the amplifier's."""

    def __init__(self):
        file = load_rig("one_wire_twin")
        self._specimen = Specimen(file, Actuator.named(file.actuator), TwinSettings(seed=2))
        self._counts, self._ambient = 0, 2200
        self._one_at_a_time = threading.Lock()

    def amplified(self, driven_uA):
        with self._one_at_a_time:
            r = self._specimen.advance(driven_uA / 1e6)
            self._counts, self._ambient = r.counts, r.ambient
            return f"in {r.current} {r.voltage} {r.temperature} {int(r.saturated)}"

    def counted(self, _):
        with self._one_at_a_time:
            return f"in {self._counts} {self._ambient} 0"


def settled_in_process():
    """Mean counts that the same wire settles at."""
    file = load_rig("one_wire_twin")
    wire = Specimen(file, Actuator.named(file.actuator), TwinSettings(seed=7))
    return [np.mean([wire.advance(level).counts for _ in range(HOLD)][-WINDOW:]) for level in LEVELS_A]


def test_positions_settle_where_the_twins_do(start, tmp_path):
    wire = Wire()
    amplifier = start("amplifier_lines", wire.amplified)
    daq = start("encoder_daq_lines", wire.counted)
    path = tmp_path / "chips.toml"
    text = RIG.format(period=TICK_S, amplifier=amplifier.path, daq=daq.path)
    path.write_text(text)
    file = load_rig(str(path)).model_copy(update={"simulator": None})  # the base has one
    with opened(str(path), file, Actuator.named(file.actuator), TwinSettings()) as bench:
        found = []
        for level in LEVELS_A:
            samples = []
            while len(samples) < HOLD:
                samples += bench.step(level)
            found.append(np.mean([s.counts for s in samples[-WINDOW:]]))
            assert abs(samples[-1].current_A - level) < 0.002
            ticks = np.diff([s.tick for s in samples])
            assert np.all(ticks == 1)
        bench.safe()
    assert found[0] > 100, "it moves"
    np.testing.assert_allclose(found, settled_in_process(), atol=1.0)
