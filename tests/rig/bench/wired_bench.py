"""A bench on simulated devices and lines whose every frame passes through the test's hand."""

import pytest

from rig.bench.wired_time import PERIOD_s, World
from smarig.config import load_rig
from smarig.core.errors import RigFault
from smarig.core.sample import Quality
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier, _settings
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
from smarig.plant.actuator import Actuator
from smarig.rig.bench import Bench

FILE = load_rig("one_wire_serial").model_copy(update={"lease_s": 1.0})
NOT_GOOD = int(Quality.SUSPECT | Quality.TRIPPED | Quality.STALE)
POLLS = 30


class Wired:
    """A bench on a world, and the test's hand between them: ``change`` gets every frame for the amplifier."""

    def __init__(self, framing: str, patch: pytest.MonkeyPatch, first_tick: int = 0) -> None:
        self.world, self._patch = World(framing), patch
        self._first_tick = first_tick
        for device in (self.world.amplifier, self.world.bench.daq):
            device.start_at(0, first_tick)
        self.change = lambda request: request
        self.lose_next_reply = False
        self.repeated, self._last = 0, b""
        self.source = SmarigAmplifier(self._link("amplifier"), _settings(FILE))
        sensor = SmarigEncoderDaq(self._link("encoder_daq"), PERIOD_s)
        time = self.world.time
        self.bench = Bench(
            FILE, Actuator.named(FILE.actuator), self.source, sensor, speed=1.0, clock=time, sleep=time.sleep
        )
        self.samples = []

    def _link(self, name: str):
        def sent(request: bytes) -> None:
            self.repeated += request == self._last
            self._last = request
            reply = self.world.answer(name, self.change(request) if name == "amplifier" else request)
            if reply is not None and not (self.lose_next_reply and name == "amplifier"):
                arrive(reply)
            self.lose_next_reply &= name != "amplifier"

        link, arrive = self.world.link(name, sent, self._patch)
        return link

    def other_host(self):
        """A second host's link to the amplifier."""
        return self._link("amplifier")

    def step(self, current_A: float):
        new = self.bench.step(current_A)
        self.samples += new
        return new

    def wrong(self) -> list[tuple[int, float, float]]:
        """Samples recorded good whose command is not what flowed."""
        flowed_A = {self._first_tick + k: uA / 1e6 for k, uA in enumerate(self.world.driven_uA)}
        return [
            (s.tick, s.current_command_A, flowed_A[s.tick])
            for s in self.samples
            if not s.quality & NOT_GOOD and abs(s.current_command_A - flowed_A[s.tick]) > 2e-6
        ]

    def work(self, polls: int = POLLS) -> RigFault | None:
        """Change the current now and then; the fault that ended it."""
        for k in range(polls):
            try:
                self.step((0.3, 0.3, 0.758, 0.5)[k // 3 % 4])
            except RigFault as fault:
                return fault
        return None
