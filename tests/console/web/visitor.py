"""A person at the console: clicks what is seen, fills what is labelled, waits for what is shown."""

import json
import time
from pathlib import Path
from typing import Any

from report.browser import Browser

PATIENCE_S = 120.0  # ends a test that has failed
_BY_WORDS = """(words => [...document.querySelectorAll("a, button, summary")].find(x =>
    x.checkVisibility() && [x.ariaLabel, x.innerText.trim()].includes(words)))"""
_BY_LABEL = """(words => { const label = [...document.querySelectorAll("label")].find(x =>
    x.checkVisibility() && x.innerText.trim().startsWith(words)); return label && label.control; })"""
_CENTRE = """(x => { x.scrollIntoView({ block: "center", behavior: "instant" }); const r = x.getBoundingClientRect();
    const at = [r.x + r.width / 2, r.y + r.height / 2];
    const top = document.elementFromPoint(...at);
    return x === top || x.contains(top) || top.contains(x) ? at : null; })"""


class Visitor:
    """One tab of a browser at the address of a console."""

    def __init__(self, browser: Browser, address: str, width: int = 1280) -> None:
        self.tab = browser.open(address, width)
        self._root = address.partition("/?")[0]

    def go(self, place: str) -> None:
        """Load a page of the console."""
        self.tab.run("window.isOld = true")
        self.tab.browser.call("Page.navigate", self.tab.session, url=self._root + place)
        self.until("!window.isOld && document.readyState === 'complete'", place)

    def click(self, words: str) -> None:
        """Press the mouse on a link or a button that bears these words; it must be seen and not covered.

        As a person would, press again if the page moved under the mouse.
        """
        target = f"(x => x && !x.disabled && {_CENTRE}(x))({_BY_WORDS}({json.dumps(words)}))"
        end_s = time.monotonic() + PATIENCE_S
        while True:
            at = self.until(target, f"'{words}'")
            self.tab.run(
                "window.isHit = false; addEventListener('click', e =>"
                f" {{ window.isHit ||= {_BY_WORDS}({json.dumps(words)})?.contains(e.target); }}, true)"
            )
            self.press(*at)
            try:
                if self.tab.run("window.isHit") is not False:  # undefined on the page to which it led
                    return
            except AssertionError:  # between two pages
                return
            assert time.monotonic() < end_s, f"'{words}' cannot be clicked"

    def press(self, x: float, y: float) -> None:
        """Press the mouse here."""
        for type in ("mousePressed", "mouseReleased"):
            self.tab.browser.call(
                "Input.dispatchMouseEvent", self.tab.session, type=type, x=x, y=y, button="left", clickCount=1
            )

    def fill(self, label: str, text: str) -> None:
        """Type into the field with this label, in place of what is there."""
        field = f"{_BY_LABEL}({json.dumps(label)})"
        self.until(
            f"(x => {{ x.focus(); x.select(); return x === document.activeElement; }})({field})", label
        )
        self.tab.type(text)

    def choose(self, label: str, value: str) -> None:
        """Choose an option of the list with this label."""
        self.tab.run(
            f"(x => {{ x.value = {json.dumps(value)}; x.dispatchEvent(new Event('change', {{ bubbles: true }})); }})"
            f"({_BY_LABEL}({json.dumps(label)}))"
        )

    def give(self, label: str, file: Path) -> None:
        """Choose a file for the field with this label."""
        find = f"{_BY_LABEL}({json.dumps(label)})"
        place = self.tab.browser.call("Runtime.evaluate", self.tab.session, expression=find)["result"][
            "objectId"
        ]
        self.tab.browser.call("DOM.setFileInputFiles", self.tab.session, files=[str(file)], objectId=place)

    def shows(self, words: str) -> str:
        """Wait until the page shows these words; all its text."""
        return self.until(f"(t => t.includes({json.dumps(words)}) && t)(document.body.innerText)", words)

    def reload_until(self, expression: str) -> None:
        """Load the page again and again until an expression is true."""
        end_s = time.monotonic() + PATIENCE_S
        while not self._now(expression):
            assert time.monotonic() < end_s, f"{expression}: {self._now('document.body.innerText')}"
            time.sleep(0.5)
            if place := self._now("location.pathname + location.search"):
                self.go(place)

    def _now(self, expression: str) -> Any:
        """The value of an expression; None between two pages, where it cannot be computed."""
        try:
            return self.tab.run(expression)
        except AssertionError:
            return None

    def until(self, expression: str, why: str = "") -> Any:
        """The value of an expression as soon as it is true. A page may be replaced meanwhile."""
        end_s = time.monotonic() + PATIENCE_S
        while True:
            if found := self._now(expression):
                return found
            if time.monotonic() > end_s:
                raise TimeoutError(f"{why or expression}: {self.tab.run('document.body.innerText')}")
            time.sleep(0.1)
