"""Runs whose steps come from outside: the same samples as a protocol's, and safe endings."""

import subprocess
import sys

import numpy as np
import pytest

from smarig.app import SteppedRun
from smarig.core import LimitExceeded, RigFault, UsageError
from smarig.record import load_run
from smarig.rig import TwinSettings
from smarig.runner import Session


def test_its_samples_are_those_of_a_protocol(tmp_path):
    """The same holds, by the protocol step_currents and from outside, on the same wire with the same noise."""
    inputs_K = (20.0, 60.0, 40.0)
    with Session("one_wire_twin", seed=3) as session:
        session.run("step_currents", {"temperatures_K": inputs_K}, tmp_path / "protocol.run.sqlite")
    with SteppedRun("one_wire_twin", tmp_path / "outside.run.sqlite", twin=TwinSettings(seed=3)) as run:
        results = [run.hold_input(value).result() for value in inputs_K]
    ours, protocol = (load_run(tmp_path / f"{name}.run.sqlite") for name in ("outside", "protocol"))
    assert (ours.complete, ours.cause) == (True, "done")
    # It begins with one tick at zero current. In lock-step the position depends on the commands and the seed alone.
    settled = [step.position for step in protocol.steps if step.target in inputs_K][: len(inputs_K)]
    assert [r.position for r in results] == pytest.approx(settled, abs=2 * ours.info.output.per_count)
    assert [step.target for step in ours.steps] == list(inputs_K)


def test_what_the_limits_forbid_is_refused_and_the_run_continues(tmp_path):
    with SteppedRun("one_wire_twin", tmp_path / "a.run.sqlite") as run:
        with pytest.raises(LimitExceeded, match="Current 3 A is outside the limits"):
            run.hold(3.0)
        with pytest.raises(LimitExceeded, match="500 K is outside the rig's range"):
            run.hold_input(500.0)
        assert run.hold(0.3).result().verdict == "settled"
    assert load_run(tmp_path / "a.run.sqlite").cause == "done"


def test_a_step_larger_than_the_rate_is_ramped(tmp_path):
    rig = tmp_path / "slow.toml"
    rig.write_text('name = "slow"\nbase = "one_wire_twin"\nlimits.current_rate_A_per_s = 0.5\n')
    with SteppedRun(str(rig), tmp_path / "a.run.sqlite") as run:
        run.hold(0.6).result()
    steps_A = np.diff(load_run(tmp_path / "a.run.sqlite")["current_command_A"])
    assert steps_A.max() == pytest.approx(0.05)


def test_an_error_in_the_calling_program_ends_the_run_at_zero(tmp_path):
    out = tmp_path / "a.run.sqlite"
    run = SteppedRun("one_wire_twin", out)

    def failing():
        with run:
            run.hold(0.5).result()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        failing()
    record = load_run(out)
    assert record.cause == "stopped by ZeroDivisionError in the calling program"
    with pytest.raises(UsageError, match="over"):
        run.hold(0.1)


def test_a_rig_that_fails_is_told_to_whoever_waits(tmp_path):
    rig = tmp_path / "dead.toml"
    rig.write_text(
        'name = "dead"\nbase = "one_wire_serial"\nlinks.amplifier = { timeout_s = 0.05 }\n'
        f'simulator.faults = "{tmp_path / "faults.toml"}"\n'
    )
    (tmp_path / "faults.toml").write_text(
        '[[fault]]\nkind = "dead_line"\ndevice = "amplifier"\nfrom_s = 5.0\n'
    )
    run = SteppedRun(str(rig), tmp_path / "a.run.sqlite")
    run.start()
    with pytest.raises(RigFault, match="amplifier"):
        run.hold(0.5).result(60)
    with pytest.raises(RigFault, match="amplifier"):
        run.stop()
    with pytest.raises(RigFault):
        run.hold(0.1)


def test_a_file_that_exists_is_refused_at_the_start(tmp_path):
    (tmp_path / "a.run.sqlite").write_text("mine")
    with pytest.raises(UsageError, match="exists"):
        SteppedRun("one_wire_twin", tmp_path / "a.run.sqlite").start()
    assert (tmp_path / "a.run.sqlite").read_text() == "mine"


def test_a_program_that_ends_without_stop_closes_its_run(tmp_path):
    program = (
        "from smarig import SteppedRun\n"
        f"run = SteppedRun('one_wire_twin', {str(tmp_path / 'a.run.sqlite')!r})\n"
        "run.start()\nrun.hold_input(40).result()\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)
    record = load_run(tmp_path / "a.run.sqlite")
    assert record.cause == "the calling program ended"
    assert len(record.steps) == 1


@pytest.mark.parametrize("wrong", ["a", None, 1 + 2j, [1], True])
def test_what_is_no_number_is_one_sentence(wrong, tmp_path):
    with SteppedRun("one_wire_twin", tmp_path / "a.run.sqlite") as run:
        with pytest.raises(UsageError, match="is a number in A"):
            run.hold(wrong)
        with pytest.raises(UsageError, match="is a number in K"):
            run.hold_input(wrong)


def test_starting_twice_or_not_at_all_is_one_sentence(tmp_path):
    run = SteppedRun("one_wire_twin", tmp_path / "a.run.sqlite")
    with pytest.raises(UsageError, match="was not started. Use it in a with block"):
        run.hold(0.1)
    with run, pytest.raises(UsageError, match="was started before"):
        run.start()
