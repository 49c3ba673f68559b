"""The panel as text: its content at any width and height, without colours and without Unicode."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from smarig.cli.panel.panel_layout import panel, summary
from smarig.config import load_rig
from smarig.core.command import Elapsed, Hold, Settled, StepResult, StepVerdict, Waveform
from smarig.core.errors import Interrupted, LimitExceeded, StorageError
from smarig.core.sample import NAN, Sample
from smarig.device.encoding.link_faults import Silent
from smarig.record import load_run
from smarig.runner.preview import Preview
from smarig.runner.run_control import RunControl
from smarig.runner.session import Session
from smarig.runner.settling_detection import SettleWindow
from smarig.running import PanelRunInfo, RunStatus, run_info

RUN_INFO = PanelRunInfo(
    "validation", "one_wire_serial", "A7", "bench", False, "mm", 0.1, 21, 600.0, Path("v.run.sqlite")
)


def at(t_s, counts=264, current_A=0.513):
    return Sample(round(t_s * 10), t_s, 0.5130, current_A, 2.4, NAN, counts, counts * 0.047, 22.0, 0)


def result(index):
    return StepResult(index, StepVerdict.SETTLED, 1.0, 20.0, 0.3, 250, 0.0, 60.0)


def fed(counts, until=None, **options):
    """A situation in its second step, whose samples had these counts."""
    control = options.pop("control", RunControl())
    status = RunStatus(RUN_INFO, control, clock=options.pop("clock", lambda: 0.0), **options)
    status.step(result(0), branch="saturate", target=0.0)
    hold = Hold(0.5130, until or Settled(), target=102.3, branch="up")
    window = SettleWindow(hold.until, 0.1)
    status.begin(1, hold, window)
    for k, c in enumerate(counts):
        window.add(c)
        status.sample(at(60.1 + k / 10, c), 1, 86.2)
    return status


def shown(status, width=110, height=30, plain=False):
    out = StringIO()
    console = Console(file=out, width=width, height=height, color_system=None, force_terminal=False)
    console.print(panel(status, width, height, plain=plain))
    return out.getvalue()


def test_the_panel_shows_all_status_values():
    status = fed([264] * 100, keys=True)
    status.event(61.0, "mark", "descending branch 3")
    text = shown(status)
    for part in (
        "BENCH", "validation", "one_wire_serial", "wire A7", "2 of 21", "up", "+102.3 K", "set +0.5130 A",
        "measured +0.5130 A", "+12.408 mm", "+264 counts", "+86.2 K", "estimated", "spread 0.00 of 1.00 counts",
        "15 s left", "0:00:10 elapsed", "0:09:50 left", "mark: descending branch 3", "p pauses", "s stops safely",
    ):  # fmt: skip
        assert part in text, part


@pytest.mark.parametrize(("silent_s", "says"), [(1.9, False), (4.0, True)])
def test_a_device_that_does_not_answer_is_named_within_seconds(silent_s, says):
    now = [100.0]
    status = fed([264] * 100, clock=lambda: now[0])
    now[0] += silent_s
    assert ("no sample for 4 s, a device does not answer" in shown(status)) == says
    status.sample(at(80.0), 1, 86.2)
    assert "does not answer" not in shown(status), "it answers again"


def test_a_run_that_is_only_being_closed_waits_for_no_device():
    now = [100.0]
    status = fed([264] * 100, clock=lambda: now[0])
    for k in range(1, RUN_INFO.steps):
        status.step(result(k), branch="up", target=0.0)
    now[0] += 10.0
    assert "does not answer" not in shown(status)


def test_an_unsettled_wire_shows_its_spread_and_the_timeout():
    status = fed([k // 40 for k in range(300)])  # a quarter of a count a second
    assert "still moving, time-out in 0:09:30" in shown(status)
    assert f"spread {status.settling.spread_counts:.2f} of 1.00" in shown(status)
    assert status.settling.spread_counts > 5


def test_holds_and_profiles_that_just_last_count_down():
    status = fed([0] * 20, Elapsed(30.0))
    assert "holds for 28 s more" in shown(status)
    profile = Waveform((0.1,) * 50, 0.2)
    status.begin(2, profile, SettleWindow(Elapsed(10.0), 0.1))
    assert "holds for 10 s more" in shown(status)


@pytest.mark.parametrize("width", [40, 60, 80, 95, 96, 140])
def test_no_line_is_wider_than_the_terminal_and_nothing_that_matters_is_cut(width):
    control = RunControl()
    status = fed([264] * 300, keys=True, control=control, clock=iter([0.0] + [10.0] * 999).__next__)
    control.paused = True
    status.event(62.0, "paused", "Paused by the operator: " + "long " * 40)
    text = shown(status, width)
    assert {len(line) for line in text.splitlines()} == {width}
    assert "PAUSED" in text
    if width >= 60:
        parts = ("2 of 21", "set +0.5130 A   measured +0.5130 A", "of 1.00 counts", "left", "s stops safely")
        assert all(part in text for part in parts), text


@pytest.mark.parametrize("height", range(4, 13))
def test_a_short_terminal_keeps_state_and_step(height):
    text = shown(fed([264] * 100, keys=True), 80, height)
    assert len(text.splitlines()) <= height
    assert "running" in text
    assert ("2 of 21" in text) is (height >= 5)


def test_a_trip_is_a_sign_and_a_word_and_the_step_it_came_in():
    status = fed([264] * 10, keys=True)
    status.event(61.0, "resistance", "The wire has 0.2 ohm.", level="error")
    assert "✖ TRIP: The wire has 0.2 ohm." in shown(status)
    status.end(
        LimitExceeded(f"The wire has 0.2 ohm. {'x' * 90} The current is at zero. " + "So be it. " * 20)
    )
    text = shown(status, 60)
    assert text.count("x") == 90  # folded, not cut
    assert "TRIP: The wire has 0.2 ohm." in text
    assert text.count("So") == 20
    assert "2 of 21" in text
    assert "s stops safely" not in text
    line = "✖ TRIP validation (BENCH): 1 of 21 steps in 0:00:01, highest severity major: v.run.sqlite"
    assert summary(status).plain == line


def test_a_warning_is_a_sign_and_a_word_too():
    status = fed([264] * 10)
    status.event(61.0, "history", "Not kept.", level="warning")
    assert "▲ MINOR 0:00:01 history: Not kept." in shown(status)
    assert "running" in shown(status)


def test_the_highest_severity_stays_while_lesser_events_come_and_go():
    status = fed([264] * 10)
    assert "severity" not in shown(status)
    status.event(61.0, "contradiction", "It holds 1 A.", level="warning")
    status.event(62.0, "history", "Not kept.", level="warning")
    status.event(63.0, "mark", "branch 3")
    assert "running   highest severity ◆ INVALID" in shown(status)
    assert "running   highest severity ? INVALID" in shown(status, plain=True)
    assert "0:00:03 mark: branch 3" in shown(status)
    status.end(None)
    assert summary(status).plain.endswith(", highest severity invalid: v.run.sqlite")


@pytest.mark.parametrize(
    ("kind", "level", "sign"),
    [
        ("still_on", "error", "◆ "),
        ("contradiction", "warning", "◆ "),
        ("resistance", "error", "✖ "),
        ("history", "warning", "✔ "),
    ],
)
def test_a_run_with_a_grave_event_gets_no_tick(kind, level, sign):
    status = fed([264] * 10)
    status.event(61.0, kind, "It may be on.", level=level)
    status.end(None)
    assert summary(status).plain.startswith(f"{sign}validation (BENCH): 1 steps")


def test_the_summary_counts_the_samples_that_were_lost():
    status = fed([264] * 5)
    for tick in (610, 611, 615, 3, 4):  # three are missing; the device begins again
        status.sample(at(tick / 10), 1, 86.2)
    status.end(None)
    lost = 610 - 605 - 1 + 3
    assert f", {lost} of {10 + lost} samples lost (41 %): v.run.sqlite" in summary(status).plain
    assert "lost" not in summary(fed([264] * 5)).plain


def test_a_lost_device_is_invalid_and_a_stop_is_minor():
    for error, severity in ((Silent("Nobody answers."), "invalid"), (Interrupted("enough"), "minor")):
        status = fed([264] * 10)
        status.end(error)
        assert f", highest severity {severity}: " in summary(status).plain


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (None, "✔ validation (BENCH): 1 steps in 0:00:01"),
        (Interrupted("stopped by the operator (key s)"), "■ STOPPED validation (BENCH): 1 of 21 steps"),
        (Silent("Nobody answers."), "✖ FAULT validation (BENCH)"),
        (RuntimeError(), "✖ FAULT validation (BENCH)"),
    ],
)
def test_the_summary_line_states_how_the_run_ended(error, words):
    status = fed([264] * 10)
    status.end(error)
    line = summary(status).plain
    assert line.startswith(words), line
    assert line.endswith("v.run.sqlite")


def test_what_is_refused_before_the_first_sample_is_no_fault():
    status = RunStatus(RUN_INFO)
    status.end(StorageError("The disk is full."))
    assert summary(status).plain == "✖ NOT STARTED validation (BENCH): no current has flowed"
    assert status.severity == "none"
    for status, error in (
        (fed([264] * 10), StorageError("full")),
        (RunStatus(RUN_INFO), LimitExceeded("hot")),
    ):
        status.end(error)
        assert status.ending.kind == "fault"


def test_without_unicode_everything_is_ascii():
    status = fed([264] * 100, keys=True, clock=iter([0.0] + [10.0] * 999).__next__)
    assert "×" not in shown(status, plain=True)
    for kind, paused in (("info", True), ("warning", False), ("error", False)):
        status.event(61.0, "kind", "text", level=kind)
        status._control.paused = paused
        text = shown(status, plain=True).replace("·", "")
        assert text.isascii(), text


def test_time_left_accounts_for_pauses_and_resumed_runs():
    control = RunControl()
    status = RunStatus(RUN_INFO, control, clock=lambda: 0.0)
    status.sample(at(100.1), 0, 0.0)
    status.sample(at(200.0), 0, 0.0)
    assert status.left_s == pytest.approx(500.0)
    control.paused = True
    for k in range(1, 101):
        status.sample(at(200.0 + k / 10), 0, 0.0)
    assert status.elapsed_s == pytest.approx(110.0)
    assert status.left_s == pytest.approx(500.0)  # what is paused is not worked off
    half = PanelRunInfo(**{**RUN_INFO.__dict__, "done_steps": 10, "done_s": 300.0})
    later = RunStatus(half, clock=lambda: 0.0)
    later.sample(at(10.0), 0, 0.0)
    assert later.left_s == pytest.approx(299.9)
    later.step(result(30), branch="re-establish", target=None)
    assert later.step_number == 11
    later.step(result(31), branch="up", target=1.0)
    assert later.step_number == 12


def test_the_way_back_of_a_resumed_run_is_no_progress():
    status = RunStatus(RUN_INFO, clock=lambda: 0.0)
    status.event(100.0, "resumed", "text", done_steps=10, done_s=300.0)
    status.begin(30, Hold(0.0, Elapsed(10.0), None, "re-establish"), None)
    for k in range(1, 101):
        status.sample(at(100.0 + k / 10), 30, 0.0)
    assert status.elapsed_s == pytest.approx(10.0)
    assert status.left_s == pytest.approx(300.0)
    status.begin(31, Hold(0.5, Elapsed(10.0), None, "up"), None)
    for k in range(101, 151):
        status.sample(at(100.0 + k / 10), 31, 0.0)
    assert status.left_s == pytest.approx(295.0)
    status.event(200.0, "resumed", "from the start", done_steps=0, done_s=0.0)
    assert status.step_number == 1


def test_data_of_a_twin_are_labelled_as_such_over_any_link():
    cost = Preview("validation", 60.0, 3, 1.0, 100.0, 0, 1000)
    for rig, source in (("one_wire_serial", "twin"), ("two_wire_twin", "simulation")):
        found = run_info(load_rig(rig), cost, Path("x"), wire="w", source=source)
        assert source.upper() in shown(RunStatus(found))
        assert found.two_wire is rig.startswith("two")


def test_the_runner_announces_each_step_and_its_settling_window(tmp_path):
    progress_seen = []

    class Eye(RunStatus):
        def sample(self, s, step, input_value):
            super().sample(s, step, input_value)
            progress_seen.append(
                (self.branch, self.target_K, self.settling.share, self.settling.spread_counts)
            )

    with Session("one_wire_twin", seed=1) as session:
        status = Eye(RUN_INFO)
        session.run("validation", {"points": "2"}, tmp_path / "v.run.sqlite", listeners=[status])
    steps = load_run(tmp_path / "v.run.sqlite").steps
    assert list(dict.fromkeys((b, t) for b, t, *_ in progress_seen)) == list(
        dict.fromkeys((s.branch, s.target) for s in steps)
    )
    assert {round(share * 25) for _, _, share, _ in progress_seen} == set(range(26))
    last = [spread for *_, share, spread in progress_seen if share == 1]
    assert len(last) == len(steps)
    assert all(0 < spread <= 1.0 for spread in last)  # within the band: settled
    assert status.finished == len(steps) == 4


def test_the_speed_factor_of_a_fast_twin_gives_the_waiting_time():
    times = iter([0.0, *[10.0] * 50])
    status = RunStatus(RUN_INFO, clock=lambda: next(times))
    status.sample(at(0.1), 0, 0.0)
    status.sample(at(200.0), 0, 0.0)
    assert "0:00:20 of waiting, at 20 × real time" in shown(status)
