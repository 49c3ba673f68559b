"""A position that moves against the heat of every wire is seen at its first clear motion; one that is slow is not."""

import math
import random

import pytest

from smarig.plant import Actuator
from smarig.preisach import Preisach, thesis_surface
from smarig.rig.direction import Direction, Rise
from smarig.rig.wire_bounds import WireBounds

PERIOD_S = 0.1
WIRES = {"gorbet_one_wire": "one_e", "gorbet_two_wire": "two_e"}


class Watched:
    """A wire that differs from its file within a tolerance, its sensor with a lag, and the check of its direction."""

    def __init__(self, name, *, factor, lag, start, sensor_taus=0.0, sign=1, tolerance=0.1):
        self.actuator = Actuator.named(name)
        self.surface = thesis_surface(WIRES[name])
        self.wire, self.bounds = (
            Preisach(self.surface, start),
            WireBounds(self.actuator, PERIOD_S, 1e-3, tolerance, 22.0),
        )
        self.stroke, self.factor, self.sign = self.bounds.stroke, factor, sign
        self.check = Direction(
            self.bounds.counts_per_K,
            self.bounds.temperature.least_K,
            tolerance / 2 * self.stroke,
            self.bounds.lag,
        )
        self._decay = math.exp(-PERIOD_S / (lag * self.actuator.tau_s))
        self._sensor = 1 - math.exp(-PERIOD_S / (sensor_taus * self.actuator.tau_s)) if sensor_taus else 1.0
        self.heats_K, self.read = [0.0, 0.0], self.wire.step(0.0)

    def tick(self, current_A):
        """Whether the reading moves against every wire after one more tick."""
        hot = 1 if self.actuator.two_wire and current_A < 0 else 0
        for k in range(2):
            source_K = self.factor * abs(self.actuator.input_for(abs(current_A))) if k == hot else 0.0
            self.heats_K[k] = source_K + (self.heats_K[k] - source_K) * self._decay
        y = self.wire.step(self.heats_K[0] - (self.heats_K[1] if self.actuator.two_wire else 0.0))
        self.read += self._sensor * (y - self.read)
        self.bounds.step(current_A)
        if self.bounds.positions is not None:
            self.check.add(self.bounds.temperature, self.sign * self.read * 1e3)
        return self.check.against


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("name", WIRES)
@pytest.mark.parametrize("factor", [0.91, 1.09])
@pytest.mark.parametrize(("lag", "sensor_taus"), [(0.4, 0.0), (1.0, 1.0), (2.5, 1.0)])
@pytest.mark.parametrize("start", ["negative", "positive"])
def test_a_wire_within_the_tolerance_never_moves_against_its_heat(name, factor, lag, sensor_taus, start):
    watched = Watched(name, factor=factor, lag=lag, start=start, sensor_taus=sensor_taus)
    least_A = -1.0 if watched.actuator.two_wire else 0.0
    dice, current_A, extent = random.Random(3), 0.0, [math.inf, -math.inf]
    for k in range(6000):
        if k % 61 == 0:
            current_A = dice.uniform(least_A, 1.0)
        assert not watched.tick(current_A), k
        extent = [min(extent[0], watched.read), max(extent[1], watched.read)]
    assert 1e3 * (extent[1] - extent[0]) > 0.3 * watched.stroke, "it moves"


@pytest.mark.parametrize("name", WIRES)
@pytest.mark.parametrize(
    ("before_A", "rate_A_per_s"), [(0.0, math.inf), (0.0, 0.02), (0.9, math.inf), (0.9, 0.02)]
)
@pytest.mark.parametrize(("tolerance", "share"), [(0.1, 1 / 7), (0.3, 0.2)])
def test_a_wrong_sign_is_seen_within_a_time_constant_or_a_share_of_the_stroke(
    name, before_A, rate_A_per_s, tolerance, share
):
    """Heating from rest and cooling from heat, at once and slowly."""
    watched = Watched(name, factor=1.0, lag=1.0, start="negative", sign=-1, tolerance=tolerance)
    for _ in range(1200):
        watched.tick(before_A)
    watched.check.forget()
    begin, current_A, after_A = watched.read, before_A, 0.9 - before_A
    ticks, against = 0, False
    while not against and ticks < 1200:
        change_A = min(rate_A_per_s * PERIOD_S, abs(after_A - current_A))
        current_A += math.copysign(change_A, after_A - current_A)
        against, ticks = watched.tick(current_A), ticks + 1
    assert against
    moved = 1e3 * abs(watched.read - begin)
    assert moved > tolerance / 2 * watched.stroke, "not before"
    assert ticks * PERIOD_S < watched.actuator.tau_s or moved < share * watched.stroke


def test_a_fall_that_the_cooling_explains_is_none():
    rise = Rise(counts_per_K=2.0, least_K=3.0, tolerance=10.0)
    assert rise.add(([0.0], []), 0.0) == 0.0
    assert rise.add(([10.0], []), 20.0) == 0.0
    assert rise.add(([20.0], []), 40.0) == 0.0
    assert rise.add(([16.0], []), 12.0) == 0.0, (
        "8 of 20 counts are those of 4 K, 12 begin below what was at 0 K"
    )
    assert rise.add(([20.0], []), 2.0) == 20.0 - 2.0 - 8.0
    assert rise.add(([14.0], []), -5.0) == 0.0, "12 counts of 6 K: more than the tolerance, so it begins anew"


def test_a_hold_of_days_is_kept_in_few_readings():
    rise = Rise(counts_per_K=2.0, least_K=3.0, tolerance=10.0)
    dice = random.Random(1)
    rise.add(([0.0], []), 0.0)
    for _ in range(20_000):
        rise.add(([50.0 + dice.gauss(0.0, 0.05)], []), 100.0 + dice.gauss(0.0, 1.0))
    assert len(rise._later) < 10
    assert rise.add(([60.0], []), 60.0) > 30.0, "the highest of them is kept"
