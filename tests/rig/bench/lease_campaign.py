"""Hosts that work on hostile lines and die at random moments: what flowed after their death, what they recorded."""

import random
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from rig.bench.hostile_line import HostileLine
from rig.bench.wired_time import PERIOD_s, World
from smarig.config import load_rig
from smarig.core.errors import SmarigError
from smarig.core.sample import Quality
from smarig.device.drivers.smarig_amplifier import SmarigAmplifier, _settings
from smarig.device.drivers.smarig_encoder_daq import SmarigEncoderDaq
from smarig.device.encoding.exchange import Exchange
from smarig.plant.actuator import Actuator
from smarig.rig.bench import Bench

LEASE_s = 1.0
LEASE_TICKS = round(LEASE_s / PERIOD_s)
AFTERLIFE_TICKS = 4 * LEASE_TICKS
LEVELS_A = (0.0, 0.2, 0.35, 0.5, 0.65, 0.8)
NOT_GOOD = int(Quality.SUSPECT | Quality.TRIPPED | Quality.STALE)
FIRST_SEQUENCE = 65_400  # of the amplifier when the first host begins, about
LIFE = 60  # polls of one measurement, at most


class HostDied(BaseException):
    """The host's process ends here: nothing of it runs any more."""


@dataclass
class Figures:
    """What a campaign has found."""

    polls: int = 0
    good: int = 0
    wrong: list[tuple[int, float, float]] = field(default_factory=list)  # tick, command, what flowed
    beyond_limits: int = 0
    deaths: int = 0
    under_current: int = 0  # deaths while current flowed
    after_death: list[int] = field(default_factory=list)  # ticks with current after each death
    trips: Counter[str] = field(default_factory=Counter)
    after_last_frame: list[int] = field(default_factory=list)  # after the last one under way had arrived, too
    endings: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)

    def __str__(self) -> str:
        worst_s, last_s = (
            max(ticks, default=0) * PERIOD_s for ticks in (self.after_death, self.after_last_frame)
        )
        return (
            f"{self.polls} polls, {self.good} samples recorded good, {len(self.wrong)} of them wrong, "
            f"{self.deaths} deaths, {self.under_current} of them while current flowed, "
            f"current after death at most {worst_s:.1f} s "
            f"and {last_s:.1f} s after the host's last frame had arrived (lease {LEASE_s:g} s), "
            f"beyond the limits in {self.beyond_limits} ticks\n"
            f"faults: {dict(sorted(self.faults.items()))}\ntrips: {dict(self.trips)}; "
            f"what hosts were told: {dict(self.endings)}"
        )


class Campaign:
    """One world, one hostile line to each device, one host after the other."""

    def __init__(self, framing: str, library: Path | None, share: float, patch: pytest.MonkeyPatch) -> None:
        self.figures = Figures()
        self._draw = random.Random(f"{framing} {bool(library)}")
        self._world, self._patch = World(framing, library), patch
        self._file = load_rig("one_wire_serial").model_copy(update={"lease_s": LEASE_s})
        self._lines = {
            name: HostileLine(
                self._world.time,
                framing,
                lambda request, name=name: self._world.answer(name, request),
                self._world.arms if name == "amplifier" else lambda _: False,
                self._draw,
                share,
            )
            for name in ("amplifier", "encoder_daq")
        }
        self._frames_left = 0  # until the host dies
        self._approach_two_words()

    def _approach_two_words(self) -> None:
        """Sequences are longer than a word soon after the first host has begun."""
        link, to_host = self._world.link("amplifier", self._plainly, self._patch)
        self._to_host = to_host
        for sequence in range(256, FIRST_SEQUENCE, 256):
            link.exchange(Exchange(0, 1, 0x100, (0, sequence, 0, 1)))

    def _plainly(self, request: bytes) -> None:
        self._to_host(self._world.answer("amplifier", request) or b"")

    def run(self, polls: int) -> Figures:
        """Hosts until so many polls were made."""
        while self.figures.polls < polls:
            self._frames_left = self._draw.randrange(10, 4 * LIFE)
            try:
                self._live(polls)
            except HostDied:
                self._after_death()
        for name, line in self._lines.items():
            for kind, times in line.counted.items():
                self.figures.faults[f"{name} {kind}"] += times
        self.figures.trips = self._world.trips
        limits = self._file.limits
        self.figures.beyond_limits = sum(
            not limits.current_min_A <= uA / 1e6 <= limits.current_max_A for uA in self._world.driven_uA
        )
        return self.figures

    # --- a host ---

    def _live(self, polls: int) -> None:
        """Open, work, switch off; a fault ends one measurement, and after too many the host opens anew."""
        try:
            bench = self._opened()
        except SmarigError as error:
            self._ended(error)
            return
        for _ in range(self._draw.randrange(1, 4)):
            try:
                self._measure(bench, polls)
                break
            except SmarigError as error:
                self._ended(error)
                bench.safe()
                try:
                    bench.arm()
                except SmarigError as again:
                    self._ended(again)
                    break
        bench.safe()
        bench.close()

    def _opened(self) -> Bench:
        links = {}
        for name, line in self._lines.items():
            link, line.to_host = self._world.link(name, self._sends(line), self._patch)
            links[name] = link
        source = SmarigAmplifier(links["amplifier"], _settings(self._file))
        sensor = SmarigEncoderDaq(links["encoder_daq"], PERIOD_s)
        time, actuator = self._world.time, Actuator.named(self._file.actuator)
        return Bench(self._file, actuator, source, sensor, speed=1.0, clock=time, sleep=time.sleep)

    def _sends(self, line: HostileLine):
        """The host's last act may be to send a frame, or to be about to."""

        def send(request: bytes) -> None:
            self._frames_left -= 1
            last = self._frames_left <= 0
            if last and self._draw.random() < 0.3:
                raise HostDied
            line.sent(request)
            if last:
                raise HostDied

        return send

    def _measure(self, bench: Bench, polls: int) -> None:
        current_A = 0.0
        for _ in range(self._draw.randrange(5, LIFE)):
            if self.figures.polls >= polls:
                return
            if self._draw.random() < 0.4:
                current_A = self._draw.choice(LEVELS_A)
            self.figures.polls += 1
            for sample in bench.step(current_A):
                self._judge(sample)

    def _judge(self, sample) -> None:
        """A sample that a recorder takes for good says what was ordered, and that has flowed."""
        if sample.quality & NOT_GOOD:
            return
        self.figures.good += 1
        flowed_A = self._world.driven_uA[sample.tick] / 1e6
        if abs(sample.current_command_A - flowed_A) > 2e-6:
            self.figures.wrong.append((sample.tick, sample.current_command_A, flowed_A))

    def _ended(self, error: SmarigError) -> None:
        self.figures.endings[type(error).__name__] += 1

    # --- after its death ---

    def _after_death(self) -> None:
        self.figures.deaths += 1
        began = self._world.ticks
        self.figures.under_current += self._world.amplifier.output_uA != 0
        for line in self._lines.values():
            line.host_lives = False
        for _ in range(AFTERLIFE_TICKS):
            for line in self._lines.values():
                line.haunt()
            self._world.time.sleep(PERIOD_s)
        for line in self._lines.values():
            line.host_lives = True
        end_s = self._world.time()
        arrived = self._world.ticks - int((end_s - self._lines["amplifier"].last_arrival_s) / PERIOD_s)
        flowed = [k for k, uA in enumerate(self._world.driven_uA) if k > began and uA]
        self.figures.after_death.append(len(flowed))
        self.figures.after_last_frame.append(sum(k > arrived for k in flowed))
