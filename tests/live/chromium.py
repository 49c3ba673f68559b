"""A headless browser for tests: it is started and ended here, and uses loopback only."""

import base64
import itertools
import json
import shutil
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

import pytest

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--remote-allow-origins=*",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
)
START_S, LOOK_S = 60.0, 0.1


def found() -> str:
    """The browser, or the test is skipped by name."""
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if path is None:
        pytest.skip("no chromium here")
    return path


class Browser:
    """One page; ``with Browser(1600, 900) as page: page.open(url)``."""

    def __init__(self, width: int, height: int) -> None:
        self._websocket = pytest.importorskip("websocket", reason="websocket-client is not installed")
        self._folder = Path(tempfile.mkdtemp(prefix="smarig-chromium-"))
        flags = (*FLAGS, f"--window-size={width},{height}", f"--user-data-dir={self._folder}")
        self._process = subprocess.Popen(
            [found(), *flags, "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self._ids = itertools.count(1)
        self.console: list[str] = []

    def __enter__(self) -> "Browser":
        port_file = self._folder / "DevToolsActivePort"
        until = time.monotonic() + START_S
        while not (port_file.is_file() and port_file.read_text().strip()):
            assert time.monotonic() < until, "chromium did not start"
            time.sleep(LOOK_S)
        port = port_file.read_text().split()[0]
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list") as answer:
            page = next(target for target in json.load(answer) if target["type"] == "page")
        # byte by byte, in Python, that check takes longer than all else; recv() decodes what came all the same
        self._socket = self._websocket.create_connection(
            page["webSocketDebuggerUrl"], timeout=180, skip_utf8_validation=True
        )
        self.ask("Page.enable")
        self.ask("Runtime.enable")
        return self

    def __exit__(self, *error: object) -> None:
        self._socket.close()
        self._process.terminate()
        self._process.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """One command and its answer; errors of the page are kept in ``console`` meanwhile."""
        number = next(self._ids)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while (message := json.loads(self._socket.recv())).get("id") != number:
            if message.get("method") == "Runtime.exceptionThrown":
                self.console.append(json.dumps(message["params"]["exceptionDetails"])[:400])
            if message.get("method") == "Runtime.consoleAPICalled" and message["params"]["type"] == "error":
                self.console.append(json.dumps(message["params"]["args"])[:400])
        return message.get("result", {})

    def open(self, url: str) -> None:
        """Go there."""
        self.ask("Page.navigate", url=url)

    def picture(self) -> bytes:
        """What is seen now, PNG."""
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])
