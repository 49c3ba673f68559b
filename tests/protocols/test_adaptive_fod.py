"""The adaptive protocol: no side effects, follows its chooser within limits, and stops at the right time."""

import math

import pytest

from smarig.core.command import Hold, Mark, Settled, StepResult, StepVerdict
from smarig.core.errors import Interrupted, UsageError
from smarig.protocols._settings import build_protocol, setting_texts
from smarig.protocols._setup import Setup
from smarig.protocols.adaptive_fod import NextInputs, adaptive_fod, halving
from smarig.record import load_run
from smarig.rig.guard import Guard
from smarig.rig.twin import Twin
from smarig.runner.listener import CallbackListener
from smarig.runner.preview import Preview
from smarig.runner.run_control import RunControl
from smarig.runner.runner import Runner
from smarig.runner.session import Session

ONE = Setup.of("one_wire_twin")
KNOWN = Preview("adaptive_fod", 3600.0, 60, 1.0, 174.1, 0, 1_000_000)


class ScriptedChooser:
    """A chooser that follows a script and remembers what it was shown."""

    def __init__(self, *choices):
        self.choices, self.shown = list(choices), []

    def __call__(self, setup, seen, settle):
        self.shown.append(seen)
        return self.choices.pop(0) if self.choices else NextInputs(())


def carried_out(protocol, counts=100.0, hold_s=60.0, verdict=StepVerdict.SETTLED):
    """All commands of a protocol whose holds take a minute and read the same, one more each time."""
    commands, t_s, answer = [], 0.0, None
    while True:
        try:
            command = protocol.send(answer)
        except StopIteration:
            return commands
        commands.append(command)
        answer = None
        if isinstance(command, Hold):
            k = sum(isinstance(c, Hold) for c in commands)
            answer = StepResult(k - 1, verdict, 0.0, counts + k, 0.4, 250, t_s, t_s + hold_s)
            t_s += hold_s


def held(commands):
    return [c.target for c in commands if isinstance(c, Hold)]


def marks(commands):
    return [c.label for c in commands if isinstance(c, Mark)]


def test_it_begins_in_both_saturations_whatever_the_chooser():
    chooser = ScriptedChooser()
    commands = carried_out(adaptive_fod(ONE, chooser))
    assert held(commands) == [ONE.lower_K, ONE.upper_K]
    assert [(s.input_K, s.counts) for s in chooser.shown[0]] == [(0.0, 101.0), (174.1, 102.0)]


def test_it_is_inert_until_it_is_run():
    chooser = ScriptedChooser(NextInputs((50.0,)))
    protocol = adaptive_fod(ONE, chooser)
    assert isinstance(next(protocol), Mark)
    assert not chooser.shown


def test_it_holds_what_was_chosen_and_shows_all_it_has_seen():
    chooser = ScriptedChooser(NextInputs((50.0, 20.0)), NextInputs((90.0,)))
    commands = carried_out(adaptive_fod(ONE, chooser))
    assert held(commands)[2:] == [50.0, 20.0, 90.0]
    assert [len(seen) for seen in chooser.shown] == [2, 4, 5]
    assert [s.input_K for s in chooser.shown[-1]] == held(commands)
    assert [c.branch for c in commands if isinstance(c, Hold)][2:] == ["fall", "fall", "rise"]


def test_it_stops_at_the_target_and_calls_the_chooser_no_more():
    chooser = ScriptedChooser(NextInputs((50.0,), 0.3), NextInputs((60.0,), 0.02), NextInputs((70.0,), 0.001))
    commands = carried_out(adaptive_fod(ONE, chooser, target_share=0.02))
    assert held(commands)[2:] == [50.0]
    assert marks(commands)[-1] == "target reached"


def test_a_chooser_that_cannot_predict_never_reaches_the_target():
    choices = [NextInputs((50.0 + k,), math.nan) for k in range(5)]
    assert len(held(carried_out(adaptive_fod(ONE, ScriptedChooser(*choices), target_share=0.9)))) == 7


def test_it_stops_when_its_time_is_up():
    def endless(setup, seen, settle):
        return NextInputs((40.0, 80.0, 20.0), 0.5)

    commands = carried_out(adaptive_fod(ONE, endless, longest_h=0.25))
    assert len(held(commands)) == 15  # of a minute each, in the middle of what was chosen
    assert marks(commands)[-1] == "time is up"


def test_unsettled_holds_are_passed_on_as_such_and_the_run_continues():
    chooser = ScriptedChooser(NextInputs((50.0,)), NextInputs((60.0,)))
    commands = carried_out(adaptive_fod(ONE, chooser), verdict=StepVerdict.TIMED_OUT)
    assert len(held(commands)) == 4
    assert not any(s.settled for s in chooser.shown[-1])


@pytest.mark.parametrize("asked_K", [-1.0, 180.0, math.nan, math.inf])
def test_what_lies_outside_the_limits_is_refused_before_it_reaches_the_rig(asked_K):
    twin = Twin.named("one_wire_twin", seed=1)
    currents = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator),
        1.0,
        [CallbackListener(lambda s, *_: currents.append(s.current_A))],
    )
    with pytest.raises(UsageError, match="outside the rig's range"):
        runner.run(adaptive_fod(ONE, ScriptedChooser(NextInputs((asked_K,)))))
    assert twin.output_A == 0.0
    assert 0.9 < max(currents) < 1.01


def test_it_cannot_be_listed_because_it_chooses_from_results():
    with pytest.raises(UsageError, match="chooses its inputs from results"):
        list(adaptive_fod(ONE))


def test_halving_refines_even_partitions_and_ends():
    chosen, asked = [], [0.0, 174.1]
    while (choice := halving(ONE, asked, Settled())).inputs_K:
        chosen.append(choice.inputs_K)
        asked = [*asked, *choice.inputs_K]
    assert [len(inputs) for inputs in chosen] == [*range(2, 6), *range(2, 10), *range(2, 18)]
    assert chosen[1] == pytest.approx([87.05, 43.525, 0.0])
    assert {max(inputs) for inputs in chosen[12:]} == {ONE.at(k / 16) for k in range(1, 17)}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"target_share": "0"}, "target_share must lie between 0 and 1"),
        ({"target_share": "1.5"}, "target_share must lie between 0 and 1"),
        ({"target_share": "nan"}, "target_share must lie between 0 and 1"),
        ({"target_share": "little"}, "setting target_share"),
        ({"longest_h": "-1"}, "longest_h must lie"),
        ({"longest_h": "inf"}, "longest_h must lie"),
        ({"settle.window_s": "-3"}, "Settling needs"),
        ({"chooser": "informed"}, "has no setting 'chooser'"),
    ],
)
def test_bad_settings_get_one_sentence_before_anything_is_run(settings, message):
    with pytest.raises(UsageError, match=message) as caught:
        build_protocol("adaptive_fod", ONE, settings)
    assert "\n" not in str(caught.value)


def test_a_chooser_is_handed_to_the_protocols_that_take_one():
    chooser = ScriptedChooser(NextInputs((33.0,)))
    assert 33.0 in held(carried_out(build_protocol("adaptive_fod", ONE, {}, chooser)))
    assert len(held(list(build_protocol("wiping_out", ONE, {}, chooser)))) == len(
        held(list(build_protocol("wiping_out", ONE)))
    )
    assert "chooser" not in dict(setting_texts("adaptive_fod"))


def test_an_interruption_leaves_a_closed_run_with_what_was_measured(tmp_path):
    control = RunControl()

    def impatient(setup, seen, settle):
        if len(seen) == 4:
            control.stop("enough for today")
        return NextInputs((60.0, 20.0))

    out = tmp_path / "adaptive.run.sqlite"
    with Session("one_wire_twin", seed=1, control=control) as session:
        with pytest.raises(Interrupted, match="enough for today"):
            session.run("adaptive_fod", {}, out, expected=KNOWN, chooser=impatient)
        assert session.rig.output_A == 0.0
    run = load_run(out)
    assert run.cause == "enough for today"
    assert [s.target for s in run.steps] == [0.0, 174.1, 60.0, 20.0]
    assert [e.text for e in run.events if "inputs_K" in e.data] == ["chosen", "chosen"]


def test_a_wire_that_never_settles_in_time_does_not_stop_it():
    twin = Twin.named("one_wire_twin", seed=1)
    results = []
    runner = Runner(
        Guard(twin, twin.file.limits, twin.actuator), 1.0, [CallbackListener(on_step=results.append)]
    )
    hasty = Settled(window_s=25.0, timeout_s=25.0)
    runner.run(
        adaptive_fod(ONE, ScriptedChooser(NextInputs((100.0, 50.0)), NextInputs((80.0,))), settle=hasty)
    )
    assert len(results) == 5
    assert sum(r.verdict is StepVerdict.TIMED_OUT for r in results) >= 3
