"""The panel of a running experiment as text: a few rows in a frame, for any width and height.

What must be seen has a sign and a word, not only a colour. Knows a situation; refuses to know terminals and threads.
"""

from rich import box
from rich.console import RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from smarig.cli._situation import Settling, Situation

NARROW = 96  # columns: below, rows say the needful only
_LABEL = 13  # columns of the labels
_FRAME = 4  # columns and (half of it) rows around the rows
_UNLIKE_1 = 0.1  # a pace that differs less is real time

# sign in a Unicode terminal, sign in any terminal, style
_SIGNS = {
    "running": ("●", "*", "bold cyan"),
    "paused": ("▮▮", "||", "bold yellow"),
    "stopped": ("■", "#", "bold magenta"),
    "fault": ("✖", "X", "bold red"),
    "warning": ("▲", "!", "yellow"),
    "done": ("✔", "+", "bold cyan"),
}
_SHED = (
    "event",
    "settling",
    "temperature",
    "keys",
    "position",
    "time",
    "current",
    "step",
)  # first to go first


def clock_text(seconds: float) -> str:
    """Hours, minutes, seconds.

    >>> clock_text(3725.4)
    '1:02:05'
    """
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def panel(now: Situation, width: int, height: int, *, plain: bool = False) -> RenderableType:
    """The situation in a frame; ``plain`` keeps to ASCII. Where rows are few, the least important ones go."""
    rows = _rows(now, wide=width >= NARROW, plain=plain)
    inside = max(width - _FRAME - _LABEL, 10)
    lines = dict.fromkeys(rows, 1) | {"state": -(-rows["state"].cell_len // inside)}
    for label in _SHED:
        if sum(lines[name] for name in rows) + _FRAME // 2 >= height:
            rows.pop(label, None)
    grid = Table.grid(padding=(0, 1))
    grid.add_column(width=_LABEL - 1, style="dim", no_wrap=True)
    grid.add_column(ratio=1)
    for label, value in rows.items():
        value.no_wrap = label != "state"
        value.overflow = "fold" if label == "state" else "ellipsis"
        grid.add_row(label, value)
    style = _SIGNS["fault"][2] if now.ending and now.ending.kind == "fault" else "none"
    frame = box.ASCII if plain else box.ROUNDED
    return Panel(grid, title=_title(now), title_align="left", box=frame, border_style=style, width=width)


def summary(now: Situation, *, plain: bool = False) -> Text:
    """The one line that stays: what was run, how far it came, where it is."""
    about, ending = now.about, now.ending
    kind = ending.kind if ending else "running"
    steps = about.done_steps + now.finished
    how = f"{steps} steps" if kind == "done" else f"{steps} of {about.steps} steps"
    text = _signed(kind, "" if kind == "done" else (ending.word if ending else ""), plain)
    text.append(f"{about.protocol} ({about.label}): {how} in {clock_text(now.gone_s)}", style="none")
    if ending and kind == "stopped":
        text.append(f", {ending.text}", style="none")
    text.append(f": {about.out}", style="none")
    return text


def _title(now: Situation) -> Text:
    about = now.about
    place = f" · {about.place}" if about.place else ""
    title = Text(
        f" {about.protocol}{place} · {about.rig} · wire {about.wire} ", style="bold", overflow="ellipsis"
    )
    return Text.assemble((f" {about.label} ", "bold reverse"), title)


def _rows(now: Situation, *, wide: bool, plain: bool) -> dict[str, Text]:
    s, about = now.sample_now, now.about
    rows = {"state": _state(now, plain), "step": _step(now, wide, plain)}
    if s is not None:
        rows["current"] = Text(f"set {s.current_command_A:+.4f} A   measured {s.current_A:+.4f} A")
        counts = f"   ({s.counts:+d} counts)" if wide else ""
        rows["position"] = Text(f"{s.position:+.3f} {about.unit}{counts}")
        what = "T1 - T2, estimated" if about.two_wire else "above ambient, estimated"
        rows["temperature"] = Text(f"{now.input_K:+.1f} K   {what}")
    settling = now.settling
    if settling is not None:
        rows["settling"] = _settling(settling, wide, plain)
    rows["time"] = _time(now, wide, plain)
    if now.event_now is not None:
        rows["event"] = _event(now, plain)
    if now.keys and now.ending is None:
        rows["keys"] = Text("r goes on   s stops safely" if now.paused else "p pauses   s stops safely")
    return rows


def _state(now: Situation, plain: bool) -> Text:
    if now.ending is not None and now.ending.kind != "done":
        return _signed(now.ending.kind, f"{now.ending.word}:", plain).append(now.ending.text)
    if now.error is not None:
        return _signed("fault", "TRIP:", plain).append(now.error.text)
    if now.stopping:
        return _signed("stopped", "STOPPING:", plain).append("the current goes to zero")
    if now.paused:
        return _signed("paused", "PAUSED:", plain).append("the current stays, sampling goes on")
    return _signed("running", "running" if now.sample_now else "starting", plain)


def _signed(kind: str, word: str, plain: bool) -> Text:
    unicode_sign, ascii_sign, style = _SIGNS[kind]
    return Text(f"{ascii_sign if plain else unicode_sign} {word}{' ' if word else ''}", style=style)


def _step(now: Situation, wide: bool, plain: bool) -> Text:
    branch = f"   {now.branch}" if now.branch else ""
    target = f"   to {now.target_K:+.1f} K" if now.target_K is not None else ""
    text = Text(f"{now.step_number} of {now.about.steps}{branch}{target}")
    if wide:
        text.append(f"   {_bar(now.share, 20, plain)} {100 * now.share:.0f} %")
    return text


def _settling(at: Settling, wide: bool, plain: bool) -> Text:
    if at.band_counts is None:
        text = Text(f"holds {at.soonest_s:.0f} s more")
    elif at.spread_counts is None:
        text = Text(f"on its way, {at.soonest_s:.0f} s to go at least")
    elif at.share < 1:
        text = Text(
            f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts, {at.soonest_s:.0f} s to go"
        )
    elif at.spread_counts <= at.band_counts:  # while paused, or in the tick before the next step
        text = Text(f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts: stands still")
    else:
        left = f", gives up in {clock_text(at.timeout_s)}" if wide else ""
        text = Text(f"spread {at.spread_counts:.2f} of {at.band_counts:.2f} counts: moves still{left}")
    if wide:
        text.append(f"   {_bar(at.share, 12, plain)}")
    return text


def _time(now: Situation, wide: bool, plain: bool) -> Text:
    if now.ending is not None:
        return Text(f"{clock_text(now.gone_s)} gone")
    left = f"about {clock_text(now.left_s)} left" if now.left_s > 0 else "longer than expected"
    text = Text(f"{clock_text(now.gone_s)} gone   {left}")
    if wide and now.left_s > 0 and abs(now.pace - 1) > _UNLIKE_1:
        times = "x" if plain else "×"
        text.append(f"   ({clock_text(now.left_s / now.pace)} to wait, at {now.pace:.3g} {times} real time)")
    return text


def _event(now: Situation, plain: bool) -> Text:
    told = now.event_now
    assert told is not None  # noqa: S101 - asked before
    text = Text(f"{clock_text(now.since_s(told.t_s))} {told.kind}: {told.text}")
    if told.level not in ("warning", "error"):
        return text
    return _signed("fault" if told.level == "error" else "warning", told.level.upper(), plain).append(text)


def _bar(share: float, width: int, plain: bool) -> str:
    full, empty = "#-" if plain else "█░"
    filled = round(min(max(share, 0.0), 1.0) * width)
    return full * filled + empty * (width - filled)
