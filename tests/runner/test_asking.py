"""Invalid commands and exceptions of protocols: one message, no measured data lost, and the current ends at
zero."""

import contextlib
import signal
import time

import numpy as np
import pytest

from smarig.core.command import Drive, Elapsed, Hold, Mark, Settled, Waveform, Zero
from smarig.core.errors import UsageError
from smarig.record import Recorder, load_run
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.checked_generator import CheckedGenerator, checked
from smarig.runner.run_control import RunControl
from smarig.runner.runner import Runner
from smarig.runner.signal_handling import stop_on_signals


def recorded(protocol, path):
    """Run on a twin and recorded as a session does; the error that ended it, and the record."""
    twin = Twin.named("one_wire_twin", seed=1)
    guard, ended = Guard(twin, twin.file.limits, twin.actuator), None
    recorder = Recorder(path, {"protocol": "test", "rig": "one_wire_twin"})
    runner = Runner(guard, twin.position_per_count, [recorder])
    try:
        runner.run(protocol)
    except BaseException as error:
        ended = error
    recorder.close(str(ended), t_s=runner.t_s)
    assert twin.output_A == 0.0
    return ended, load_run(path)


def test_numbers_of_numpy_are_numbers(tmp_path):
    def protocol():
        for target in np.arange(20, 60, 20):
            yield Hold(np.float32(0.3), Elapsed(1.0), target=target, branch=np.str_("up"))
        yield Drive(np.float64(0.2))
        yield Waveform(np.linspace(0.1, 0.3, 4), np.float32(0.5))

    ended, run = recorded(protocol(), tmp_path / "r.run.sqlite")
    assert ended is None
    assert [s.target for s in run.steps] == [20.0, 40.0, None]
    assert run.steps[0].branch == "up"


NONSENSE = {
    "text for a current": (Hold("1.0", Settled()), "current_A of a Hold must be a number, got '1.0'"),
    "a truth": (Drive(True), "current_A of a Drive must be a number"),
    "nothing": (Hold(None, Settled()), "must be a number, got None"),
    "no condition": (Hold(0.1, 5.0), "until of a Hold must be Elapsed or Settled, got 5.0"),
    "a word as target": (Hold(0.1, Elapsed(1.0), target="abc"), "target of a Hold must be a number"),
    "more than a float": (Hold(0.1, Elapsed(1.0), target=10**400), "target of a Hold must be a number"),
    "an object as branch": (Hold(0.1, Elapsed(1.0), branch=object()), "branch must be a string"),
    "half a character": (Hold(0.1, Elapsed(1.0), branch="\ud800"), "branch must be a string"),
    "a label that is none": (Mark(object(), {}), "label of a Mark must be a string"),
    "half a label": (Mark("\ud800", {}), "label of a Mark must be a string"),
    "data that are none": (Mark("x", {"a": object()}), "data of a Mark cannot be stored as JSON"),
    "half a character in data": (Mark("x", {"a": "\ud800"}), "data of a Mark cannot be"),
    "no currents": (Waveform((), 1.0), "at least one current"),
    "one current": (Waveform(0.5, 1.0), "a sequence of numbers, got 0.5"),
    "no time": (Waveform((0.5,), 0.0), "period_s above 0"),
    "no command": (42, "yield Hold, Waveform, Drive, Zero or Mark, got 42"),
    "a kind": (Zero, "yield Hold, Waveform, Drive, Zero or Mark"),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_is_refused_with_its_line_and_what_was_measured_is_kept(name, tmp_path):
    command, said = NONSENSE[name]

    def protocol():
        yield Hold(0.3, Elapsed(2.0), target=10.0)
        yield command

    ended, run = recorded(protocol(), tmp_path / "r.run.sqlite")
    assert isinstance(ended, UsageError)
    assert said in str(ended)
    assert "test_asking.py, line " in str(ended)
    assert "\n" not in str(ended)
    assert len(run) == 20
    assert [s.target for s in run.steps] == [10.0]


def test_the_line_is_that_of_the_innermost_generator(tmp_path):
    def inner():
        yield 42

    def protocol():
        yield from inner()

    ended, _ = recorded(protocol(), tmp_path / "r.run.sqlite")
    assert f"test_asking.py, line {inner.__code__.co_firstlineno + 1}:" in str(ended)


@pytest.mark.parametrize(
    "raised", [SystemExit(0), SystemExit("bye"), GeneratorExit(), StopIteration(), BaseException("x")]
)
def test_what_ends_programs_ends_a_run_with_a_sentence(raised, tmp_path):
    def protocol():
        yield Hold(0.3, Elapsed(2.0))
        raise raised

    ended, run = recorded(protocol(), tmp_path / "r.run.sqlite")
    assert isinstance(ended, UsageError)
    assert type(raised).__name__ in str(ended)
    assert len(run) == 20


def test_a_protocol_that_swallows_everything_is_let_go_of(tmp_path):
    def protocol():
        for k in range(3):
            with contextlib.suppress(BaseException):
                yield Hold(0.3, Elapsed(1.0)) if k == 0 else 42

    ended, run = recorded(protocol(), tmp_path / "r.run.sqlite")
    assert isinstance(ended, UsageError)
    assert len(run) == 10


@pytest.mark.skipif(not hasattr(signal, "SIGTERM"), reason="no signals here")
def test_one_that_does_not_come_back_is_torn_out_after_a_stop(monkeypatch):
    monkeypatch.setattr("smarig.runner.signal_handling.THINKING_S", 0.05)

    def protocol():
        yield Drive(0.1)
        signal.raise_signal(signal.SIGTERM)
        end_s = time.monotonic() + 30.0
        while time.monotonic() < end_s:
            pass

    control = RunControl()
    checked_generator = CheckedGenerator(protocol(), control)
    with stop_on_signals(control):
        checked_generator.next(None)
        with pytest.raises(KeyboardInterrupt):
            checked_generator.next(None)
    assert control.cause == "terminated (SIGTERM)"


def test_a_command_that_is_right_stays_what_it_is():
    drive, hold = Drive(0.5), Hold(0.5, Settled(), 40.0, "up")
    assert checked(drive) is drive
    assert checked(hold) == hold
