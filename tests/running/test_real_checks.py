"""Checks of a rig at the command line, found and stopped from this process as runs are."""

import json
import os
import signal

import pytest

from running.started_run import started_run, waited
from smarig.core import UsageError
from smarig.running import collect_ended, runs_in_progress
from tests.running.runs import files

BENCH = 'name = "bench"\nbase = "one_wire_serial"\nwire = "check"\n[simulator]\nspeed = 5.0\n'
pytestmark = pytest.mark.skipif(os.name == "nt", reason="ptys and signals of POSIX")


@pytest.fixture
def rig(tmp_path):
    (tmp_path / "bench.toml").write_text(BENCH)
    return tmp_path


def found_check(process):
    """The announcement of a check that has begun to move the wire."""

    def found():
        assert process.poll() is None, process.communicate()
        return next((run for run in runs_in_progress() if run.info["pid"] == process.pid), None)

    check = waited(found, "the announcement of the check")
    while "+0.05 A" not in process.stderr.readline():
        assert process.poll() is None
    return check


@pytest.mark.long("takes two seconds")
def test_a_check_is_found_and_stopped_with_its_list(folder, rig):
    with started_run(rig, "check", "bench.toml", "--yes", "--json") as process:
        check = found_check(process)
        assert check.is_check
        assert {name: check.info[name] for name in ("protocol", "rig", "wire", "source", "out")} == {
            "protocol": "check",
            "rig": "bench",
            "wire": "check",
            "source": "bench",
            "out": "",
        }
        with pytest.raises(UsageError, match="can be asked to stop, not to pause"):
            check.ask("pause", "test bench")
        check.ask("stop", "test bench")
        out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    sentence = "The check was stopped by the operator (test bench). The current is at zero."
    assert err.splitlines()[-1] == f"smarig: {sentence}"
    checks = json.loads(out.splitlines()[0])["checks"]
    assert [(c["name"], c["passed"]) for c in checks] == [
        ("devices", True),
        ("at rest", True),
        ("rig", False),
    ]
    assert checks[-1]["seen"] == sentence
    assert not check.alive
    assert (runs_in_progress(), collect_ended(), files(folder)) == ((), (), [])


@pytest.mark.long("takes two seconds")
@pytest.mark.usefixtures("folder")
def test_a_request_and_a_signal_at_once_do_not_cut_the_shutdown_off(rig):
    """ "Stop everything" sends both, and a second signal must not interrupt what switches off."""
    with started_run(rig, "check", "bench.toml", "--yes") as process:
        check = found_check(process)
        check.ask("stop", "test bench")
        for _ in range(5):
            check.terminate()
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err.splitlines()[-1].endswith("The current is at zero.")


@pytest.mark.long("takes a second")
def test_a_killed_check_is_told_of_once(folder, rig):
    with started_run(rig, "check", "bench.toml", "--yes") as process:
        found_check(process)
        process.send_signal(signal.SIGKILL)
        process.wait()
        (ended,) = collect_ended()
        assert ended.sentence == f"The check of bench (process {process.pid}) ended without finishing."
        assert (collect_ended(), files(folder)) == ((), [])


@pytest.mark.long("takes three seconds")
@pytest.mark.usefixtures("folder")
def test_a_check_that_cannot_be_announced_is_made_and_says_so(rig):
    (rig / "no_folder").touch()
    with started_run(
        rig, "check", "one_wire_serial", "--json", SMARIG_RUNNING_DIR=str(rig / "no_folder")
    ) as process:
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "Other processes cannot see this check." in err
    assert all(check["passed"] for check in json.loads(out)["checks"])
