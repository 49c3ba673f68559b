"""The runner: executes commands, returns results to protocols, and leaves the rig safe on every ending."""

import pytest

from smarig.core.command import Drive, Elapsed, Hold, Mark, StepResult, Waveform, Zero
from smarig.core.errors import Interrupted, UsageError
from smarig.core.sample import Sample
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.run_control import RunControl
from smarig.runner.runner import Runner


def setup(listeners=(), control=None):
    twin = Twin.named("one_wire_twin", noise=False)
    return twin, Runner(Guard(twin, twin.file.limits, twin.actuator), 0.047, listeners, control)


def test_a_protocol_is_answered_with_results_and_samples():
    answers = []

    def protocol():
        answers.append((yield Hold(0.5, Elapsed(1.0))))
        answers.append((yield Drive(0.4)))
        answers.append((yield Mark("note")))
        answers.append((yield Waveform((0.1, 0.2, 0.3), 0.2)))

    _, runner = setup()
    runner.run(protocol())
    hold, sample, nothing, wave = answers
    assert isinstance(hold, StepResult)
    assert isinstance(sample, Sample)
    assert sample.current_command_A == 0.4
    assert nothing is None
    assert wave.n == 6


def test_a_waveform_is_held_over_its_own_period():
    observed = []
    _, runner = setup([CallbackListener(on_sample=lambda s, step, u: observed.append(s.current_command_A))])
    runner.run(c for c in [Waveform((0.1, 0.2, 0.3), 0.3)])
    assert observed == [0.1] * 3 + [0.2] * 3 + [0.3] * 3


def test_zero_reaches_the_encoder():
    twin, runner = setup()
    runner.run(c for c in [Hold(1.0, Elapsed(60)), Zero()])
    assert twin.step(1.0)[0].counts == 0


def test_a_stop_ends_the_run_on_the_next_tick_at_zero():
    control = RunControl()
    ticks = []

    def after_five(s, step, u):
        ticks.append(s.tick)
        if len(ticks) == 5:
            control.stop("enough")

    twin, runner = setup([CallbackListener(on_sample=after_five)], control)
    with pytest.raises(Interrupted, match="enough"):
        runner.run(c for c in [Hold(0.5, Elapsed(100))])
    assert len(ticks) == 5
    assert twin.output_A == 0.0


def test_a_pause_holds_the_current_and_keeps_sampling():
    control = RunControl()
    observed = []

    def watch(s, step, u):
        observed.append(s.current_command_A)
        control.paused = 10 <= len(observed) < 60

    _, runner = setup([CallbackListener(on_sample=watch)], control)
    runner.run(c for c in [Hold(0.5, Elapsed(2.0))])
    assert len(observed) == 20 + 50
    assert set(observed) == {0.5}


@pytest.mark.parametrize("where", ["protocol", "listener"])
def test_an_exception_anywhere_leaves_the_current_at_zero(where):
    def broken_listener(s, step, u):
        if where == "listener" and s.tick == 7:
            raise RuntimeError("listener broke")

    def protocol():
        yield Hold(0.5, Elapsed(1.0))
        if where == "protocol":
            raise RuntimeError("protocol broke")

    twin, runner = setup([CallbackListener(on_sample=broken_listener)])
    with pytest.raises(RuntimeError, match=f"{where} broke"):
        runner.run(protocol())
    assert twin.tick > 0
    assert twin.output_A == 0.0


def test_an_unknown_command_is_refused():
    _, runner = setup()
    with pytest.raises(UsageError, match="yield Hold, Waveform, Drive, Zero or Mark, got 'full speed'"):
        runner.run(c for c in ["full speed"])
