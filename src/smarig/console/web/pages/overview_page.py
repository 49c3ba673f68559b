"""The overview: runs and checks of the console, the queue of the folder, and how its entries ended; others apart."""

import time
import zlib
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from smarig.console.own_code import own_code_text
from smarig.console.queue.ensure_worker import ensure_worker
from smarig.console.queue.entry_request import shown_command
from smarig.console.queue.queue import HeldEntry
from smarig.console.queue.queue_entry import CONTINUABLE, ENDED, EntryState, QueueEntry
from smarig.console.web.console_context import (
    LONGEST_NUMBER,
    TEMPLATES,
    ConsoleContext,
    back,
    context_of,
    form_texts,
    page,
)
from smarig.console.web.console_scope import folder_of
from smarig.console.web.run_words import run_card
from smarig.core import Requester, SmarigError, UsageError, printable
from smarig.report import duration
from smarig.running import RunInProgress, runs_in_progress, stop_runs

_ENDED_SHOWN = 20


def overview(request: Request) -> HTMLResponse:
    """The page."""
    shown = _parts(context_of(request))
    return page(request, "overview.html", {**shown, "state": _state(shown)}, here="runs")


def parts(request: Request) -> HTMLResponse:
    """What changes on the page."""
    return TEMPLATES.TemplateResponse(
        request, "overview_parts.html", {**_parts(context_of(request)), "reading": False}
    )


def version(request: Request) -> JSONResponse:
    """A text that differs whenever the page would; the runs, and why the queue has paused by itself."""
    return JSONResponse(_state(_parts(context_of(request))))


def elsewhere(request: Request) -> HTMLResponse:
    """The runs and checks of other folders, to look at only."""
    runs = [
        run_card(run) | {"folder": printable(folder_of(run.info))} for run in _others(context_of(request))
    ]
    return page(request, "elsewhere.html", {"runs": runs}, here="runs")


def _state(shown: dict[str, Any]) -> dict[str, Any]:
    followed = [run for run in shown["runs"] if not run["is_check"]]  # of whose ends the browser notifies
    runs = [{name: run[name] for name in ("key", "title", "file")} for run in followed]
    return {"version": shown["version"], "runs": runs, "fault": shown["queue"]["fault"]}


def queue_request(request: Request) -> Response:
    """A button of the queue: pause or continue it."""
    queue, wanted = context_of(request).queue, request.path_params["wanted"]
    if wanted not in ("pause", "continue"):
        raise UsageError("The queue can be paused and continued.")
    if wanted == "continue":
        queue.go_on()
        ensure_worker(context_of(request).folder)
        return back("/", "The queue continues.")
    if any(e.state is EntryState.RUNNING for e in queue.entries(newest=0)):
        queue.stop_after_this()
        return back("/", "The queue will pause when the present run has ended.", "warning")
    queue.pause()
    return back("/", "The queue is paused.", "warning")


async def start_entries(request: Request) -> Response:
    """Let entries go that nobody has queued here, as they were shown: each field has the number and the mark of one."""
    marks = [value for name, value in await form_texts(request) if name == "entry"]
    return await run_in_threadpool(_started, context_of(request), marks)


def _started(context: ConsoleContext, marks: list[str]) -> Response:
    for each in marks:
        number, _, mark = each.partition(" ")
        if not number.isdecimal() or len(number) > LONGEST_NUMBER:
            raise UsageError("No entry was chosen.")
        context.queue.allow(int(number), mark)
    ensure_worker(context.folder)
    text = f"{_number_of(len(marks), 'entry', 'entries')} will be started in order."
    if context.queue.state().paused:
        return back("/", f"{text} The queue is paused: continue it.", "warning")
    return back("/", text)


async def entry_request(request: Request) -> Response:
    """A button of one entry: up, down, remove, continue."""
    form = dict(await form_texts(request))
    return await run_in_threadpool(_entry_requested, request, form.get("mark", ""))


def _entry_requested(request: Request, mark: str) -> Response:
    context = context_of(request)
    number, wanted = request.path_params["number"], request.path_params["wanted"]
    if wanted == "remove":
        context.queue.remove(number)
        return back("/", "The entry was removed.")
    if wanted == "continue":
        entry_held = context.queue.held_entry(number)
        if entry_held.code and entry_held.mark != mark:
            raise UsageError(
                f"Entry {number} runs {own_code_text(entry_held.code)}, which is not what was shown. Look at it again."
            )
        context.queue.continue_interrupted(number)
        ensure_worker(context.folder)
        if context.queue.state().paused:
            return back(
                "/", "The entry is the next one, but the queue is paused. Continue the queue.", "warning"
            )
        return back("/", "The entry will be continued next, and then the rest of the queue.")
    waiting = [e.id for e in context.queue.entries(newest=0) if e.state is EntryState.WAITING]
    if number not in waiting:
        return back("/", "This entry does not wait any more.", "warning")
    at = waiting.index(number)
    if wanted == "up" and at:
        context.queue.move(number, before=waiting[at - 1])
    if wanted == "down" and at + 1 < len(waiting):
        context.queue.move(number, before=waiting[at + 2] if at + 2 < len(waiting) else None)
    return back("/")


def dismiss(request: Request) -> Response:
    """Show a run that ended without finishing no more."""
    context_of(request).ended_runs.dismiss(request.path_params["key"])
    return back("/")


def stop_all(request: Request) -> Response:
    """Stop every run and check of this console at once, and start no further entry of the queue."""
    problems, context = [], context_of(request)
    try:
        context.queue.pause()
    except SmarigError as error:  # a damaged queue must not keep a current on
        problems.append(str(error))
    runs = context.scope.own(runs_in_progress())
    stop_runs(runs, "'Stop everything' in the console", Requester.CONSOLE)
    checked = [str(run.info["rig"]) for run in runs if run.is_check]
    checked += context.rig_checks.terminate(but={run.info["pid"] for run in runs})
    n = sum(not run.is_check for run in runs)
    sentences = [f"{_number_of(n, 'run')} asked to stop."] if n else []
    sentences += [f"The check of {printable(rig)} was asked to stop." for rig in checked]
    text = " ".join([*(sentences or ["No run and no check of this console was in progress."]), *problems])
    return back(
        "/",
        text if problems else f"{text} The queue is paused.",
        "warning" if sentences or problems else "good",
    )


def _parts(context: ConsoleContext) -> dict[str, Any]:
    runs = [run_card(run) for run in context.scope.own(runs_in_progress())]
    queue, unfinished, n = _queue(context), context.ended_runs.found(), len(_others(context))
    others = f"{_number_of(n, 'run')} of other folders {'is' if n == 1 else 'are'} in progress" if n else ""
    words = repr((runs, queue, unfinished, others)).encode("utf-8", "replace")
    version = f"{zlib.crc32(words):08x}"
    return {"runs": runs, "others": others, "unfinished": unfinished, "queue": queue, "version": version}


def _others(context: ConsoleContext) -> list[RunInProgress]:
    return context.scope.others(runs_in_progress())


def _queue(context: ConsoleContext) -> dict[str, Any]:
    now = time.time()
    try:
        entries, state = context.queue.entries(newest=_ENDED_SHOWN), context.queue.state()
        ends, held = context.queue.ends_at(now), context.queue.held()
    except SmarigError as error:
        return {
            "reason": str(error),
            "fault": "",
            "summary": "",
            "paused": True,
            "runs": False,
            "held": None,
            "waiting": [],
            "ended": [],
        }
    waiting = [e for e in entries if e.state not in ENDED]
    reason = f"The queue is paused. {state.sentence}" if state.paused else ""
    if state.stop_after_this:
        reason = "The queue will pause when the present run has ended."
    return {
        "reason": reason,
        "fault": state.sentence if state.paused_by is not None else "",
        "summary": _summary(waiting, ends, paused=state.paused, held=bool(held)),
        "held": _held(held, context) if held else None,
        "paused": state.paused or state.stop_after_this,
        "runs": any(e.state is EntryState.RUNNING for e in waiting),
        "waiting": [_row(e, context) for e in waiting],
        "ended": [_row(e, context) for e in reversed(entries) if e.state in ENDED],
    }


def _held(held: list[HeldEntry], context: ConsoleContext) -> dict[str, Any]:
    """What a person must see of entries that came with the folder, before a click starts them."""
    rows = [
        {
            "id": each.entry.id,
            "value": f"{each.entry.id} {each.mark}",
            "command": shown_command(each.entry.request, context.folder, continued=each.entry.continued),
            "rig": each.entry.request.rig,
            "out": each.entry.request.out,
            "code": [(code.is_data, printable(code.text, 300)) for code in each.code],
        }
        for each in held
    ]
    return {"rows": rows, "plain": [row for row in rows if not row["code"]]}


def _summary(waiting: list[QueueEntry], ends: float | None, *, paused: bool, held: bool) -> str:
    if ends is None:
        return "Nothing waits."
    n = sum(e.state is EntryState.WAITING for e in waiting)
    text = f"{_number_of(n, 'entry', 'entries')} waiting" if n else "Nothing waits"
    if paused and n:
        return f"{text}, until the queue continues."
    if held:
        return f"{text}. Those that you have not started hold up the ones behind them."
    return f"{text}. Everything will have ended at about {_moment(ends)}."


def _row(entry: QueueEntry, context: ConsoleContext) -> dict[str, Any]:
    request, continuable = entry.request, entry.state in CONTINUABLE
    entry_held = context.queue.held_entry(entry.id) if continuable else None
    words = (
        request.experiment if request.kind != "characterise" else f"characterisation ({request.experiment})"
    )
    good = {EntryState.DONE: "good", EntryState.FAILED: "bad", EntryState.INTERRUPTED: "bad"}
    return {
        "id": entry.id,
        "experiment": words,
        "rig": request.rig,
        "out": request.out,
        "takes": duration(entry.expected_s),
        "state": str(entry.state),
        "sentence": entry.sentence,
        "level": good.get(entry.state, ""),
        "movable": entry.state is EntryState.WAITING,
        "continuable": continuable,
        "mark": entry_held.mark if entry_held else "",
        "code": own_code_text(entry_held.code) if entry_held else "",
        "when": _moment(entry.ended) if entry.ended else "",
    }


def _number_of(n: int, one: str, several: str = "") -> str:
    return f"{n} {one if n == 1 else several or one + 's'}"


def _moment(epoch: float) -> str:
    """A time of day, with the date if it is not of today."""
    then, today = time.localtime(epoch), time.localtime()
    return time.strftime("%H:%M" if then[:3] == today[:3] else "%Y-%m-%d %H:%M", then)


ROUTES = [
    Route("/", overview),
    Route("/elsewhere", elsewhere),
    Route("/overview/parts", parts),
    Route("/overview/version", version),
    Route("/queue/start", start_entries, methods=["POST"]),
    Route("/queue/{wanted:str}", queue_request, methods=["POST"]),
    Route("/queue/{number:entry}/{wanted:str}", entry_request, methods=["POST"]),
    Route("/ended/{key:str}/dismiss", dismiss, methods=["POST"]),
    Route("/stop-all", stop_all, methods=["POST"]),
]
