"""stderr without the panel: a few lines for people, JSON lines for programs, nothing with --quiet."""

import json
import os
import re
import threading
from pathlib import Path

import pytest

from running.made import sample
from smarig.cli import run
from smarig.cli.panel.log_lines import JsonLogLines, LogLines, SummaryLine, dropped_lines_json
from smarig.cli.panel.terminal import LineWriter
from smarig.core.command import StepResult, StepVerdict
from smarig.core.errors import LimitExceeded
from smarig.record import load_run
from smarig.running import PanelRunInfo, RunStatus

RUN_INFO = PanelRunInfo(
    "validation", "one_wire_twin", "w", "twin", False, "mm", 0.1, 2, 60.0, Path("v.run.sqlite")
)
THREE = ["run", "validation", "--rig", "one_wire_twin", "--set", "points=3", "-o"]


def call(capfd, *arguments):
    status = run([str(a) for a in arguments])
    return status, *capfd.readouterr()


def spoken(display_type, happen):
    """The lines that a face writes while something happens, or ends by an error."""
    read, write = os.pipe()
    terminal = _Pipe(write)
    with os.fdopen(read, encoding="utf-8") as lines:
        with display_type(RunStatus(RUN_INFO, clock=lambda: 0.0), terminal) as listener:
            happen(listener)
        return lines.read().splitlines()


class _Pipe:
    """A terminal's place, over a pipe that is read afterwards."""

    plain = False

    def __init__(self, file):
        self._file = file

    def write(self, text):
        os.write(self._file, text.encode())

    def close(self):
        os.close(self._file)


def test_a_pipe_gets_one_line_per_run(capfd, tmp_path):
    out = tmp_path / "v.run.sqlite"
    status, text, err = call(capfd, *THREE, out)
    assert status == 0
    assert text.startswith("Run(validation")
    assert re.fullmatch(r"✔ validation \(TWIN\): 5 steps in 0:05:\d\d: .*v\.run\.sqlite\n", err)


def test_a_long_run_shows_that_it_is_alive_and_its_alarms():
    now = [0.0]
    result = StepResult(0, StepVerdict.SETTLED, 1.0, 20.0, 0.3, 9, 0.0, 60.0)

    def happen(listener):
        for k in range(40):
            now[0] = 60.0 * k
            listener.step(result, branch="up", target=None)
            listener.event(60.0 * k, "retried", "Asked again.", level="warning")
            listener.event(60.0 * k, "mark", "Here.")

    lines = spoken(lambda status, terminal: SummaryLine(status, terminal, clock=lambda: now[0]), happen)
    assert sum(bool(re.match(r"validation: step \d+ of 2, about .* left$", line)) for line in lines) == 3
    assert sum("MINOR retried: Asked again." in line for line in lines) == 1
    assert len(lines) == 5


def test_a_sweep_of_hours_shows_that_it_is_alive_within_its_step():
    now = [0.0]

    def happen(listener):
        for k in range(40):
            now[0] = 60.0 * k
            listener.sample(sample(k), 0, 0.0)

    lines = spoken(lambda status, terminal: SummaryLine(status, terminal, clock=lambda: now[0]), happen)
    assert sum(bool(re.match(r"validation: step \d+ of 2, about .* left$", line)) for line in lines) == 3


def test_log_lines_are_start_steps_and_end():
    result = StepResult(0, StepVerdict.SETTLED, 1.0, 20.0, 0.3, 9, 0.0, 60.0)

    def happen(listener):
        listener.step(result, branch="up", target=3.0)
        listener.step(result, branch="down", target=None)

    lines = spoken(LogLines, happen)
    assert lines[0].startswith("validation on one_wire_twin (TWIN), wire w: 2 steps")
    assert "up to +3.0 K: settled at +1.000 mm" in lines[1]
    assert len(lines) == 4


def test_json_lines_are_the_record_as_it_happens(capfd, tmp_path):
    out = tmp_path / "v.run.sqlite"
    status, text, err = call(capfd, *THREE, out, "--json")
    assert status == 0
    assert json.loads(text)["runs"][0]["steps"] == 5
    objects = [json.loads(line) for line in err.splitlines()]
    assert all(len(line) == 1 and set(line) <= {"step", "event"} for line in objects)
    events = [line["event"] for line in objects if "event" in line]
    assert [e["kind"] for e in events] == ["start", "mark", "end"]
    assert events[0]["data"]["source"] == "twin"
    recorded = load_run(out).steps
    steps = [line["step"] for line in objects if "step" in line]
    assert len(steps) == len(recorded) == 5
    for reported, kept in zip(steps, recorded, strict=True):
        for name in ("index", "branch", "target", "t_start_s", "t_end_s", "verdict", "position", "n"):
            assert reported[name] == getattr(kept, name), name
    assert [s["number"] for s in steps] == [1, 2, 3, 4, 5]


def test_quiet_prints_nothing(capfd, tmp_path):
    status, _, err = call(capfd, *THREE, tmp_path / "v.run.sqlite", "--quiet")
    assert status == 0
    assert err == ""


@pytest.mark.parametrize("command", ["run", "resume", "characterise"])
def test_help_describes_the_stream(capfd, command):
    _, text, _ = call(capfd, command, "--help")
    assert '{"event": …}' in " ".join(text.split())


def test_events_that_repeat_are_counted_not_repeated():
    def happen(listener):
        for k in range(500):
            listener.event(k / 10, "retried", "Asked again.", level="warning")
        listener.event(50.0, "mark", "Here.")
        listener.step(
            StepResult(0, StepVerdict.TIMED_OUT, 1.0, 20.0, 0.3, 9, 0.0, 60.0), branch="up", target=None
        )
        listener.event(60.0, "retried", "Asked again.", level="warning")

    lines = spoken(LogLines, happen)
    assert sum("MINOR retried: Asked again." in line for line in lines) == 2
    assert sum("499 more 'retried'" in line for line in lines) == 1
    assert len(lines) == 6
    assert len(spoken(JsonLogLines, happen)) == 505


def test_a_fault_ends_the_lines_with_its_sentence():
    def happen(_):
        raise LimitExceeded("Too hot.")

    ended = []

    def caught(listener):
        ended.append(listener)
        happen(listener)

    read, write = os.pipe()
    with pytest.raises(LimitExceeded), JsonLogLines(RunStatus(RUN_INFO), _Pipe(write)) as listener:
        caught(listener)
    with os.fdopen(read, encoding="utf-8") as lines:
        last = json.loads(lines.read().splitlines()[-1])["event"]
    assert (last["kind"], last["level"], last["text"]) == ("end", "error", "Run ended: Too hot.")
    assert (last["severity"], last["data"]["highest_severity"]) == ("major", "major")


def test_every_event_has_its_severity():
    def happen(listener):
        listener.event(1.0, "mark", "Here.")
        listener.event(2.0, "still_on", "It may still heat.", level="warning")
        listener.event(3.0, "history", "Not kept.", level="warning")

    events = [json.loads(line)["event"] for line in spoken(JsonLogLines, happen)]
    assert [e["severity"] for e in events] == ["none", "none", "invalid", "minor", "none"]
    assert events[-1]["data"]["highest_severity"] == "invalid"
    assert json.loads(dropped_lines_json(3))["event"]["severity"] == "minor", "the record lacks nothing"
    lines = spoken(LogLines, happen)
    assert any("INVALID still_on: It may" in line for line in lines)
    assert lines[-1].endswith("highest severity invalid: v.run.sqlite")


def test_nan_is_null_in_json_lines():
    def happen(listener):
        nothing = StepResult(0, StepVerdict.ELAPSED, float("nan"), float("nan"), 0.0, 0, 0.0, 60.0)
        listener.step(nothing, branch="", target=None)

    assert '"position": null' in spoken(JsonLogLines, happen)[1]


def test_a_reader_who_stops_costs_lines_not_time():
    """The writer accepts more lines than fit, drops those that are not read, and reports their number."""
    taken, hear, caught_up, heard = threading.Event(), threading.Event(), threading.Event(), []

    class Deaf:
        def write(self, text):
            taken.set()
            hear.wait()
            heard.append(text.strip())
            if text == "2000\n":
                caught_up.set()

        def close(self):
            heard.append("closed")

    writer = LineWriter(Deaf(), lambda n: f"{n} lost")
    writer.put("0")
    taken.wait()
    for k in range(1, 10_000):
        writer.put(str(k))
    hear.set()
    assert caught_up.wait(60)
    writer.put("again")
    writer.close()
    assert (
        json.loads(dropped_lines_json(7999))["event"]["text"]
        == "7999 lines were dropped because they were not read in time."
    )
    assert heard == [*map(str, range(2001)), "7999 lost", "again", "closed"]
