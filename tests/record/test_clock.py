"""A suspended host or a changed clock is reported once, in one sentence."""

import time

import pytest

from record.runs import META, sample
from smarig.record import Recorder, load_run
from smarig.record.clock_watch import ClockWatch


class Clocks:
    """A host's two clocks, moved by hand."""

    def __init__(self):
        self.wall, self.steady = 1e9, 50.0

    def pass_by(self, wall_s, steady_s):
        self.wall += wall_s
        self.steady += steady_s

    def watch(self, **how):
        return ClockWatch(wall=lambda: self.wall, steady=lambda: self.steady, **how)


@pytest.mark.parametrize("jump_s", [3600.0, -3600.0, 2.5])
def test_a_clock_jump_is_reported_once(jump_s):
    clocks = Clocks()
    watch = clocks.watch()
    clocks.pass_by(0.5, 0.5)
    assert watch.jump(0.5) == ""
    clocks.pass_by(0.5 + jump_s, 0.5)
    assert f"{jump_s:+.1f} s" in watch.jump(1.0)
    clocks.pass_by(0.5, 0.5)
    assert watch.jump(1.5) == ""


def test_discipline_and_slow_commits_are_no_jumps():
    clocks = Clocks()
    watch = clocks.watch()
    clocks.pass_by(100.0 + 1.9, 100.0)
    assert watch.jump(8000.0) == ""


def test_the_devices_clock_is_compared_in_real_time_only():
    for real_time in (True, False):
        clocks = Clocks()
        watch = clocks.watch(real_time=real_time)
        jumps = []
        for device_s in (0.5, 1.0, 31.0, 31.5):  # half a second of ours each
            clocks.pass_by(0.5, 0.5)
            jumps.append(watch.jump(device_s))
        assert [bool(t) for t in jumps] == [False, False, real_time, False]


def test_the_recorder_writes_it_down(tmp_path):
    clocks = Clocks()
    recorder = Recorder(tmp_path / "a.run.sqlite", META, clock=clocks.watch())
    clocks.pass_by(7200.0, 1.0)
    recorder.sample(sample(1), None, 0.0)
    recorder.close(t_s=0.1)
    jumps = [e for e in load_run(tmp_path / "a.run.sqlite").events if e.kind == "clock"]
    assert [(e.level, "7199" in e.text) for e in jumps] == [("warning", True)]


def test_clocks_that_agree_are_passed_over(tmp_path):
    recorder = Recorder(tmp_path / "a.run.sqlite", META)
    recorder.sample(sample(1), None, 0.0)
    recorder.close(t_s=time.monotonic())
    assert not [e for e in load_run(tmp_path / "a.run.sqlite").events if e.kind == "clock"]
