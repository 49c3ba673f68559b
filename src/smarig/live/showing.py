"""Puts the live view together: server, drawer, pump and viewer, opened and ended in the right order.

A view that cannot be opened is told before a run begins; one that fails later never stops it.
"""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from smarig.live.drawer import Drawer
from smarig.live.predicted import Memory, Prediction
from smarig.live.pump import Pump
from smarig.live.replaying import batches, replay
from smarig.live.seen import Watcher
from smarig.live.subject import Subject, of_run
from smarig.live.viewer import WEB_REMARK, Viewer, address, free_port, web_page
from smarig.preisach.everett import Everett
from smarig.record import Run

if TYPE_CHECKING:
    from smarig.live.screen import Screen

SERVED = "512MiB"  # of what was shown, for viewers that come later; the oldest goes first
LOOK_S = 0.3  # between looks whether the viewer is still there
Say = Callable[[str], None]


@contextmanager
def shown(
    subject: Subject,
    predictions: Sequence[Prediction] = (),
    hysteresis: Everett | None = None,
    *,
    web: bool = False,
    viewer: bool = True,
    port: int = 0,
    linger: bool = False,
    say: Say = print,
) -> Iterator[Watcher]:
    """A listener for the runner, with a viewer that ends with us; ``viewer`` False serves only, at ``port``.

    ``linger``: after a run that ended well, wait until the viewer is closed.
    """
    port = free_port(port)
    screen, drawer = _prepared(subject, predictions, hysteresis, replayed=False, port=port)
    opened = _viewer(port, web, say) if viewer else None
    pump = Pump(drawer.draw)
    try:
        yield Watcher(pump)
        if linger and opened is not None:
            screen.flush()
            _outstay(opened, say)
    finally:
        told = pump.close()
        if pump.dropped:
            say(
                f"The live view could not keep up: {pump.dropped} items were not shown (the record has them all)."
            )
        if not told:
            say(f"The live view ended before the run did{f': {pump.failure}' if pump.failure else ''}.")
        if opened is not None:
            _said_why(opened, say)
            opened.close()
        if told:
            with suppress(Exception):  # whatever a viewer's library says at its end is no matter of the run
                screen.close()


def view(
    run: Run,
    predictions: Sequence[Prediction] = (),
    hysteresis: Everett | None = None,
    *,
    web: bool = False,
    speed: float = 0.0,
    say: Say = print,
) -> None:
    """Show a recorded run until its viewer is closed (in a browser: until interrupted)."""
    port = free_port()
    screen, drawer = _prepared(of_run(run), predictions, hysteresis, replayed=not speed, port=port)
    opened = _viewer(port, web, say)
    never = threading.Event()

    def wait(seconds: float) -> bool:
        return never.wait(seconds) or not opened.running

    try:
        replay(run, drawer.draw, speed, wait, time.monotonic)
        screen.flush()
        _outstay(opened, say)
    finally:
        _said_why(opened, say)
        opened.close()
        screen.close()


def save(
    run: Run, path: Path, predictions: Sequence[Prediction] = (), hysteresis: Everett | None = None
) -> None:
    """A recorded run as an .rrd file with its layout, in big batches: compact, and opened by any viewer."""
    screen, drawer = _prepared(of_run(run), predictions, hysteresis, replayed=True, path=path)
    for batch in batches(run):
        drawer.draw(batch)
    screen.close()


def _prepared(
    subject: Subject,
    predictions: Sequence[Prediction],
    hysteresis: Everett | None,
    *,
    replayed: bool,
    port: int = 0,
    path: Path | None = None,
) -> tuple["Screen", Drawer]:
    """A screen with everything on it that is there before the first sample.

    A twin without a given model is predicted by the surface its actuator file names.
    """
    # rerun takes a second and a hundred megabytes: only where it is wanted
    from smarig.live.screen import Screen

    if not predictions and subject.own is not None:
        predictions = [Prediction("the rig's own surface", Memory(subject.own, subject.initial))]
    screen = Screen(f"{subject.label} · {subject.title}" if subject.label else subject.title)
    if path is not None:
        screen.save(path)
    else:
        screen.serve(port, SERVED)
    drawer = Drawer(subject, screen.show, predictions, hysteresis or subject.own)
    screen.arrange(drawer.layout, replay=replayed)
    screen.show(drawer.opening())
    return screen, drawer


def _viewer(port: int, web: bool, say: Say) -> Viewer:
    if not web:
        return Viewer.native(address(port))
    web_port = free_port()
    opened = Viewer.web(address(port), web_port)
    say(f"Live view: {web_page(web_port, port)}\n{WEB_REMARK}")
    return opened


def _outstay(opened: Viewer, say: Say) -> None:
    """Until the viewer is closed, or somebody presses Ctrl-C."""
    if opened.running:
        say("All is shown; close the viewer, or press Ctrl-C, to end.")
    with suppress(KeyboardInterrupt):
        while opened.running:
            time.sleep(LOOK_S)


def _said_why(opened: Viewer, say: Say) -> None:
    """A viewer that could not stay: without a screen, a driver, a port."""
    if not opened.running and opened.process.returncode:
        said = opened.complaint
        say(
            f"The viewer ended by itself: {said}"
            if said
            else "The viewer ended by itself, and did not say why."
        )
