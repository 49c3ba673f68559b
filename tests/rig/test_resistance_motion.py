"""A wire that transforms later than its file says: sound readings go on, and one whose sensor stands is noticed by its
resistance, whatever ``limits.model_tolerance`` is.

The wire shares nothing with the plant: a first-order temperature, and straight branches of a hysteresis.
"""

import math

import numpy as np
import pytest

from smarig.config import load_rig
from smarig.core import LimitExceeded, Quality, Sample
from smarig.plant import Actuator
from smarig.rig import Guard, Plausibility
from smarig.rig.channel_checks import RigReadings

FILE = load_rig("bench_one_wire")
WIRE = Actuator.named(FILE.actuator)
HEATING_K, COOLING_K = (95.0, 115.0), (90.0, 70.0)  # above ambient: start and end of each branch
STROKE = 200  # counts
RAMP_S = 60.0


class LateWire:
    """A rig whose position is coarser than its noise. ``stuck(t_s)``: whether the sensor repeats its last reading, or
    with ``reverses`` moves the other way from then on. ``measures_V``: whether it measures a voltage.
    """

    has_lease, period_s, holds_wire_limit, measures_ambient = True, 0.1, False, False
    shutdown_unconfirmed = ""

    def __init__(self, stuck=lambda _t_s: False, *, reverses=False, measures_V=True):
        self._reverses, self._measures_V = reverses, measures_V
        self.tick, self.output_A, self._T, self._phase, self._counts, self._stuck = 0, 0.0, 0.0, 0.0, 0, stuck

    def step(self, current_A, at_most=1):
        self.tick, self.output_A = self.tick + 1, current_A
        target = WIRE.gain_K_per_A2 * current_A**2
        self._T = target + (self._T - target) * math.exp(-0.1 / WIRE.tau_s)
        up, down = np.interp(self._T, HEATING_K, [0.0, 1.0]), np.interp(self._T, COOLING_K[::-1], [0.0, 1.0])
        self._phase = min(max(self._phase, up), down)
        true = round(STROKE * self._phase)
        if not self._stuck(self.tick * 0.1):
            self._counts = self._last = true
        elif self._reverses:
            self._counts = 2 * self._last - true
        ohm = WIRE.resistance_at_ohm(self._phase) * (1 + 0.002 * math.sin(self.tick))
        return (
            Sample(
                tick=self.tick,
                t_s=self.tick * 0.1,
                current_command_A=current_A,
                current_A=current_A,
                voltage_V=ohm * current_A if self._measures_V else math.nan,
                temperature_degC=math.nan,
                counts=self._counts,
                position=self._counts * WIRE.resolution(FILE.encoder),
                quality=int(Quality.GOOD),
                ambient_degC=22.0,
            ),
        )

    def safe(self):
        self.output_A = 0.0
        return ""

    def alarms(self):
        return []

    def raise_if_tripped(self):
        pass


def driven(stuck=lambda _t_s: False, tolerance=0.3, **how):
    """Two triangles of the current to 0.95 A, with a pause at zero. The alarms, and why it ended."""
    limits = FILE.limits.model_copy(update={"model_tolerance": tolerance})
    file = FILE.model_copy(update={"limits": limits})
    rig = LateWire(stuck, **how)
    guard = Guard(rig, limits, WIRE, Plausibility(file, WIRE, RigReadings(counter=False)))
    ramp = [0.95 * k * 0.1 / RAMP_S for k in range(round(RAMP_S / 0.1))]
    found = []
    try:
        for current_A in [*[0.0] * 900, *ramp, *reversed(ramp), *[0.0] * 300, *ramp, *reversed(ramp)]:
            guard.step(current_A)
            found += guard.alarms()
            guard.raise_if_tripped()
    except LimitExceeded as cause:
        assert rig.output_A == 0.0
        return [*found, *guard.alarms()], str(cause), rig.tick * 0.1
    return found, "", math.inf


@pytest.mark.parametrize("tolerance", [0.3, 0.6])
def test_a_sound_wire_that_transforms_later_goes_on_or_is_told_which_limit_to_raise(tolerance):
    alarms, cause, _ = driven(tolerance=tolerance)
    assert cause == "" if tolerance == 0.6 else "raise that limit" in cause
    assert [a.text for a in alarms if a.kind == "still"] == []
    assert {a.level for a in alarms if a.kind == "frozen"} <= {"warning"}


@pytest.mark.parametrize("tolerance", [0.3, 0.6])
@pytest.mark.parametrize(
    ("stuck", "by_s"),
    [
        (lambda _t_s: True, 150.0),  # dead from the start: before the first triangle is at its top
        (lambda t_s: t_s > 152.0, 260.0),  # at the hot end
    ],
    ids=["dead", "hot"],
)
def test_a_sensor_that_stands_is_noticed_by_the_resistance(stuck, by_s, tolerance):
    alarms, cause, ended_s = driven(stuck, tolerance)
    assert "position" in cause
    assert ended_s <= by_s
    assert all(a.doubtful_from is not None for a in alarms if a.level == "error")


@pytest.mark.parametrize("tolerance", [0.3, 0.6])
def test_without_a_voltage_the_model_decides_as_before(tolerance):
    _, cause, ended_s = driven(lambda _t_s: True, tolerance, measures_V=False)
    assert "stays the same to the last digit" in cause
    assert ended_s <= 155.0


def test_a_sensor_that_moves_the_other_way_is_no_wire_that_rests():
    """At the hot end: while the resistance says nothing yet, the position already contradicts every wire."""
    _, cause, ended_s = driven(lambda t_s: t_s > 152.0, 0.3, reverses=True)
    assert "in the other direction" in cause or "away from all that a wire" in cause
    assert ended_s <= 260.0
