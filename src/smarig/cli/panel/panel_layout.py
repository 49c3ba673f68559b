"""The panel of a run as text: a few rows in a frame, for any width and height.

Every important state has a sign and a word in addition to its colour.
"""

from rich import box
from rich.console import RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from smarig.core import Severity
from smarig.running import RunStatus, SettlingProgress

NARROW = 96  # columns; below it the rows are shortened
_LABEL = 13  # columns of the labels
_FRAME = 4  # columns taken by the frame (rows: half of it)
_REAL_TIME_BAND = 0.1  # a speed factor this close to 1 counts as real time

# sign in a Unicode terminal, sign in any terminal, style
_SIGNS = {
    "running": ("●", "*", "bold cyan"),
    "paused": ("▮▮", "||", "bold yellow"),
    "stopped": ("■", "#", "bold magenta"),
    "fault": ("✖", "X", "bold red"),
    "refused": ("✖", "X", "bold yellow"),
    "minor": ("▲", "!", "yellow"),
    "major": ("✖", "X", "bold red"),
    "invalid": ("◆", "?", "bold red reverse"),
    "done": ("✔", "+", "bold cyan"),
}
_DROP_ORDER = (
    "event",
    "settling",
    "temperature",
    "keys",
    "position",
    "time",
    "current",
    "step",
)  # the first is removed first


def clock_text(seconds: float) -> str:
    """Hours, minutes, seconds.

    >>> clock_text(3725.4)
    '1:02:05'
    """
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def panel(status: RunStatus, width: int, height: int, *, plain: bool = False) -> RenderableType:
    """The run status in a frame. ``plain`` uses ASCII only. If there are few rows, the least important are
    left out."""
    rows = _rows(status, wide=width >= NARROW, plain=plain)
    inside = max(width - _FRAME - _LABEL, 10)
    lines = dict.fromkeys(rows, 1) | {"state": -(-rows["state"].cell_len // inside)}
    for label in _DROP_ORDER:
        if sum(lines[name] for name in rows) + _FRAME // 2 >= height:
            rows.pop(label, None)
    grid = Table.grid(padding=(0, 1))
    grid.add_column(width=_LABEL - 1, style="dim", no_wrap=True)
    grid.add_column(ratio=1)
    for label, value in rows.items():
        value.no_wrap = label != "state"
        value.overflow = "fold" if label == "state" else "ellipsis"
        grid.add_row(label, value)
    style = _SIGNS["fault"][2] if status.ending and status.ending.kind == "fault" else "none"
    frame = box.ASCII if plain else box.ROUNDED
    return Panel(grid, title=_title(status), title_align="left", box=frame, border_style=style, width=width)


def summary(status: RunStatus, *, plain: bool = False) -> Text:
    """The one line that remains after the run: protocol, progress and file."""
    run_info, ending = status.run_info, status.ending
    kind = ending.kind if ending else "running"
    if kind == "refused":
        text = _with_sign(kind, "NOT STARTED", plain)
        return text.append(f"{run_info.protocol} ({run_info.label}): no current has flowed", style="none")
    steps = status.done_steps + status.finished
    step_text = f"{steps} steps" if kind == "done" else f"{steps} of {run_info.steps} steps"
    grave = status.severity.reaches(Severity.MAJOR)  # no tick, although it ended as planned
    sign = status.severity if kind == "done" and grave else kind
    text = _with_sign(sign, "" if kind == "done" else (ending.word if ending else ""), plain)
    text.append(
        f"{run_info.protocol} ({run_info.label}): {step_text} in {clock_text(status.elapsed_s)}", style="none"
    )
    if ending and kind == "stopped":
        text.append(f", {ending.text}", style="none")
    if status.severity != Severity.NONE:
        text.append(f", highest severity {status.severity}", style="none")
    if lost := status.lost_samples:
        due = lost + status.samples
        text.append(f", {lost} of {due} samples lost ({100 * lost / due:.2g} %)", style="none")
    text.append(f": {run_info.out}", style="none")
    return text


def _title(status: RunStatus) -> Text:
    run_info = status.run_info
    place = f" · {run_info.place}" if run_info.place else ""
    title = Text(
        f" {run_info.protocol}{place} · {run_info.rig} · wire {run_info.wire} ",
        style="bold",
        overflow="ellipsis",
    )
    return Text.assemble((f" {run_info.label} ", "bold reverse"), title)


def _rows(status: RunStatus, *, wide: bool, plain: bool) -> dict[str, Text]:
    s, run_info = status.last_sample, status.run_info
    rows = {"state": _state(status, plain), "step": _step(status, wide, plain)}
    if s is not None:
        rows["current"] = Text(f"set {s.current_command_A:+.4f} A   measured {s.current_A:+.4f} A")
        counts = f"   ({s.counts:+d} counts)" if wide else ""
        rows["position"] = Text(f"{s.position:+.3f} {run_info.unit}{counts}")
        what = "T1 - T2, estimated" if run_info.two_wire else "above ambient, estimated"
        rows["temperature"] = Text(f"{status.input_K:+.1f} K   {what}")
    settling = status.settling
    if settling is not None:
        rows["settling"] = _settling(settling, wide, plain)
    rows["time"] = _time(status, wide, plain)
    if status.last_event is not None:
        rows["event"] = _event(status, plain)
    if status.keys and status.ending is None:
        rows["keys"] = Text("r resumes   s stops safely" if status.paused else "p pauses   s stops safely")
    return rows


def _state(status: RunStatus, plain: bool) -> Text:
    if status.ending is not None and status.ending.kind != "done":
        return _with_sign(status.ending.kind, f"{status.ending.word}:", plain).append(status.ending.text)
    if status.error is not None:
        return _with_sign("fault", "TRIP:", plain).append(status.error.text)
    if silent_s := status.silent_s:
        words = f"no sample for {silent_s:.0f} s, a device does not answer"
        return _with_sign("invalid", "WAITING:", plain).append(words)
    if status.stopping:
        return _with_sign("stopped", "STOPPING:", plain).append("the current goes to zero")
    if status.paused:
        return _with_sign("paused", "PAUSED:", plain).append("the current stays on, sampling continues")
    text = _with_sign("running", "running" if status.last_sample else "starting", plain)
    if status.severity == Severity.NONE:
        return text
    return text.append_text(Text("  highest severity ")).append_text(_severity(status.severity, plain))


def _severity(severity: Severity, plain: bool) -> Text:
    return _with_sign(severity, severity.upper(), plain)


def _with_sign(kind: str, word: str, plain: bool) -> Text:
    unicode_sign, ascii_sign, style = _SIGNS[kind]
    return Text(f"{ascii_sign if plain else unicode_sign} {word}{' ' if word else ''}", style=style)


def _step(status: RunStatus, wide: bool, plain: bool) -> Text:
    branch = f"   {status.branch}" if status.branch else ""
    target = f"   to {status.target_K:+.1f} K" if status.target_K is not None else ""
    text = Text(f"{status.step_number} of {status.run_info.steps}{branch}{target}")
    if wide:
        text.append(f"   {_bar(status.share, 20, plain)} {100 * status.share:.0f} %")
    return text


def _settling(at: SettlingProgress, wide: bool, plain: bool) -> Text:
    if at.band_counts is None:
        text = Text(f"holds for {at.min_time_left_s:.0f} s more")
    elif at.spread_counts is None:
        text = Text(f"settling, at least {at.min_time_left_s:.0f} s left")
    elif at.share < 1:
        text = Text(
            f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts, {at.min_time_left_s:.0f} s left"
        )
    elif at.spread_counts <= at.band_counts:  # while paused, or in the tick before the next step
        text = Text(f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts: settled")
    else:
        left = f", time-out in {clock_text(at.timeout_s)}" if wide else ""
        text = Text(f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts: still moving{left}")
    if wide:
        text.append(f"   {_bar(at.share, 12, plain)}")
    return text


def _time(status: RunStatus, wide: bool, plain: bool) -> Text:
    if status.ending is not None:
        return Text(f"{clock_text(status.elapsed_s)} elapsed")
    left = f"about {clock_text(status.left_s)} left" if status.left_s > 0 else "longer than expected"
    text = Text(f"{clock_text(status.elapsed_s)} elapsed   {left}")
    if wide and status.left_s > 0 and abs(status.speed_factor - 1) > _REAL_TIME_BAND:
        times = "x" if plain else "×"
        text.append(
            f"   ({clock_text(status.left_s / status.speed_factor)} of waiting, "
            f"at {status.speed_factor:.3g} {times} real time)"
        )
    return text


def _event(status: RunStatus, plain: bool) -> Text:
    entry = status.last_event
    assert entry is not None  # noqa: S101 - the caller checks it
    text = Text(f"{clock_text(status.since_s(entry.t_s))} {entry.kind}: {entry.text}")
    return text if entry.severity == Severity.NONE else _severity(entry.severity, plain).append(text)


def _bar(share: float, width: int, plain: bool) -> str:
    full, empty = "#-" if plain else "█░"
    filled = round(min(max(share, 0.0), 1.0) * width)
    return full * filled + empty * (width - filled)
