"""Device time in lock-step: it advances when a host requests future samples, and when the host has ended."""

from benches import Bench, PERIOD_s

from simulators.pace import MAX_CATCH_UP_TICKS, HOST_TIMEOUT_s, RealTime
from smarig.device.encoding.exchange import Exchange, Refusal

BEYOND_THE_MAP = Exchange(500, 1, 0x100, (0, 1, 0, 1, 0, 0, 1, 5))


def test_time_stands_until_future_samples_are_requested():
    bench = Bench()
    assert bench.world.ticks == 0
    assert [s[0] for s in bench.samples(1, first=1, want=3)] == [10, 20, 30]
    assert (bench.daq.newest_tick, bench.amplifier.newest_tick) == (3, 3)
    assert [s[0] for s in bench.samples(2, first=2, want=2)] == [20, 30]
    assert bench.world.ticks == 3


def test_a_repeated_exchange_does_not_advance():
    bench = Bench()
    bench.samples(1, first=1, want=1)
    assert bench.samples(1, first=2, want=5) == []
    assert bench.world.ticks == 1


def test_no_more_ticks_than_samples_wanted():
    bench = Bench()
    assert bench.samples(1, first=1000, want=2) == []
    assert bench.world.ticks == 2


def test_what_is_refused_or_for_the_amplifier_does_not_advance():
    bench = Bench()
    assert isinstance(bench.ask("encoder_daq", BEYOND_THE_MAP), Refusal)
    bench.command(1, ring_next=100, ring_want=16)
    assert bench.world.ticks == 0


def test_time_runs_after_a_second_of_silence_and_waits_again_after_a_request():
    bench = Bench()
    bench.pace.catch_up(100.0)
    assert (bench.world.ticks, bench.pace.next_due_s()) == (0, None)  # no host was ever there
    bench.armed(300_000)
    bench.pace.host_active(100.0)
    bench.pace.catch_up(100.0 + HOST_TIMEOUT_s - 0.01)
    assert bench.world.ticks == 0
    bench.pace.catch_up(100.0 + HOST_TIMEOUT_s + 20.5 * PERIOD_s)
    assert (bench.world.ticks, bench.amplifier.state) == (20, "armed")
    bench.pace.catch_up(100.0 + HOST_TIMEOUT_s + 21.5 * PERIOD_s)
    assert (bench.amplifier.state, bench.amplifier.trip) == ("tripped", "lease")
    bench.pace.host_active(104.0)
    bench.pace.catch_up(104.9)
    assert bench.world.ticks == 21


def test_time_runs_for_good_when_the_host_has_ended():
    bench = Bench()
    bench.pace.host_ended(50.0)
    bench.pace.host_active(50.0)
    bench.pace.catch_up(50.0 + 3.5 * PERIOD_s)
    assert bench.world.ticks == 3


def test_real_time_makes_up_for_late_ticks():
    ticks = []
    pace = RealTime(lambda: ticks.append(1), PERIOD_s / 10, 7.0)
    pace.catch_up(7.0)
    assert not ticks
    pace.catch_up(7.0 + 25.5 * PERIOD_s / 10)
    assert len(ticks) == 25
    assert abs(pace.next_due_s() - 7.26) < 1e-9
    pace.catch_up(1e6)
    assert len(ticks) == 25 + MAX_CATCH_UP_TICKS
    pace.catch_up(7.2)
    assert len(ticks) == 25 + MAX_CATCH_UP_TICKS
