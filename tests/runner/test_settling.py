"""The settling rule: noise does not prevent settling, drift does, and time-outs are reported."""

import math
from typing import cast

import numpy as np
import pytest

from smarig.core.command import Elapsed, Hold, Settled, StepVerdict
from smarig.core.errors import UsageError
from smarig.rig.guard import Guard
from smarig.rig.rig import Rig
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner
from smarig.runner.settling_detection import SettleWindow


def first_settled(counts, until):
    window = SettleWindow(until, 0.1)
    for k, c in enumerate(counts):
        window.add(int(c))
        if window.settled:
            return k + 1, window
    return None, window


def test_a_still_wire_settles_after_exactly_one_window():
    assert first_settled([7] * 400, Settled())[0] == 250


def test_encoder_noise_does_not_keep_it_from_settling():
    rng = np.random.default_rng(0)
    done = [first_settled(np.rint(rng.normal(3.2, 0.4, 3000)), Settled())[0] for _ in range(50)]
    assert all(k is not None and k < 600 for k in done)


def test_a_drift_of_more_than_the_band_per_window_is_not_settled():
    k = np.arange(3000)
    assert first_settled(np.rint(k * 2.0 / 250), Settled())[0] is None


@pytest.mark.parametrize("amplitude", [5.0, 50.0, 250.0])
def test_what_is_left_when_it_settles_is_small(amplitude):
    t = np.arange(4000) * 0.1
    rng = np.random.default_rng(1)
    counts = np.rint(amplitude * np.exp(-t / 5.3) + rng.normal(0, 0.4, t.size))
    k, window = first_settled(counts, Settled())
    mean, _, n = window.statistics()
    assert n == 250
    assert abs(mean) < 0.35
    assert amplitude * math.exp(-t[k] / 5.3) < 0.1


def test_a_hold_that_never_settles_times_out_and_is_marked():
    twin = Twin.named("one_wire_twin", seed=1)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 0.047, [CallbackListener(on_step=results.append)]
    )
    runner.run(c for c in [Hold(0.6, Settled(band_counts=0.01, timeout_s=60.0))])
    assert results[0].verdict is StepVerdict.TIMED_OUT
    assert math.isclose(results[0].t_end_s - results[0].t_start_s, 60.0)
    assert results[0].n == 250


class ScatteringCurrent:
    """A rig whose measured current scatters about the ordered one, or is off by a share of it."""

    def __init__(self, rig, sd_A, gain):
        self._rig, self._sd_A, self._gain, self._rng = rig, sd_A, gain, np.random.default_rng(5)

    def __getattr__(self, name):
        return getattr(self._rig, name)

    def step(self, current_A, at_most=1):
        for s in self._rig.step(current_A, at_most):
            yield s._replace(current_A=s.current_A * self._gain + self._rng.normal(0, self._sd_A))


@pytest.mark.parametrize(("sd_A", "gain"), [(0.0003, 1.0), (0.002, 1.0), (0.0, 1.01)])
def test_what_the_measured_current_scatters_does_not_prolong_a_hold(sd_A, gain):
    ends = []
    for rig in (lambda twin: twin, lambda twin: ScatteringCurrent(twin, sd_A, gain)):
        twin = Twin.named("one_wire_twin", seed=1)
        guard = Guard(cast(Rig, rig(twin)), twin.file.limits, twin.actuator)
        results = []
        Runner(guard, 0.047, [CallbackListener(on_step=results.append)]).run(
            hold for hold in [Hold(0.5, Settled()), Hold(0.6, Settled()), Hold(0.4, Settled())]
        )
        assert {r.verdict for r in results} == {StepVerdict.SETTLED}
        ends.append([r.t_end_s - r.t_start_s for r in results])
    # its heat at the begin of the second hold is that of another current
    assert ends[1] == pytest.approx(ends[0], abs=1.0)


def test_a_fixed_hold_reports_its_last_25_seconds():
    twin = Twin.named("one_wire_twin", noise=False)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 1.0, [CallbackListener(on_step=results.append)]
    )
    runner.run(c for c in [Hold(0.6, Elapsed(100.0)), Hold(0.6, Elapsed(3.0))])
    assert [r.n for r in results] == [250, 30]
    assert results[1].index == 1


@pytest.mark.parametrize("wrong", [{"band_counts": 0}, {"window_s": -1}, {"timeout_s": 5}])
def test_impossible_settling_is_refused(wrong):
    with pytest.raises(UsageError, match="Settling needs"):
        Settled(**wrong)
