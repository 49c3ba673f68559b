"""What a browser receives of a run in progress: its history once, then samples, status and events as they come.

The history comes from the run file, which is at most a second behind; later samples come from shared memory. Both are
thinned: a page draws thousands of points, not millions.

The output of a model along the input of a run, continued as samples come.
"""

import asyncio
import json
import threading
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from starlette.concurrency import run_in_threadpool

from smarig.console.web.input_memory import InputMemory
from smarig.console.web.run_words import ENDED, run_outcome, run_state
from smarig.core import SmarigError, UsageError
from smarig.preisach import Preisach
from smarig.record import stored_run
from smarig.replay import load_model
from smarig.running import RunInProgress


class ModelOverlay:
    """The Preisach operator of a model file, without its effects. Raises DataError for a file that is none."""

    def __init__(self, file: Path) -> None:
        model = load_model(file)
        self._operator = Preisach(model.hysteresis, "negative")
        self._range = model.hysteresis.lower, model.hysteresis.upper

    def outputs(self, inputs: Sequence[float | None]) -> list[float | None]:
        """The output at each input, in the unit of the model; None where there is no input."""
        known = [k for k, u in enumerate(inputs) if u is not None]
        if not known:
            return [None] * len(inputs)
        u = np.clip(np.array([inputs[k] for k in known], dtype=float), *self._range)
        y = self._operator.simulate(u, self._operator.state)
        found: list[float | None] = [None] * len(inputs)
        for k, output in zip(known, y.tolist()):
            found[k] = round(output, 6)
        return found


INTERVAL_S = 0.05  # twice as often as samples come: a sample is drawn well within the next one
HISTORY_POINTS, POINTS_AT_ONCE = 3000, 200
_EVENTS_EVERY = 20  # intervals between looks into the run file
_BOUNDARY_EVERY = 2  # intervals between looks at the memory of the input: at most ten messages per second
_EVENTS_AT_FIRST = 100
_COLUMNS = ("t_s", "input", "position", "current_A")
Rows = list[list[float | None]]


class RunFeed:
    """The messages of one run to one browser. ``model``: the file of a model that is drawn over the loop, or None.

    ``closing``: the console ends, and the run goes on.
    """

    def __init__(self, run: RunInProgress, model: Path | None, closing: threading.Event) -> None:
        self._run, self._closing = run, closing
        self._overlay = ModelOverlay(model) if model else None
        self._memory = InputMemory(run)
        self._newest = 0
        self._last_s = float("-inf")
        self._events_sent = 0
        self._status: dict[str, Any] = {}

    async def messages(self) -> AsyncIterator[str]:
        """Server-sent events: history, samples, boundary, status, events, alive (each second), ended."""
        yield _message("history", await run_in_threadpool(self._history))
        count = 0
        while self._run.alive and not self._closing.is_set():
            for name, content in self._news():
                yield _message(name, content)
            if count % _EVENTS_EVERY == 0:
                yield _message("alive", None)  # without it, a silent run and a stopped console look the same
                if events := await run_in_threadpool(self._recorded):
                    yield _message("events", events)
            if count % _BOUNDARY_EVERY == 0 and (found := self._boundary()):
                yield _message("boundary", found)
            count += 1
            await asyncio.sleep(INTERVAL_S)
        if self._closing.is_set():
            return
        if events := await run_in_threadpool(self._recorded):
            yield _message("events", events)
        yield _message("ended", {**await run_in_threadpool(run_outcome, self._file), "facts": ""})

    def _history(self) -> Rows:
        with suppress(SmarigError, OSError), stored_run(self._file, verify=False) as run:
            step = max(1, len(run) // HISTORY_POINTS)
            rows: Rows = []
            self._memory.begin(run)
            for block in run.blocks(_COLUMNS):
                self._memory.take(block["t_s"], block["input"])
                own = self._with_model(zip(*(block[name].tolist() for name in _COLUMNS)))
                rows += own[::step]
            if rows:
                self._last_s = float(rows[-1][0] or 0.0)
            self._memory.caught_up()
            return rows
        return []

    def _news(self) -> Iterable[tuple[str, Any]]:
        try:
            found, self._newest, _ = self._run.samples(self._newest)
        except UsageError:  # it has just ended
            return
        new = found[found["t_s"] > self._last_s]
        if new.size:
            self._last_s = float(new["t_s"][-1])
            columns = (new[name].tolist() for name in ("t_s", "input_K", "position", "current_A"))
            rows = self._with_model(zip(*columns))
            yield "samples", rows[:: max(1, len(rows) // POINTS_AT_ONCE)]
        state = run_state(self._run)
        if state != self._status:
            self._status = state
            yield "status", state

    def _with_model(self, rows: Iterable[tuple[float, ...]]) -> Rows:
        """The rows with the output of the model behind."""
        plain: Rows = [[_finite(value) for value in row] for row in rows]
        if self._overlay is None:
            return [[*row, None] for row in plain]
        outputs = self._overlay.outputs([row[1] for row in plain])
        return [[*row, output] for row, output in zip(plain, outputs)]

    def _boundary(self) -> dict[str, Any] | None:
        with suppress(UsageError):  # it has just ended
            self._memory.follow()
        return self._memory.news()

    def _recorded(self) -> list[dict[str, Any]]:
        """New events of the run file, which also has the samples that were missed."""
        with suppress(SmarigError, OSError), stored_run(self._file, verify=False) as run:
            if self._memory.is_behind:
                self._memory.catch_up(run)
            events = run.events
            first = self._events_sent or max(len(events) - _EVENTS_AT_FIRST, 0)
            self._events_sent = len(events)
            return [
                {"at": f"{e.t_s:.1f} s", "severity": str(e.severity), "text": e.text} for e in events[first:]
            ]
        return []

    @property
    def _file(self) -> Path:
        return Path(self._run.info["out"])


def _finite(value: float) -> float | None:
    return round(value, 6) if value == value and abs(value) != float("inf") else None


def _message(name: str, content: Any) -> str:
    return f"event: {name}\ndata: {json.dumps(content, allow_nan=False)}\n\n"


ENDED_MESSAGE = _message("ended", {"state": ENDED, "facts": "", "level": ""})
