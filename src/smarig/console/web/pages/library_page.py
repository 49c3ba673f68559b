"""The library: search, one entry with tags, notes and its page, and evaluations as the command line makes them."""

import time
import zlib
from collections.abc import Mapping
from typing import Any
from urllib.parse import urlencode

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from starlette.routing import Route

from smarig.console.library.library_entry import RECORDING, RUN, Entry
from smarig.console.library.library_search import FACETS, ORDERS
from smarig.console.library.run_content import is_recording
from smarig.console.web.console_context import ConsoleContext, back, context_of, form_texts, named_file, page
from smarig.console.web.evaluations import (
    compared_page,
    evaluations_of,
    finished_page,
    page_is_old,
    start_evaluation,
)
from smarig.console.web.loop_path import loop_path
from smarig.console.web.report_response import report_response
from smarig.core import UsageError
from smarig.report import duration

_ROWS = 50
_FILTERS = tuple((name, name.capitalize()) for name in FACETS)
_DAY_S = 86400.0
_FIGURES = {"cycles": "heating cycles", "error_times_noise": "error, in units of the noise floor"}
_WAIT_S, _LOOK_S = 5.0, 0.2


def library(request: Request) -> HTMLResponse:
    """Search and list."""
    context = context_of(request)
    query = {
        name: request.query_params.get(name, "") for name in ("text", "since", "until", "order", "offset")
    }
    query |= {name: request.query_params.get(name, "") for name, _ in _FILTERS}
    query["order"] = query["order"] if query["order"] in ORDERS else next(iter(ORDERS))
    offset = int(query["offset"]) if query["offset"].isdecimal() and len(query["offset"]) < 10 else 0
    found = context.library.search(
        query["text"],
        tags=[query["tag"]] if query["tag"] else [],
        wire=query["wire"] or None,
        rig=query["rig"] or None,
        protocol=query["protocol"] or None,
        kind=query["kind"] or None,
        verdict=query["verdict"] or None,
        since=_epoch(query["since"]),
        until=_epoch(query["until"], _DAY_S),
        order=query["order"],
        limit=_ROWS,
        offset=offset,
    )
    shown = {
        "query": query,
        "filters": _FILTERS,
        "facets": context.library.facets(),
        "orders": list(ORDERS),
        "rows": [_row(context, entry) for entry in found.entries],
        "total": found.total,
        "is_filtered": any(query[name] for name in query if name not in ("order", "offset")),
        "scan": context.scanner.text,
        "before": _query(query, max(offset - _ROWS, 0)) if offset else None,
        "after": _query(query, offset + _ROWS) if offset + _ROWS < found.total else None,
    }
    return page(request, "library.html", shown, here="library")


def entry(request: Request) -> HTMLResponse:
    """One entry."""
    context = context_of(request)
    found = _entry_now(context, request.path_params["id"])
    facts = [found.kind, _moment(found.began), found.wire, found.rig, found.protocol]
    facts += [duration(found.duration_s)] if found.duration_s else []
    shown = {
        "entry": found,
        "level": {"good": "good", "warning": "warning", "bad": "bad"}.get(found.verdict, ""),
        "facts": " · ".join(part for part in facts if part),
        "figures": [(_words(name), _figure(figure)) for name, figure in found.figures.items()],
        "conditions": _conditions(found.details),
        "has_page": finished_page(context, found) is not None,
        "page_is_old": page_is_old(context, found),
        "notes": [
            {"text": n.text, "when": " · ".join(p for p in (_moment(n.epoch), n.who) if p)}
            for n in found.notes
        ],
        "viewer": context.viewers.state(found.path),
        **_evaluations(context, found),
    }
    return page(request, "entry.html", shown, here="library")


def _entry_now(context: ConsoleContext, id: str) -> Entry:
    """The entry. If its run was being recorded when it was read, and has ended, its file is read again first."""
    found, until_s = context.library.entry(id), time.monotonic() + _WAIT_S
    while found.verdict == RECORDING and not is_recording(found.path) and time.monotonic() < until_s:
        context.scanner.soon()
        time.sleep(_LOOK_S)
        found = context.library.entry(id)
    return found


def run_entry(request: Request) -> Response:
    """The entry of a run that has just ended; its file is read first if the library does not have it yet."""
    context, file = context_of(request), named_file(request.query_params.get("file", ""))
    if not file.is_relative_to(context.folder):
        return back("/library", f"This run is not in the folder of this console. It is {file}.", "warning")
    until_s = time.monotonic() + _WAIT_S
    while True:
        found = context.library.search(file.name.removesuffix(".run.sqlite"), kind="run", limit=_ROWS).entries
        own = next((e for e in found if e.path == file and e.verdict != RECORDING), None)
        if own is not None:
            return RedirectResponse(f"/library/{own.id}", status_code=303)
        if time.monotonic() > until_s:
            return back("/library", f"{file.name} is not in the library yet.", "warning")
        context.scanner.soon()
        time.sleep(_LOOK_S)


def entry_page(request: Request) -> Response:
    """The page of an entry as smarig wrote it, without access to the console."""
    context = context_of(request)
    path = finished_page(context, context.library.entry(request.path_params["id"]))
    if path is None:
        raise UsageError("This entry has no page yet.")
    return report_response(request, path)


async def change(request: Request) -> Response:
    """Tags, a note, or an evaluation."""
    form = dict(await form_texts(request))
    return await run_in_threadpool(_changed, request, form)


def _changed(request: Request, form: Mapping[str, str]) -> Response:
    context, id, wanted = context_of(request), request.path_params["id"], request.path_params["wanted"]
    if wanted == "tags":
        context.library.tag(id, [t.strip() for t in form.get("tags", "").split(",") if t.strip()])
        return back(f"/library/{id}", "The tags were saved.")
    if wanted == "notes":
        context.library.note(id, form.get("note", ""))
        return back(f"/library/{id}", "The note was added.")
    name = form.get("job", "")
    start_evaluation(context, context.library.entry(id), name, form.get("choice", ""))
    return RedirectResponse(f"/library/{id}#{name}", status_code=303)


def evaluations(request: Request) -> JSONResponse:
    """A text that changes when an evaluation of the entry ends, and when its page is in the library."""
    context = context_of(request)
    shown = _evaluations(context, context.library.entry(request.path_params["id"]))
    return JSONResponse({"version": shown["version"]})


async def open_viewer(request: Request) -> Response:
    """Start the viewer of a run. In the main thread, with which it ends."""
    context, id = context_of(request), request.path_params["id"]
    found = await run_in_threadpool(context.library.entry, id)
    if found.kind != RUN:
        raise UsageError("The viewer shows runs.")
    context.viewers.start(found.path)
    await run_in_threadpool(context.viewers.wait, found.path)
    return RedirectResponse(f"/library/{id}#viewer", status_code=303)


async def compare(request: Request) -> Response:
    """A page that compares the chosen runs."""
    ids = [value for name, value in await form_texts(request) if name == "id"]
    return await run_in_threadpool(_compared, request, ids)


def _compared(request: Request, ids: list[str]) -> Response:
    context = context_of(request)
    if len(ids) < 2:
        return back("/library", "Choose two runs or more.", "warning")
    path = compared_page(context, [context.library.entry(id) for id in ids])
    return report_response(request, path)


def trends(request: Request) -> HTMLResponse:
    """How the figures of a wire have changed over its runs."""
    context, wire = context_of(request), request.query_params.get("wire", "")
    found = context.library.trends(wire)
    rows = [
        {
            "name": _words(name),
            "unit": trend.unit,
            "low": f"{min(trend.values):.4g}",
            "high": f"{max(trend.values):.4g}",
            "points": list(zip(map(_moment, trend.epochs), trend.values)),
            "path": loop_path(trend.epochs.tolist(), trend.values.tolist()),
        }
        for name, trend in found.items()
        if len(trend.values)
    ]
    return page(request, "trends.html", {"wire": wire, "rows": rows}, here="library")


def _row(context: ConsoleContext, entry: Entry) -> dict[str, Any]:
    u, y = context.library.loop(entry.id)
    return {
        "id": entry.id,
        "name": entry.name,
        "kind": entry.kind,
        "began": _moment(entry.began),
        "wire": entry.wire,
        "protocol": entry.protocol,
        "verdict": entry.verdict,
        "level": entry.verdict if entry.verdict in ("good", "bad") else "",
        "sentence": entry.sentence or entry.error,
        "tags": entry.tags,
        "loop": loop_path(u.tolist(), y.tolist()),
    }


def _conditions(details: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What a run was started with: its settings, the effects of its twin, and the notes of its start."""
    settings = ", ".join(f"{key} = {value}" for key, value in (details.get("settings") or {}).items())
    effects = ", ".join(details.get("effects") or ())
    rows = [
        ("Settings", settings),
        ("Injected effects", effects),
        ("Notes at the start", details.get("notes")),
    ]
    return [(name, str(text)) for name, text in rows if text]


def _evaluations(context: ConsoleContext, entry: Entry) -> dict[str, Any]:
    """What the page shows of the evaluations of an entry."""
    jobs = evaluations_of(context, entry)
    return {
        "jobs": jobs,
        "version": f"{zlib.crc32(repr(jobs).encode('utf-8', 'replace')):08x}",
        "computing": any(job.since or job.awaits_page for job in jobs),
    }


def _words(name: str) -> str:
    """A figure in words; "A_s (degC)" and the like are the field's own."""
    return _FIGURES.get(name, name)


def _figure(figure: Any) -> str:
    interval = f" ({figure.ci95[0]:.4g} to {figure.ci95[1]:.4g})" if figure.ci95 else ""
    return f"{figure.value:.4g} {figure.unit}{interval}"


def _query(query: Mapping[str, str], offset: int) -> str:
    return urlencode({**{k: v for k, v in query.items() if v and k != "offset"}, "offset": offset})


def _epoch(day: str, later_s: float = 0.0) -> float | None:
    """Seconds since 1970 of a day as a form gives it; None if it gives none."""
    try:
        return time.mktime(time.strptime(day, "%Y-%m-%d")) + later_s
    except (ValueError, OverflowError):
        return None


def _moment(epoch: float | None) -> str:
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(epoch)) if epoch else ""


ROUTES = [
    Route("/library", library),
    Route("/library/trends", trends),
    Route("/library/compare", compare, methods=["POST"]),
    Route("/library/run", run_entry),
    Route("/library/{id:str}", entry),
    Route("/library/{id:str}/page", entry_page),
    Route("/library/{id:str}/evaluations", evaluations),
    Route("/library/{id:str}/viewer", open_viewer, methods=["POST"]),
    Route("/library/{id:str}/{wanted:str}", change, methods=["POST"]),
]
