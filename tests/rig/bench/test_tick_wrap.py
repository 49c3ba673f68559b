"""A bench whose devices wrap their ticks while it measures: the samples are those of any other hour."""

import pytest

from rig.bench.wired_bench import Wired
from rig.bench.wired_time import PERIOD_s

POLLS = 40
BEFORE = 15  # ticks until the wrap


def measured(framing, patch, first_tick):
    """What a bench records in some polls: current, counts and quality by tick since the devices began."""
    wired = Wired(framing, patch, first_tick)
    assert wired.work(POLLS) is None
    assert wired.wrong() == []
    wired.world.time.sleep(3 * PERIOD_s)  # samples wait in both rings
    assert wired.work(POLLS) is None
    return [
        (s.tick - first_tick, s.current_A, s.current_command_A, s.counts, s.quality) for s in wired.samples
    ]


@pytest.mark.parametrize("framing", ["lines", "modbus_rtu", "modbus_tcp"])
@pytest.mark.parametrize("wrap", [2**16, 2**31, 2**32])
def test_samples_go_on(framing, wrap, monkeypatch):
    usual = measured(framing, monkeypatch, 0)
    assert measured(framing, monkeypatch, wrap - BEFORE) == usual
    assert len(usual) >= 2 * POLLS
