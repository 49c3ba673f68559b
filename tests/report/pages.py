"""Helpers for tests of pages: parsed pages, runs made in memory, unpacked arrays."""

import base64
import json
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path

import numpy as np

from smarig.record import Event, Run, Step
from smarig.record.schema import SAMPLE_COLUMNS

LOADING = ("src", "href", "srcset", "poster", "action", "data", "formaction", "background")


@dataclass
class Page(HTMLParser):
    """Tags with attributes, tables as rows of cell texts, captions, the JSON of each plot, visible text."""

    tags: list = field(default_factory=list)
    tables: list = field(default_factory=list)
    captions: list = field(default_factory=list)
    headings: list = field(default_factory=list)
    plots: list = field(default_factory=list)
    visible: str = ""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags, self.tables, self.captions, self.headings, self.plots, self.visible = (
            [],
            [],
            [],
            [],
            [],
            "",
        )
        self._open: list[str] = []
        self._json = False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "br", "hr", "input"):
            self._open.append(tag)
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
        elif tag == "figcaption":
            self.captions.append("")
        elif tag in ("h1", "h2"):
            self.headings.append("")
        self._json = tag == "script" and dict(attrs).get("type") == "application/json"

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        inside = self._open[-1] if self._open else ""
        if inside == "script":
            if self._json:
                self.plots.append(json.loads(data))
            return
        if inside == "style":
            return
        self.visible += data
        if "figcaption" in self._open:
            self.captions[-1] += data
        if "h1" in self._open or "h2" in self._open:
            self.headings[-1] += data
        if "td" in self._open or "th" in self._open:
            self.tables[-1][-1][-1] += data

    def row(self, first: str) -> list[str]:
        """The cells of the one row whose first cell begins with these words."""
        found = [row for table in self.tables for row in table if row[0].startswith(first)]
        assert len(found) == 1, f"{len(found)} rows begin with {first!r}"
        return found[0]

    def card(self, label: str) -> str:
        """Text of the headline card with a label."""
        at = self.visible.index(label)
        return self.visible[at : at + 160]

    def traces(self, name: str = "") -> list[dict]:
        """Traces of all plots, or those whose name contains these words."""
        return [t for plot in self.plots for t in plot["data"] if name in t.get("name", "")]


def unpacked(spec) -> np.ndarray:
    """The array in a typed-array specification or a list."""
    if isinstance(spec, list):
        return np.array(spec, dtype=float)
    values = np.frombuffer(base64.b64decode(spec["bdata"]), dtype="<" + spec["dtype"])
    return values.reshape([int(n) for n in spec["shape"].split(",")]) if "shape" in spec else values


def run_of(
    columns: dict | None = None,
    steps: tuple[Step, ...] = (),
    events: tuple[Event, ...] = (),
    *,
    end: str | None = "done",
    **meta,
) -> Run:
    """A run in memory; columns not given are NaN (quality 0)."""
    given = {name: np.asarray(v, dtype=float) for name, v in (columns or {}).items()}
    n = max((v.size for v in given.values()), default=0)
    whole = {name: given.get(name, np.full(n, np.nan)) for name in SAMPLE_COLUMNS}
    whole["tick"] = np.arange(n, dtype=float)
    whole["quality"] = given.get("quality", np.zeros(n))
    closing = {} if end is None else {"end": {"cause": end}}
    return Run(Path("made.run.sqlite"), {"protocol": "validation", **meta, **closing}, whole, steps, events)


def step(index: int, target: float, position: float, verdict: str = "settled") -> Step:
    """A step of ten seconds."""
    return Step(index, 0, False, "made", target, 10.0 * index, 10.0 * index + 10, verdict, position, 50)
