"""A bench joins two instruments by their ticks, keeps time, reports lost samples, and is safe."""

import pytest

from rig.bench.instruments import FakeClock, Sensor, Source
from smarig.config import load_rig
from smarig.core.command import Elapsed, Hold
from smarig.core.errors import LeaseExpired
from smarig.core.sample import Quality
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.plant.actuator import Actuator
from smarig.rig.bench import MAX_BLOCK_TICKS, MAX_TICK_GAP, SENSOR_TIMEOUT_S, Bench
from smarig.rig.guard import Guard
from smarig.runner.listener import CallbackListener
from smarig.runner.runner import Runner

FILE = load_rig("bench_one_wire")


def made(source=None, sensor=None, **clocks):
    clock = FakeClock()
    source = Source(clock, **(source or {}))
    sensor = Sensor(clock, **(sensor or {}))
    bench = Bench(
        FILE, Actuator.named(FILE.actuator), source, sensor, clock=clock, sleep=clock.sleep, **clocks
    )
    return bench, source, sensor, clock


def test_a_step_takes_a_tick_and_gives_its_sample():
    bench, source, _, clock = made()
    samples = [s for _ in range(50) for s in bench.step(0.5)]
    assert [s.tick for s in samples] == list(range(1, 51))
    assert clock.now - 100.0 == pytest.approx(5.0, abs=0.15)
    assert source.sent == [0.5], "an unchanged current is not sent again"
    assert samples[-1][:5] == (50, 5.0, 0.5, 0.5, 2.5)
    assert samples[-1].counts == 500
    assert samples[-1].position == pytest.approx(500 * bench.position_per_count)


def test_devices_that_began_at_different_times_are_joined_by_their_ticks():
    bench, *_ = made(source={"ahead": 1000}, sensor={"ahead": 7})
    ticks = [s.tick for _ in range(20) for s in bench.step(0.1)]
    assert ticks == list(range(8, 28))


@pytest.mark.parametrize("ppm", [-3000.0, 3000.0])
def test_clocks_that_drift_apart_stay_joined(ppm):
    """A hundred times worse than quartz: no sample is lost, few are stale, and readings are of the same moment."""
    bench, source, sensor, _ = made(source={"ppm": ppm})
    samples = [s for _ in range(3000) for s in bench.step(0.1)]
    assert [s.tick for s in samples] == list(range(1, len(samples) + 1))
    stale = sum(bool(s.quality & Quality.STALE) for s in samples)
    assert stale <= 30, "ten ticks are nine"
    assert abs(bench._offset - (source.tick() - sensor.tick())) <= 2


def test_a_host_that_stalls_gets_all_that_the_ring_holds():
    bench, _, _, clock = made()
    bench.step(0.2)
    clock.sleep(5.0)
    samples = [s for _ in range(10) for s in bench.step(0.2)]
    assert [s.tick for s in samples] == list(range(2, samples[-1].tick + 1))
    assert samples[-1].tick >= 51
    assert bench.alarms() == []


def test_samples_lost_from_the_ring_are_reported_once():
    bench, _, sensor, clock = made()
    bench.step(0.2)
    clock.sleep(5.0)
    sensor.oldest = 31
    first = bench.step(0.2)[0]
    assert first.tick == 31
    alarm, *rest = bench.alarms()
    assert (alarm.level, alarm.kind, rest) == ("warning", "lost", [])
    assert "29 samples were lost" in alarm.text
    assert alarm.text.endswith("raise period_s.")
    assert bench.alarms() == []


def test_what_passed_before_the_first_sample_is_not_lost():
    bench, _, sensor, clock = made()
    clock.sleep(5.0)
    sensor.oldest = 31
    assert bench.step(0.2)[0].tick == 31
    assert bench.alarms() == []
    clock.sleep(5.0)
    sensor.oldest = 90
    bench.step(0.2)
    assert [alarm.kind for alarm in bench.alarms()] == ["lost"]


@pytest.mark.parametrize("name", ["amplifier", "encoder"])
def test_a_line_that_was_lost_and_came_back_is_reported_once(name):
    bench, source, sensor, _ = made()
    device = source if name == "amplifier" else sensor
    bench.step(0.2)
    assert bench.alarms() == []
    device.reconnections = 1
    (alarm,) = bench.alarms()
    assert (alarm.level, alarm.kind) == ("warning", "reconnected")
    assert f"The line to the {name} was lost" in alarm.text
    assert bench.alarms() == []


def test_an_encoder_without_new_samples_is_a_fault_in_time():
    bench, _, sensor, clock = made()
    bench.step(0.2)
    sensor.dead_until = clock.now + 100
    begun = clock.now
    with pytest.raises(Silent, match="no new sample"):
        bench.step(0.2)
    assert clock.now - begun < SENSOR_TIMEOUT_S + 0.5


def test_a_current_that_was_not_measured_is_the_last_one_marked_stale():
    bench, source, _, clock = made()
    bench.step(0.2)
    source.dead_until = clock.now + 0.35
    samples = [s for _ in range(10) for s in bench.step(0.2)]
    assert any(s.quality & Quality.STALE for s in samples)
    assert all(s.current_A == 0.2 for s in samples)
    assert not samples[-1].quality & Quality.STALE


def test_a_trip_is_seen_in_samples_first_and_refused_then_until_armed():
    bench, source, *_ = made()
    bench.step(0.2)
    source.tripped = "lease"
    assert bench.step(0.2)[-1].quality & Quality.TRIPPED
    with pytest.raises(LeaseExpired, match="lease"):
        bench.step(0.2)
    bench.arm()
    assert not bench.step(0.3)[-1].quality & Quality.TRIPPED
    assert source.sent[-1] == 0.3


def test_safe_is_idempotent_and_the_next_current_is_sent_again():
    bench, source, *_ = made()
    bench.step(0.2)
    bench.safe()
    bench.safe()
    assert source.offs == 2
    bench.step(0.2)
    assert source.sent == [0.2, 0.2]


def test_ticks_that_jump_are_refused():
    bench, _, sensor, clock = made()
    bench.step(0.1)
    sensor.ahead += MAX_TICK_GAP + 10
    clock.sleep(0.1)
    sensor.oldest = sensor.tick()
    with pytest.raises(Garbled, match="tick jumped by"):
        bench.step(0.1)


def test_a_trip_that_no_sample_shows_ends_it_all_the_same():
    """Tripped, and its ring empty."""
    bench, source, _, _ = made()
    bench.step(0.1)
    source.dead_until, source.tripped = 1e9, "Too hot."
    bench.step(0.1)
    with pytest.raises(LeaseExpired, match=r"Too hot\."):
        bench.step(0.1)


def test_zero_and_close_reach_the_instruments():
    bench, source, sensor, _ = made()
    bench.zero()
    bench.close()
    assert (sensor.zeroed, sensor.closed, source.closed) == (1, True, True)


@pytest.mark.parametrize("late_s", [0.0, 0.35])
def test_what_a_late_host_reads_after_a_zero_counts_from_there_too(late_s):
    bench, _, _, clock = made()
    for _ in range(20):
        bench.step(0.5)
    clock.sleep(late_s)
    bench.zero()
    samples = [s for _ in range(10) for s in bench.step(0.5)]
    ticks, counts = zip(*[(s.tick, s.counts) for s in samples])
    assert list(ticks) == list(range(21, 21 + len(ticks))), "none is lost"
    assert {b - a for a, b in zip(counts, counts[1:])} == {10}, "and none has another origin"
    assert -40 < counts[0] <= 0


def test_in_lock_step_no_more_than_the_requested_ticks_pass():
    clock = FakeClock()

    class Waits(Sensor):
        def since(self, tick, at_most):
            self.clock.now += at_most * self.period_s
            return super().since(tick, at_most)

    source, sensor = Source(clock), Waits(clock)
    bench = Bench(
        FILE, Actuator.named(FILE.actuator), source, sensor, speed=0, clock=clock, sleep=clock.sleep
    )
    assert [len(bench.step(0.1, n)) for n in (1, 3, MAX_BLOCK_TICKS, 10 * MAX_BLOCK_TICKS)][:3] == [
        1,
        3,
        min(MAX_BLOCK_TICKS, 9),
    ]


def test_samples_from_before_a_command_carry_the_command_of_their_tick():
    """A host that is late reads them under the next current; they are no reason to doubt the amplifier."""
    bench, source, _, clock = made()
    source.set = lambda current_A: source.sent.append(current_A) or source.tick()
    bench.step(0.2)
    clock.sleep(0.55)
    changed = source.tick()
    samples = [s for _ in range(4) for s in bench.step(0.7)]
    assert {(s.tick <= changed, s.current_command_A) for s in samples} == {(True, 0.2), (False, 0.7)}


@pytest.mark.parametrize("lost", [-12, 12])
def test_what_was_set_and_what_flowed_are_of_the_same_tick_even_when_a_clock_leaps(lost):
    """An amplifier that stood still, or an encoder: what flows is still compared with what was set then."""
    bench, source, sensor, _ = made()
    samples = []
    for k in range(400):
        if k == 100:
            late = source if lost < 0 else sensor
            late.begun += abs(lost) * 0.1
        samples += bench.step(0.5 if k // 7 % 2 else 0.0)
    compared = [s for s in samples if not s.quality & Quality.STALE]
    assert len(compared) > 300
    assert [s.current_A for s in compared] == [s.current_command_A for s in compared]


def test_an_unconfirmed_shutdown_of_the_source_is_reported():
    bench, source, *_ = made()
    source.off = lambda: "not heard"
    bench.safe()
    assert bench.shutdown_unconfirmed == "not heard"


def test_a_hold_lasts_its_time_even_when_the_host_was_late(tmp_path):
    """Samples of the current before belong to the record, not to the next hold's time or window."""
    bench, _, _, clock = made()
    results = []

    def late(result):
        results.append(result)
        clock.sleep(3.0)

    def protocol():
        yield Hold(0.2, Elapsed(2.0))
        yield Hold(0.5, Elapsed(2.0))

    samples = []
    watch = CallbackListener(on_sample=lambda s, step, input_K: samples.append(s), on_step=late)
    guard = Guard(bench, FILE.limits, Actuator.named(FILE.actuator))
    Runner(guard, bench.position_per_count, [watch]).run(protocol())
    assert [s.tick for s in samples] == list(range(1, len(samples) + 1))
    assert 20 <= sum(s.current_command_A == 0.5 for s in samples) <= 20 + MAX_BLOCK_TICKS
    assert sum(s.current_command_A == 0.2 for s in samples) >= 49
    assert [r.n for r in results] == [20, 20]
