"""One run in progress: followed live, paused, continued, stopped. A run that has ended is in the library."""

from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response, StreamingResponse
from starlette.routing import Route

from smarig.console.library.library_entry import Entry
from smarig.console.web.console_context import back, context_of, named_file, page
from smarig.console.web.console_scope import folder_of
from smarig.console.web.run_feed import ENDED_MESSAGE, RunFeed
from smarig.console.web.run_words import ENDED, run_card, run_outcome
from smarig.core import Requester, UsageError, printable
from smarig.running import RunInProgress, runs_in_progress

_DONE = {wanted: f"The run is asked to {wanted}." for wanted in ("pause", "continue", "stop")}
_MODELS_OFFERED = 50


def run_page(request: Request) -> HTMLResponse:
    """The page of a run, with its buttons if the console may press them."""
    run = _run(request)
    return _page(request, reading=run is not None and not context_of(request).scope.has(run.info))


def phone_page(request: Request) -> HTMLResponse:
    """The same to watch only."""
    return _page(request, reading=True)


def ask(request: Request) -> Response:
    """A button: pause, continue, stop."""
    wanted, run = request.path_params["wanted"], _found(request)
    if run is None:
        return back("/", "It has ended already.", "warning")
    if wanted not in _DONE:
        raise UsageError("A run can be paused, continued and stopped.")
    if not context_of(request).scope.has(run.info):
        raise UsageError(
            f"This run belongs to {printable(folder_of(run.info))}. Ask it from the console of that folder, or stop "
            "its rig on the page of the rig."
        )
    run.ask(wanted, "console", Requester.CONSOLE)
    if run.is_check:
        return back("/", "The check is asked to stop.", "warning")
    kept = {"file": str(run.info["out"])}  # by which a run that ends at once is found
    if model := request.query_params.get("model", ""):
        kept["model"] = model
    return back(
        f"/runs/{run.key}?{urlencode(kept, errors='replace')}",
        _DONE[wanted],
        "warning" if wanted == "stop" else "good",
    )


async def open_viewer(request: Request) -> Response:
    """Start the viewer of the run. In the main thread, with which it ends."""
    run, context = _run(request), context_of(request)
    if run is None:
        return back("/", "The run has ended already.", "warning")
    file = Path(run.info["out"])
    context.viewers.start(file)
    await run_in_threadpool(context.viewers.wait, file)
    place = urlencode({"file": str(file)}, errors="replace")
    return RedirectResponse(f"/runs/{run.key}?{place}#viewer", status_code=303)


def follow(request: Request) -> Response:
    """The messages of a run, as long as it lasts and the browser listens."""
    run = _run(request)
    if run is None:
        # It ended before the page asked. Without a last message, the page would wait for a console that is silent.
        return StreamingResponse(iter([ENDED_MESSAGE]), media_type="text/event-stream")
    feed = RunFeed(run, _model(request, run), context_of(request).closing)
    return StreamingResponse(
        feed.messages(), media_type="text/event-stream", headers={"cache-control": "no-store"}
    )


def state(request: Request) -> JSONResponse:
    """Whether the run goes on, and how it ended; for a page that does not follow it."""
    run, context = _run(request), context_of(request)
    if run is not None:
        return JSONResponse({"in_progress": True})
    file = named_file(request.query_params.get("file", ""))
    inside = file.is_relative_to(context.folder) and file.is_file()
    return JSONResponse(
        {"in_progress": False, **(run_outcome(file) if inside else {"state": ENDED, "level": ""})}
    )


def _page(request: Request, *, reading: bool) -> HTMLResponse:
    run = _run(request)
    if run is None:
        return page(
            request, "ended_run.html", {"file": request.query_params.get("file", "")}, here="runs", status=404
        )
    shown: dict[str, Any] = {
        "run": run_card(run),
        "models": [entry.place for entry in _models(request, run)],
        "model": request.query_params.get("model", ""),
        "viewer": context_of(request).viewers.state(Path(run.info["out"])),
        "reading": reading,
    }
    return page(request, "run.html", shown, here="runs")


def _run(request: Request) -> RunInProgress | None:
    """The run of the address. A check of a rig has no page: it takes no samples."""
    found = _found(request)
    return None if found is None or found.is_check else found


def _found(request: Request) -> RunInProgress | None:
    key = request.path_params["key"]
    return next((run for run in runs_in_progress() if run.key == key), None)


def _models(request: Request, run: RunInProgress) -> list[Entry]:
    """The models of the library whose output has the unit of a run, newest first."""
    found = context_of(request).library.search(kind="model", limit=_MODELS_OFFERED).entries
    unit = str(run.info.get("unit") or "")
    return [entry for entry in found if not unit or entry.details.get("unit") in (None, "", unit)]


def _model(request: Request, run: RunInProgress) -> Path | None:
    """The model file that the address names; only those of the library in the unit of the run are read."""
    place = request.query_params.get("model", "")
    if not place:
        return None
    found = next((entry.path for entry in _models(request, run) if entry.place == place), None)
    if found is None:
        raise UsageError(f"The library has no such model in {run.info.get('unit') or 'this unit'}.")
    return found


ROUTES = [
    Route("/runs/{key:str}", run_page),
    Route("/runs/{key:str}/phone", phone_page),
    Route("/runs/{key:str}/follow", follow),
    Route("/runs/{key:str}/state", state),
    Route("/runs/{key:str}/viewer", open_viewer, methods=["POST"]),
    Route("/runs/{key:str}/{wanted:str}", ask, methods=["POST"]),
]
