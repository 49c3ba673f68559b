"""A page in headless Chromium over its own protocol, with all host names unresolvable.

It reads what tabs log and request from the network, and runs axe-core.
"""

import base64
import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-extensions",
    "--no-first-run",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--remote-allow-origins=*",
    "--use-angle=swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1",
)


def chromium() -> str:
    """The browser's program, or a skip that names it."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    return found or pytest.skip("Chromium is not installed")


def axe() -> str:
    """The script of axe-core from $SMARIG_AXE (the file, or the folder of node_modules); skips without it."""
    root = Path(__file__).resolve().parents[2]
    axe_path = os.environ.get("SMARIG_AXE")
    places = [Path(axe_path)] if axe_path else []
    places += [base / "axe-core" / "axe.min.js" for base in (*places, root / "node_modules")]
    found = next((path for path in places if path.is_file()), None)
    if found is None:
        pytest.skip("axe-core is not installed (npm install axe-core; SMARIG_AXE names its axe.min.js)")
    return found.read_text(encoding="utf-8")


class Browser:
    """One Chromium with a profile of its own; tabs are opened one after the other."""

    def __init__(self, profile: Path) -> None:
        from websocket import create_connection

        self._process = subprocess.Popen(
            [chromium(), *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
        )
        assert self._process.stderr is not None
        browser_log = (line.partition("DevTools listening on ")[2].strip() for line in self._process.stderr)
        address = next((words for words in browser_log if words), None)
        assert address, "Chromium ended before it listened"
        # byte by byte, in Python, that check takes longer than all else; recv() decodes what came all the same
        fast = {"skip_utf8_validation": True}
        self._socket = create_connection(address, timeout=60, suppress_origin=True, **fast)
        self._last = 0
        self.events: list[dict[str, Any]] = []

    def call(self, method: str, session: str = "", **params: Any) -> dict[str, Any]:
        """One call of the DevTools protocol; events that arrive meanwhile are kept."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": params}
        self._socket.send(json.dumps(message | ({"sessionId": session} if session else {})))
        while True:
            answer = json.loads(self._socket.recv())
            if answer.get("id") == self._last:
                assert "error" not in answer, answer["error"]
                return answer["result"]
            self.events.append(answer)

    def open(self, page: Path | str, width: int = 1280, height: int = 900) -> "Tab":
        """A loaded page, a file or an address, in a new tab of this size."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable", session)
        tab = Tab(self, session, target)
        tab.resize(width, height)
        self.call("Page.navigate", session, url=page if isinstance(page, str) else page.resolve().as_uri())
        while not tab.run("location.href !== 'about:blank' && document.readyState === 'complete'"):
            pass
        return tab

    def close(self) -> None:
        """End this browser, and only this one."""
        self._socket.close()
        self._process.terminate()
        self._process.communicate(timeout=30)


@dataclass
class Tab:
    """An open page: its log, its requests, and results of scripts."""

    browser: Browser
    session: str
    target: str

    def run(self, expression: str) -> Any:
        """The value of a JavaScript expression; promises are awaited."""
        options = {"expression": expression, "awaitPromise": True, "returnByValue": True}
        answer = self.browser.call("Runtime.evaluate", self.session, **options)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def resize(self, width: int, height: int = 900) -> None:
        """Give the tab another size, that of a phone below 600."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.browser.call("Page.bringToFront", self.session)  # a tab behind another is not drawn
        self.browser.call("Emulation.setDeviceMetricsOverride", self.session, **size)

    def on_paper(self, is_on: bool = True) -> None:
        """Show the page as it is printed on A4, or on the screen again."""
        self.browser.call("Emulation.setEmulatedMedia", self.session, media="print" if is_on else "")
        self.resize(703 if is_on else 1280)  # 186 mm

    def dark(self, is_on: bool = True) -> None:
        """Show the page as to people who prefer dark pages, or light ones."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if is_on else "light"}
        self.browser.call("Emulation.setEmulatedMedia", self.session, features=[scheme])

    def complaints(self) -> list[str]:
        """Every error on the console and every uncaught exception (the browser's own remarks on speed are none)."""
        found = []
        for event in self._events:
            about = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                found.append(json.dumps(about["exceptionDetails"])[:400])
            elif event["method"] == "Runtime.consoleAPICalled" and about["type"] in ("error", "assert"):
                found.append(json.dumps(about["args"])[:400])
            elif event["method"] == "Log.entryAdded" and about["entry"]["level"] == "error":
                found.append(about["entry"]["text"])
        return found

    @property
    def _events(self) -> list[dict[str, Any]]:
        return [event for event in self.browser.events if event.get("sessionId") == self.session]

    def requests(self) -> list[str]:
        """Requested addresses, without those inside the page (data:, blob:)."""
        asked = [
            event["params"]["request"]["url"]
            for event in self._events
            if event["method"] == "Network.requestWillBeSent"
        ]
        return [url for url in asked if not url.startswith(("data:", "blob:"))]

    def violations(self) -> list[str]:
        """What axe-core finds wrong, rule and places; nothing is best."""
        self.run(axe() + ";0")
        found = json.loads(self.run("axe.run().then(r => JSON.stringify(r.violations))"))
        return [
            f"{v['id']} ({v['impact']}): "
            + "; ".join(f"{n['target']} {n['failureSummary']}" for n in v["nodes"][:3])
            for v in found
        ]

    def key(self, name: str, code: int) -> None:
        """Press and let go a key; those with a character (Enter) give it."""
        text = {"Enter": "\r", " ": " "}.get(name, "")
        key = {"key": name, "code": name, "windowsVirtualKeyCode": code}
        self.browser.call(
            "Input.dispatchKeyEvent", self.session, type="keyDown", **key, **({"text": text} if text else {})
        )
        self.browser.call("Input.dispatchKeyEvent", self.session, type="keyUp", **key)

    def type(self, text: str) -> None:
        """Text into whatever has the focus."""
        self.browser.call("Input.insertText", self.session, text=text)

    def screenshot(self, path: Path) -> Path:
        """The whole page as a PNG."""
        size = self.browser.call("Page.getLayoutMetrics", self.session)["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        shot = self.browser.call(
            "Page.captureScreenshot", self.session, captureBeyondViewport=True, clip=clip
        )
        path.write_bytes(base64.b64decode(shot["data"]))
        return path

    def close(self) -> None:
        """Close the tab."""
        self.browser.call("Target.closeTarget", targetId=self.target)
