"""The input path to the remembered extrema: few inputs, and the same memory as after the whole history."""

import random

import pytest

from smarig.core.command import Elapsed, Hold, Mark, Waveform
from smarig.core.errors import DataError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.protocols._setup import Setup
from smarig.record import Run, Step, load_run
from smarig.runner.resume.replay_protocol import FinishedStep, replay_protocol
from smarig.runner.resume.resume_plan import _settled_input, find_restore_path


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize(
    ("name", "start"), [("one_e", "negative"), ("two_e", None), ("two_e", "anhysteretic")]
)
def test_it_leads_to_the_same_future(name, start, seed):
    """From any state (or the first, on request), the input path leaves the same memory as the whole history."""
    hysteresis = thesis_surface(name)
    low, high = hysteresis.lower, hysteresis.upper
    dice = random.Random(seed)
    history = [dice.uniform(low, high) for _ in range(dice.randint(1, 12))]
    if start is None:
        history.insert(dice.randint(0, len(history)), dice.choice([low, high]))
    restore = find_restore_path(history, low, high, start)
    assert restore is not None
    undisturbed = Preisach(hysteresis, start or "anhysteretic")
    undisturbed.follow(history)
    resumed = Preisach(hysteresis, "anhysteretic" if restore.from_start else "negative")
    if not restore.from_start:
        resumed.follow([dice.uniform(low, high) for _ in range(5)])  # whatever became of it
        resumed.follow([low] if name == "one_e" else [])  # one wire has cooled
    resumed.follow(restore.inputs_K)
    assert resumed.y == pytest.approx(undisturbed.y, abs=1e-9)
    future = [dice.uniform(low, high) for _ in range(20)]
    assert list(resumed.follow(future)) == pytest.approx(list(undisturbed.follow(future)), abs=1e-9)
    turns = restore.inputs_K
    assert all((b - a) * (c - b) < 0 for a, b, c in zip(turns, turns[1:], turns[2:])), (
        "approached from the same sides"
    )


def test_unknown_until_the_next_saturation():
    assert find_restore_path([10.0, 50.0], -100.0, 100.0, None) is None
    assert find_restore_path([-100.0, None, 50.0], -100.0, 100.0, None) is None
    assert find_restore_path([-100.0, None, 100.0, 50.0], -100.0, 100.0, None).inputs_K == (100.0, 50.0)


def test_a_hold_that_did_not_arrive_and_a_waveform_are_unknown():
    setup = Setup.of("one_wire_twin")
    step = Step(0, 0, False, "", None, 0.0, 1.0, "elapsed", 0.0, 1)
    goal = setup.actuator.input_for(0.5)
    assert _settled_input(FinishedStep(Hold(0.5, Elapsed(99.0)), step, goal - 0.1), setup) == goal
    assert _settled_input(FinishedStep(Hold(0.5, Elapsed(1.0)), step, goal - 2.0), setup) is None
    assert _settled_input(FinishedStep(Waveform((0.5,), 0.1), step, goal), setup) is None


# --- replay --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Run:
    import smarig

    out = tmp_path_factory.mktemp("replay") / "a.run.sqlite"
    return smarig.run("step_currents", rig="one_wire_twin", out=out, currents_A=(0.3, 0.6), wire="r")


def yields(*commands, commands_seen=None):
    for command in commands:
        answer = yield command
        if commands_seen is not None:
            commands_seen.append(answer)


def test_a_protocol_is_answered_what_it_was_answered_then(run):
    from smarig.protocols.step_currents import step_currents

    commands_seen = []
    setup = Setup.of("one_wire_twin")

    def overheard():
        protocol, answer = step_currents(setup, currents_A=(0.3, 0.6)), None
        while True:
            try:
                command = protocol.send(answer)
            except StopIteration:
                return
            answer = yield command
            commands_seen.append(answer)

    replayed = replay_protocol(overheard(), run)
    assert (len(replayed.done), replayed.pending) == (2, None)
    results = [h for h in commands_seen if h is not None]
    assert [r.position for r in results] == [s.position for s in run.steps]
    assert [r.counts * run.meta["output"]["per_count"] for r in results] == [s.position for s in run.steps]
    assert all(r.n == s.n and r.counts_sd > 0 for r, s in zip(results, run.steps))


@pytest.mark.parametrize("what", ["current", "target", "branch", "fewer", "kind"])
def test_another_protocol_is_refused(run, what):
    holds = [Hold(round(0.3 * (k + 1), 1), Elapsed(1.0), s.target, s.branch) for k, s in enumerate(run.steps)]
    second = {
        "current": Hold(0.61, holds[1].until, holds[1].target, holds[1].branch),
        "target": Hold(0.6, holds[1].until, 3.0, holds[1].branch),
        "branch": Hold(0.6, holds[1].until, holds[1].target, "other"),
        "kind": Waveform((0.6,), 0.1, holds[1].branch),
        "fewer": Mark("the end"),
    }[what]
    with pytest.raises(DataError, match=r"have changed|now ends after 1"):
        replay_protocol(yields(Mark("step currents"), holds[0], second), run)
    assert replay_protocol(yields(*holds, Hold(0.1, Elapsed(1.0))), load_run(run.path)).pending == Hold(
        0.1, Elapsed(1.0)
    )
