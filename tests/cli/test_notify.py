"""``--notify``: real commands that note what they are given, and commands that hang, fail or do not exist."""

import json
import os
import shlex
import sys
import threading
from pathlib import Path

import pytest

import smarig
from runner.interrupted import cut
from smarig.cli import notifier as notifier_module
from smarig.cli import notify_command as command_module
from smarig.cli import run as cli
from smarig.cli.notifier import NotificationListener, Notifier, Subject, message_of
from smarig.cli.notify import NotifyOptions, notified
from smarig.cli.notify_command import NotifyCommand
from smarig.core.command import StepResult, StepVerdict
from smarig.core.errors import RigFault, UsageError
from smarig.core.severity import Severity
from smarig.device.encoding.link_faults import Silent
from smarig.record import load_run
from smarig.runner.listener import CallbackListener
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session
from smarig.running import PanelRunInfo

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX commands")

PATIENCE_S = 120.0  # ends a test that has failed
NOTE = """
import json, os, sys
given = {"stdin": json.load(sys.stdin), "env": {k: v for k, v in os.environ.items() if k.startswith("SMARIG_")}}
with open(sys.argv[1], "a") as notes:
    notes.write(json.dumps(given) + "\\n")
"""
ALARMING = """
from smarig.protocols import Setup
from smarig.core import Elapsed, Hold, Mark, Protocol


def alarming(setup: Setup) -> Protocol:
    \"\"\"Report something of every severity.\"\"\"
    for severity in ("none", "minor", "major", "invalid"):
        yield Mark("It is " + severity + ".", {"severity": severity})
        yield Hold(0.0, Elapsed(2.0))
"""
SUBJECT = Subject("A7", "my_rig", "validation", "v.run.sqlite", "mm")
FACTS = PanelRunInfo("validation", "my_rig", "A7", "bench", False, "mm", 0.1, 21, 600.0, Path("v.run.sqlite"))


def python(*words):
    return shlex.join([sys.executable, *map(str, words)])


@pytest.fixture
def note(tmp_path):
    """A command that appends what it is given to a file."""
    (tmp_path / "note.py").write_text(NOTE)
    return python(tmp_path / "note.py", tmp_path / "notes.jsonl")


def notes(tmp_path):
    return [json.loads(line) for line in (tmp_path / "notes.jsonl").read_text().splitlines()]


def call(capsys, *words):
    status = cli([str(word) for word in words])
    return status, *capsys.readouterr()


VALIDATION = ("run", "validation", "--rig", "one_wire_twin", "--set", "points=2", "--quiet", "-o")


@pytest.mark.parametrize("command", ["run", "resume", "characterise", "regulate", "track"])
def test_whatever_carries_out_runs_has_the_options(capsys, command):
    text = " ".join(call(capsys, command, "--help")[1].split())
    assert "--notify COMMAND" in text
    assert "--notify-level [minor|major|invalid]" in text


def test_the_end_is_reported_with_all_fields(capsys, tmp_path, note):
    out = tmp_path / "v.run.sqlite"
    status, _, err = call(capsys, *VALIDATION, out, "--wire", "A7", "--notify", note)
    assert (status, err) == (0, "")
    (end,) = notes(tmp_path)
    assert end["stdin"].pop("time").startswith("2")
    assert end["stdin"] == {
        "wire": "A7",
        "rig": "one_wire_twin",
        "protocol": "validation",
        "run": str(out),
        "severity": "none",
        "kind": "end",
        "text": "Run of validation ended: done.",
        "cause": "done",
        "exit_status": 0,
    }
    given = {
        name: end["env"][f"SMARIG_{name}"] for name in ("TEXT", "SEVERITY", "KIND", "RUN", "CAUSE", "STATUS")
    }
    assert list(given.values()) == ["Run of validation ended: done.", "none", "end", str(out), "done", "0"]


@pytest.mark.parametrize(
    ("options", "reported"),
    [
        ((), ["major"]),  # invalid, of the same kind, comes within the minute
        (("--notify-level", "invalid"), ["invalid"]),
        (("--notify-level", "minor"), ["minor"]),
    ],
)
def test_events_are_reported_from_their_severity_on(capsys, tmp_path, note, options, reported):
    (tmp_path / "alarming.py").write_text(ALARMING)
    words = (
        "run",
        tmp_path / "alarming.py",
        "--rig",
        "one_wire_twin",
        "-o",
        tmp_path / "a.run.sqlite",
        "--quiet",
    )
    assert call(capsys, *words, "--notify", note, *options)[0] == 0
    *during, end = notes(tmp_path)
    assert [n["stdin"]["severity"] for n in during] == reported
    assert during[0]["stdin"]["text"] == f"It is {reported[0]}."
    assert (during[0]["stdin"]["exit_status"], during[0]["env"]["SMARIG_STATUS"]) == (None, "")
    assert during[0]["env"]["SMARIG_CAUSE"] == ""
    assert end["stdin"]["text"].endswith("ended: done. Highest severity before: invalid.")


@pytest.mark.parametrize(
    ("error", "severity"),
    [(RigFault("Struck by lightning."), "major"), (Silent("Nobody answers."), "invalid")],
)
def test_a_trip_and_a_lost_device_are_reported_at_the_end(
    capsys, tmp_path, monkeypatch, note, error, severity
):
    def fail(self, current_A, at_most=1):
        if self.settings.noise:  # not the preview
            raise error
        self.output_A = current_A
        return (self._advance(current_A),)

    monkeypatch.setattr("smarig.rig.twin.Twin.step", fail)
    assert call(capsys, *VALIDATION, tmp_path / "v.run.sqlite", "--notify", note)[0] == 3
    (end,) = notes(tmp_path)
    assert (end["stdin"]["severity"], end["stdin"]["exit_status"]) == (severity, 3)
    assert end["stdin"]["cause"] == str(error)


@pytest.mark.long("takes a second")
def test_a_resumption_and_settling_that_times_out_are_reported(capsys, tmp_path, note):
    settle = ("settle.window_s=2", "settle.timeout_s=3", "settle.band_counts=0.001")
    never = [word for pair in settle for word in ("--set", pair)]
    out = tmp_path / "whole.run.sqlite"
    assert call(capsys, *VALIDATION, out, *never, "--notify", note)[0] == 0
    first, *_, end = notes(tmp_path)
    assert (first["stdin"]["kind"], first["stdin"]["severity"]) == ("timed_out", "minor")
    assert first["stdin"]["text"].startswith("Step 1 (saturate) did not settle in time. It is at ")
    assert end["stdin"]["kind"] == "end"
    (tmp_path / "notes.jsonl").unlink()
    whole = smarig.run("validation", rig="one_wire_twin", out=tmp_path / "w.run.sqlite", points=3)
    killed = cut(whole.path, tmp_path / "killed.run.sqlite", 1700)
    assert call(capsys, "resume", killed, "--quiet", "--notify", note)[0] == 0
    assert [n["stdin"]["kind"] for n in notes(tmp_path)] == ["resumed", "end"]
    assert notes(tmp_path)[0]["stdin"]["run"] == str(killed)


def test_what_cannot_start_is_reported_with_its_wire_and_rig(capsys, tmp_path, monkeypatch, note):
    monkeypatch.setenv("SMARIG_LOCK_DIR", os.devnull)
    assert call(capsys, *VALIDATION, tmp_path / "v.run.sqlite", "--wire", "A7", "--notify", note)[0] == 2
    (end,) = notes(tmp_path)
    assert (end["stdin"]["wire"], end["stdin"]["rig"]) == ("A7", "one_wire_twin")
    assert "SMARIG_LOCK_DIR" in end["stdin"]["text"]


# --- commands that do not work ------------------------------------------------------------------------------


def test_a_missing_command_is_a_warning_at_the_start_and_at_the_end(capsys, tmp_path):
    out = tmp_path / "v.run.sqlite"
    status, _, err = call(capsys, *VALIDATION, out, "--notify", "no-such-program --now")
    assert status == 0
    assert err.splitlines() == [
        "Warning: --notify: there is no command 'no-such-program --now'. The run starts nevertheless.",
        "--notify: 'no-such-program --now' failed: No such file or directory.",
    ]
    assert load_run(out).cause == "done"


def test_a_command_that_cannot_be_read_is_refused_before_anything_moves(capsys, tmp_path):
    status, _, err = call(capsys, *VALIDATION, tmp_path / "v.run.sqlite", "--notify", "mail 'me")
    assert status == 2
    assert err.startswith("smarig: --notify: 'mail 'me' is not a command: ")
    assert not (tmp_path / "v.run.sqlite").exists()


def test_a_failure_is_an_event_of_the_run_and_a_warning(capsys, tmp_path):
    """The run goes on when the failure is known, so that it can be recorded."""
    control, failed, out = RunControl(), threading.Event(), tmp_path / "v.run.sqlite"
    report = control.report

    def reported(kind, text, *, level):
        report(kind, text, level=level)
        failed.set()

    control.report = reported
    with (
        notified(NotifyOptions("false"), control, SUBJECT) as watch,
        Session("one_wire_twin", control=control) as s,
    ):
        (listener,) = watch.listeners(FACTS)

        def at_50(sample, _step, _input_K):
            if sample.tick == 50:
                listener.event(5.0, "jump", "The encoder jumped.", level="error")
                assert failed.wait(PATIENCE_S)

        watched = [listener, CallbackListener(on_sample=at_50)]
        s.run("validation", {"points": "2"}, out, listeners=watched)
    (event,) = [e for e in load_run(out).events if e.kind == "notify"]
    assert (event.level, event.text) == ("warning", "--notify: 'false' failed: exit status 1.")
    assert capsys.readouterr().err == "--notify: 'false' failed 2 times; the last time: exit status 1.\n"


def test_the_failure_of_a_notification_is_not_notified():
    posted = []
    listener = listening(posted, least=Severity.MINOR)
    listener.event(0.0, "notify", "It failed.", level="warning")
    assert posted == []


def hanging(tmp_path):
    """A command that never ends, once it has written its number; with a child that would outlive it."""
    script = tmp_path / "hang.sh"
    script.write_text('sleep 600 & echo "$$ $!" > "$1.part"; mv "$1.part" "$1"; wait\n')
    return shlex.join(["sh", str(script), str(tmp_path / "numbers")])


def gone(number):
    """Whether a process has ended; a zombie has."""
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def eventually(condition):
    """Whether something that another process does has happened."""
    never = threading.Event()
    return any(condition() or never.wait(0.01) for _ in range(int(PATIENCE_S / 0.01)))


def ended(tmp_path):
    """Whether the hanging command and its child have ended."""
    return eventually(lambda: all(map(gone, (tmp_path / "numbers").read_text().split())))


needs_proc = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks at processes in /proc")


@needs_proc
def test_a_hanging_command_is_ended_with_its_children_after_its_time(tmp_path, monkeypatch):
    monkeypatch.setattr(command_module, "CALL_TIMEOUT_S", 3.0)
    failures, failed = [], threading.Event()
    notifier = Notifier(NotifyCommand(hanging(tmp_path)), lambda text: (failures.append(text), failed.set()))
    notifier.post(message_of(SUBJECT, "jump", Severity.MAJOR, "It jumped."))
    assert failed.wait(PATIENCE_S)
    assert failures[0].endswith("numbers' failed: it took longer than 3 s.")
    assert ended(tmp_path)
    notifier.close()


@needs_proc
def test_the_end_waits_for_no_hanging_command(tmp_path, monkeypatch):
    """What runs is ended with all its processes; what waits is counted."""
    notifier = Notifier(NotifyCommand(hanging(tmp_path)), lambda _: None)
    for _ in range(3):
        notifier.post(message_of(SUBJECT, "jump", Severity.MAJOR, "It jumped."))
    assert eventually((tmp_path / "numbers").exists)
    monkeypatch.setattr(notifier_module, "PENDING_S", 0.05)
    notifier.close()
    notifier._thread.join(PATIENCE_S)
    assert not notifier._thread.is_alive()
    assert notifier.failures == ["it was not finished at the end"]
    assert notifier.undelivered == 2
    assert ended(tmp_path)


def test_a_tick_never_waits_and_never_fails():
    """The command hangs until the last event was given; those that do not fit are dropped and counted."""
    release, delivered = threading.Event(), []

    class Slow:
        text = "slow"

        def deliver(self, message):
            assert release.wait(PATIENCE_S)
            delivered.append(message.text)
            return ""

        def stop(self):
            pass

    notifier = Notifier(Slow(), lambda _: None)
    for k in range(1000):
        notifier.post(message_of(SUBJECT, "jump", Severity.MAJOR, str(k)))
    assert 1000 - notifier_module.QUEUE - 1 <= notifier.undelivered <= 1000 - notifier_module.QUEUE
    release.set()
    notifier.close()
    assert delivered == [str(k) for k in range(1000 - notifier.undelivered)], "in order"


# --- what is worth a message --------------------------------------------------------------------------------


def listening(posted, least=Severity.MAJOR, clock=lambda: 0.0):
    class Kept:
        def post(self, message):
            posted.append(message.text)

    return NotificationListener(Kept(), SUBJECT, least, clock)


def test_a_kind_that_repeats_is_reported_once_a_minute():
    now, posted = [1000.0], []
    listener = listening(posted, clock=lambda: now[0])
    for k in range(600):
        now[0] = 1000.0 + k / 4
        listener.event(k / 10, "contradiction", f"{k}", level="warning")
    listener.event(0.0, "jump", "another kind", level="error")
    assert posted == ["0", "240", "480", "another kind"]


def test_steps_that_settle_are_no_news():
    posted = []
    listener = listening(posted)
    for verdict in (StepVerdict.SETTLED, StepVerdict.ELAPSED, StepVerdict.TIMED_OUT):
        listener.step(StepResult(4, verdict, 12.408, 264.0, 0.3, 250, 0.0, 60.0), branch="up", target=None)
    assert posted == ["Step 5 (up) did not settle in time. It is at +12.408 mm."]


@pytest.mark.parametrize(
    ("text", "shell"),
    [
        ("notify-send smarig", False),
        ("curl -sS --data-binary @- https://ntfy.sh/my-rig", False),
        ("'/opt/my tools/page' --to=me", False),
        ('mail -s "$SMARIG_TEXT" me', True),
        ("cat > note.json", True),
        ("HOST=a page", True),
        ("echo noise; exit 7", True),
    ],
)
def test_a_shell_runs_only_what_needs_one(text, shell):
    assert NotifyCommand(text).uses_shell is shell


def test_nothing_of_a_message_is_run(tmp_path, monkeypatch):
    """Texts come from files and devices; they are data, with and without a shell."""
    monkeypatch.chdir(tmp_path)
    text = "$(touch evil) `touch evil`; touch evil \x00 «ü»"
    for command in ('echo "$SMARIG_TEXT" > note.txt', f"{python('-c', 'import sys; sys.stdin.read()')}"):
        assert NotifyCommand(command).deliver(message_of(SUBJECT, "mark", Severity.MAJOR, text)) == ""
    assert (tmp_path / "note.txt").read_text().strip() == text.replace("\x00", "")
    assert [p.name for p in tmp_path.iterdir()] == ["note.txt"]


@pytest.mark.parametrize("text", ["", "  ", "mail 'me"])
def test_no_command_is_a_usage_error(text):
    with pytest.raises(UsageError, match="--notify"):
        NotifyCommand(text)
