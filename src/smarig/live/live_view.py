"""Assembly of the live view: opens and closes server, renderer, queue and viewer in the right order.

A view that cannot be opened raises an error before the run starts. A view that fails later does not stop the
run.
"""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from smarig.live.display_info import DisplayInfo, run_display_info
from smarig.live.draw_queue import DrawQueue
from smarig.live.live_items import QueueListener
from smarig.live.playback import batches, replay
from smarig.live.scene_renderer import SceneRenderer
from smarig.live.viewer_process import WEB_REMARK, ViewerProcess, free_port, viewer_address, web_page
from smarig.preisach import Everett
from smarig.record import AnyRun, Run
from smarig.replay import HysteresisPredictor, NamedPredictor

if TYPE_CHECKING:
    from smarig.live.rerun_output import RerunOutput

SERVER_MEMORY = "512MiB"  # of data kept for viewers that connect later; the oldest are dropped first
VIEWER_POLL_S = 0.3  # interval of checks whether the viewer still runs
Report = Callable[[str], None]


@contextmanager
def live_listener(
    display_info: DisplayInfo,
    predictions: Sequence[NamedPredictor] = (),
    hysteresis: Everett | None = None,
    *,
    web: bool = False,
    viewer: bool = True,
    port: int = 0,
    wait_at_end: bool = False,
    show_message: Report = print,
) -> Iterator[QueueListener]:
    """A listener for the runner, with a viewer that ends with this process. ``viewer`` False only serves, at
    ``port``.

    ``wait_at_end``: after a run that ended well, wait until the viewer is closed.
    """
    port = free_port(port)
    rerun_output, scene_renderer = _open_output(
        display_info, predictions, hysteresis, recorded=False, port=port
    )
    viewer_process = _open_viewer(port, web, show_message) if viewer else None
    draw_queue = DrawQueue(scene_renderer.draw)
    try:
        yield QueueListener(draw_queue)
        if wait_at_end and viewer_process is not None:
            rerun_output.flush()
            _wait_for_viewer(viewer_process, show_message)
    finally:
        finished = draw_queue.close()
        if draw_queue.dropped:
            show_message(
                f"The live view could not keep up: {draw_queue.dropped} items were not shown. The record is complete."
            )
        if not finished:
            show_message(
                f"The live view ended before the run did{f': {draw_queue.failure}' if draw_queue.failure else ''}."
            )
        if viewer_process is not None:
            _report_viewer_failure(viewer_process, show_message)
            viewer_process.close()
        if finished:
            with suppress(Exception):  # errors of the viewer's library on closing do not concern the run
                rerun_output.close()


def view_run(
    run: Run,
    predictions: Sequence[NamedPredictor] = (),
    hysteresis: Everett | None = None,
    *,
    web: bool = False,
    speed: float = 0.0,
    show_message: Report = print,
) -> None:
    """Show a recorded run until its viewer is closed (in a browser: until interrupted)."""
    port = free_port()
    rerun_output, scene_renderer = _open_output(
        run_display_info(run), predictions, hysteresis, recorded=not speed, port=port
    )
    viewer_process = _open_viewer(port, web, show_message)
    never_set = threading.Event()

    def wait(seconds: float) -> bool:
        return never_set.wait(seconds) or not viewer_process.running

    try:
        replay(run, scene_renderer.draw, speed, wait, time.monotonic)
        rerun_output.flush()
        _wait_for_viewer(viewer_process, show_message)
    finally:
        _report_viewer_failure(viewer_process, show_message)
        viewer_process.close()
        rerun_output.close()


def save_recording(
    run: AnyRun, path: Path, predictions: Sequence[NamedPredictor] = (), hysteresis: Everett | None = None
) -> None:
    """Save a recorded run as an .rrd file with its layout, in batches: few, so that the file is compact, but many
    enough that memory holds a small part of it.
    """
    rerun_output, scene_renderer = _open_output(
        run_display_info(run), predictions, hysteresis, recorded=True, path=path
    )
    for batch in batches(run):
        scene_renderer.draw(batch)
        rerun_output.flush()
    rerun_output.close()


def _open_output(
    display_info: DisplayInfo,
    predictions: Sequence[NamedPredictor],
    hysteresis: Everett | None,
    *,
    recorded: bool,
    port: int = 0,
    path: Path | None = None,
) -> tuple["RerunOutput", SceneRenderer]:
    """A renderer with its output, on which everything known before the first sample is drawn.

    A twin without a given model is predicted by the surface that its actuator file names.
    """
    # rerun takes a second and a hundred megabytes, so it is imported only here
    from smarig.live.rerun_output import RerunOutput

    if not predictions and display_info.twin_hysteresis is not None:
        predictions = [
            NamedPredictor(
                "the rig's own surface",
                HysteresisPredictor(display_info.twin_hysteresis, display_info.initial),
            )
        ]
    rerun_output = RerunOutput(
        f"{display_info.label} · {display_info.title}" if display_info.label else display_info.title
    )
    if path is not None:
        rerun_output.save(path)
    else:
        rerun_output.serve(port, SERVER_MEMORY)
    scene_renderer = SceneRenderer(
        display_info, rerun_output.show, predictions, hysteresis or display_info.twin_hysteresis
    )
    rerun_output.arrange(scene_renderer.layout, replay=recorded)
    rerun_output.show(scene_renderer.opening())
    return rerun_output, scene_renderer


def _open_viewer(port: int, web: bool, show_message: Report) -> ViewerProcess:
    if not web:
        return ViewerProcess.native(viewer_address(port))
    web_port = free_port()
    viewer_process = ViewerProcess.web(viewer_address(port), web_port)
    show_message(f"Live view: {web_page(web_port, port)}\n{WEB_REMARK}")
    return viewer_process


def _wait_for_viewer(viewer_process: ViewerProcess, show_message: Report) -> None:
    """Wait until the viewer is closed or Ctrl-C is pressed."""
    if viewer_process.running:
        show_message("Everything is shown. Close the viewer or press Ctrl-C to end.")
    with suppress(KeyboardInterrupt):
        while viewer_process.running:
            time.sleep(VIEWER_POLL_S)


def _report_viewer_failure(viewer_process: ViewerProcess, show_message: Report) -> None:
    """Report a viewer that ended by itself, for lack of a screen, a driver or a port."""
    if not viewer_process.running and viewer_process.process.returncode:
        complaint_text = viewer_process.complaint
        show_message(
            f"The viewer ended unexpectedly: {complaint_text}"
            if complaint_text
            else "The viewer ended unexpectedly without a message."
        )
