"""The live view in real viewers: the native one without a screen, and the web one in a headless browser.

The tests read the viewers' state (views, errors, recordings) and check that screenshots are not blank. They
are skipped if the tools are absent.
"""

import io
import os
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from live.chromium import Browser, found
from live.made import LEVELS_A
from smarig.config import load_rig
from smarig.live import colours
from smarig.live.display_info import rig_display_info
from smarig.live.live_view import live_listener, save_recording
from smarig.live.viewer_process import ViewerProcess, free_port, viewer_address, web_page
from smarig.plant.actuator import Actuator
from smarig.record import load_run
from smarig.runner.session import Session

pytest.importorskip("rerun_cli", reason="rerun is not installed")
Image = pytest.importorskip("PIL.Image", reason="pillow is not installed")

TOASTS_S = 6.0  # how long the viewer's own remarks stand in the picture
PATIENCE_S, LOOK_S = 180.0, 0.25  # a page full of WebAssembly, on a processor that has other work
BEGINNING_S = 1.0
SIZE = (1920, 1080)
RIG = "one_wire_twin"


def pictures(tmp_path: Path) -> Path:
    """Folder of the screenshots: a temporary one, or one chosen for inspection."""
    folder = Path(os.environ.get("SMARIG_PICTURES") or tmp_path)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def until(found: Callable[[], Any], what: str) -> Any:
    """The first answer that is not false."""
    end = time.monotonic() + PATIENCE_S
    said: object = None
    while time.monotonic() < end:
        try:
            if answer := found():
                return answer
        except Exception as error:  # a viewer that is not ready raises several kinds of error
            said = error
        time.sleep(LOOK_S)
    pytest.fail(f"{what} within {PATIENCE_S:g} s; last: {said}")


def headless(url: str) -> tuple[ViewerProcess, str]:
    """A native viewer without a screen and its address; skipped where nothing can draw."""
    port = free_port()
    viewer = ViewerProcess.headless(url, port, f"{SIZE[0]}x{SIZE[1]}")
    asked = viewer_address(port)
    from smarig.live.rerun_output import viewer_state

    def up() -> object:
        if not viewer.running:
            pytest.skip(f"the native viewer cannot draw here (mesa-vulkan-drivers?): {viewer.complaint}")
        return viewer_state(asked)

    until(up, "the viewer answers")
    return viewer, asked


def wait_until_idle() -> None:
    """Wait until the viewer's own messages have disappeared from the screenshot."""
    if os.environ.get("SMARIG_PICTURES"):
        time.sleep(TOASTS_S)


def shows(asked: str, end_s: float) -> dict[str, Any] | None:
    """The contents of a viewer, once it has a layout and a run from its first second to its end."""
    from smarig.live.rerun_output import viewer_state

    state = viewer_state(asked)
    laid_out = state["views"] and state["ends_s"]  # the layout may arrive after the data
    whole = laid_out and min(state["begins_s"]) < BEGINNING_S and max(state["ends_s"]) >= end_s
    return state if whole else None


def run_watched(folder: Path, name: str, listener: Any) -> Path:
    """A short run of the twin, with a watcher."""
    settings = {"currents_A": LEVELS_A[RIG], "settle.timeout_s": 120.0}
    with Session(RIG, seed=1, wire=name) as session:
        return session.run("step_currents", settings, folder / f"{name}.run.sqlite", listeners=[listener])


def display_info() -> Any:
    file = load_rig(RIG)
    return rig_display_info(
        file, Actuator.named(file.actuator), "twin", {"settle.timeout_s": 120.0}, f"step_currents on {RIG}"
    )


def colour_counts(picture: Any) -> Counter:
    """How many pixels are near each colour that has a meaning."""
    pixels = np.asarray(picture.convert("RGB"))
    named = {"sky": colours.SKY, "green": colours.GREEN, "amber": colours.AMBER, "orange": colours.ORANGE}
    return Counter({name: int(np.all(between(pixels, c), axis=-1).sum()) for name, c in named.items()})


def between(pixels: Any, colour: Any) -> Any:
    """Which channels are near a colour's, in bytes: as whole numbers a picture takes a second to look through."""
    low, high = (np.clip(np.asarray(colour) + by, 0, 255).astype(np.uint8) for by in (-23, 23))
    return (low <= pixels) & (pixels <= high)


def test_the_native_viewer_shows_a_run_and_a_latecomer_sees_its_beginning(tmp_path):
    from smarig.live.rerun_output import save_screenshot_of

    port, told = free_port(), []
    with live_listener(display_info(), viewer=False, port=port, show_message=told.append) as listener:
        end_s = float(load_run(run_watched(tmp_path, "native", listener))["t_s"][-1])
        first, asked = headless(viewer_address(port))
        try:
            state = until(lambda: shows(asked, end_s), "the run is shown")
            picture = pictures(tmp_path) / "live_native.png"

            def pictured() -> bool:
                wait_until_idle()
                save_screenshot_of(asked, picture, 0.75 * end_s)
                found = colour_counts(Image.open(picture))  # laid out is not yet drawn, on a busy machine
                return min(found[name] for name in ("sky", "green", "amber", "orange")) > 100

            until(pictured, "a picture of the run")
        finally:
            first.process.kill()
            first.close()
        second, asked = headless(viewer_address(port))
        try:
            again = until(lambda: shows(asked, end_s), "the run is shown again, all of it")
        finally:
            second.close()
    assert state["complaints"] == []
    kinds = Counter(state["views"].values())
    assert (kinds["2D"], kinds["3D"], kinds["StateTimeline"]) == (2, 1, 1)
    assert kinds["TimeSeries"] >= 6
    assert {"TWIN · Position against estimated temperature", "TWIN · Wire, pulley and load"} <= set(
        state["views"]
    )
    assert again["views"] == state["views"]
    assert told == []


@pytest.mark.long("takes five seconds")
def test_two_wires_and_a_shaft_are_shown_without_a_complaint(two_wire, tmp_path):
    from smarig.live.rerun_output import save_screenshot_of, viewer_state

    save_recording(two_wire, tmp_path / "two.rrd")
    viewer, asked = headless(str(tmp_path / "two.rrd"))
    try:
        state = until(
            lambda: (s := viewer_state(asked))["ends_s"] and s["views"] and s, "the run is laid out"
        )
        picture, at_s = pictures(tmp_path) / "live_two_wires.png", 0.6 * max(state["ends_s"])
        until(
            lambda: wait_until_idle() or save_screenshot_of(asked, picture, at_s) or picture.is_file(),
            "a picture",
        )
    finally:
        viewer.close()
    assert state["complaints"] == []
    assert "TWIN · Wires and shaft" in state["views"]


@pytest.mark.long("takes half a minute")
def test_the_web_viewer_shows_a_run_with_the_internet_blocked(tmp_path):
    found()
    port, web_port = free_port(), free_port()
    with live_listener(display_info(), viewer=False, port=port, show_message=print) as listener:
        run_watched(tmp_path, "web", listener)
        server = ViewerProcess.web(viewer_address(port), web_port)
        try:
            with Browser(1280, 800) as page:
                until(lambda: is_served(web_port), "the page is served")
                page.ask(
                    "Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}]
                )
                page.open(web_page(web_port, port) + "&renderer=webgl")

                def drawn() -> bytes | None:
                    taken = page.picture()
                    state = colour_counts(Image.open(io.BytesIO(taken)))
                    return taken if min(state["sky"], state["amber"], state["orange"]) > 100 else None

                until(drawn, "graphs are drawn")
                (pictures(tmp_path) / "live_web.png").write_bytes(page.picture())
                wrong = [line for line in page.console if "panicked" in line or "RuntimeError" in line]
        finally:
            server.close()
    assert wrong == []


def is_served(port: int) -> bool:
    """Whether a process listens on loopback."""
    import socket

    with socket.create_connection(("127.0.0.1", port), timeout=1.0):
        return True


@pytest.mark.parametrize("ending", ["closed", "stopped"])
def test_a_viewer_ends_with_us_and_leaves_nothing_behind(ending, tmp_path):
    import signal

    viewer = ViewerProcess.web(viewer_address(free_port()), free_port())
    home = viewer._home
    if ending == "stopped":
        os.kill(viewer.process.pid, signal.SIGSTOP)
    viewer.close()
    assert viewer.process.poll() is not None
    assert not Path(home).exists()


def test_nothing_listens_beyond_loopback():
    """The kernel's own table of listening sockets, for the server's and the page's port."""
    table = Path("/proc/net/tcp")
    if not table.is_file():
        pytest.skip("no /proc/net/tcp here")
    port, web_port = free_port(), free_port()
    with live_listener(display_info(), viewer=False, port=port, show_message=print):
        server = ViewerProcess.web(viewer_address(port), web_port)
        try:
            until(lambda: is_served(web_port), "the page is served")
            tables = [t.read_text() for t in (table, Path("/proc/net/tcp6")) if t.is_file()]
            rows = [row.split() for text in tables for row in text.splitlines()[1:]]
            listening = {row[1] for row in rows if row[3] == "0A"}
        finally:
            server.close()
    ours = {f"0100007F:{p:04X}" for p in (port, web_port)}
    assert ours <= listening
    assert not {row for row in listening if row.split(":")[1] in {o.split(":")[1] for o in ours}} - ours


def test_a_taken_port_is_reported_in_a_sentence():
    import socket

    from smarig.core.errors import UsageError

    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        with pytest.raises(UsageError, match=f"Port {port} on 127.0.0.1 is taken"):
            free_port(port)
