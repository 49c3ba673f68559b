"""The progress of a resumed run is that of the whole run, whatever command has resumed it."""

import signal

import pytest

from running.started_run import found_run, started_run, waited
from smarig.console.web.run_words import run_state
from smarig.record import load_run

TWIN = ("--rig", "one_wire_twin", "--speed", "50", "--quiet")
RUN = ("run", "validation", *TWIN, "--set", "points=4", "-o", "v.run.sqlite")


@pytest.mark.parametrize(
    "resume",
    [
        ("resume", "v.run.sqlite", *TWIN),
        pytest.param((*RUN, "--continue"), marks=pytest.mark.long("takes five seconds")),
    ],
)
@pytest.mark.usefixtures("folder")
def test_what_was_done_before_counts(resume, tmp_path):
    with started_run(tmp_path, *RUN) as process:
        run = found_run(process)
        waited(lambda: run.status().get("step_number", 0) >= 3, "the third step")
        process.send_signal(signal.SIGKILL)
        process.wait()
    done = [step for step in load_run(tmp_path / "v.run.sqlite").steps if not step.void]
    assert len(done) >= 2
    with started_run(tmp_path, *resume) as process:
        run = found_run(process)
        waited(lambda: run.status().get("branch") == "re-establish", "the way back")
        status, shown = run.status(), run_state(run)
    assert status["resumed"]
    assert status["step_number"] == len(done) + 1
    left_s = run.info["duration_s"] - sum(step.duration_s for step in done)
    assert status["left_s"] == pytest.approx(left_s, abs=2)
    assert shown["state"].startswith(f"Step {len(done) + 1} of 6: re-establish")
    assert "since it was resumed, " in shown["facts"]
