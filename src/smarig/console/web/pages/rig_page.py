"""The rigs: what each is, whether it is in use, what its file lacks; and the bring-up of one that has devices."""

import time
from collections.abc import Sequence
from typing import Any
from urllib.parse import urlencode

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route

from smarig.config import RigFile
from smarig.console.own_code import own_code_digest, own_code_of_rig, own_code_text
from smarig.console.web.console_context import ConsoleContext, back, context_of, form_texts, page
from smarig.console.web.console_scope import drives_bench
from smarig.console.web.rig_checks import RigCheck
from smarig.console.web.rig_files import RigEntry, rig_entry, rigs_of
from smarig.core import Requester, UsageError
from smarig.plant import Actuator
from smarig.running import RunInProgress, runs_in_progress, stop_runs


def rigs(request: Request) -> HTMLResponse:
    """The list."""
    context = context_of(request)
    runs = runs_in_progress()
    rows = [_row(each, context, runs) for each in rigs_of(context.folder, context.scope.opened)]
    return page(request, "rigs.html", {"rigs": rows}, here="rigs")


def one_rig(request: Request) -> HTMLResponse:
    """The page of one rig."""
    context, name = context_of(request), request.query_params.get("rig", "")
    entry, runs = _entry(context, name), runs_in_progress()
    code = () if entry.closed else own_code_of_rig(name, context.folder, opened=entry.is_opened)
    shown = {
        **_row(entry, context, runs),
        "problems": entry.problems,
        "closed": entry.closed,
        "closed_mark": entry.closed_mark,
        "facts": _facts(entry.file) if entry.file and not entry.closed else [],
        "links": _links(entry.file) if entry.file else [],
        "is_bench": entry.is_bench and not entry.problems and not entry.closed,
        "is_real": entry.is_real,
        "code": own_code_text(code),
        "code_digest": own_code_digest(code),
        "check": _check(_check_in_progress(entry, runs) or context.rig_checks.of(name)),
        "is_driven": bool(_on_its_wire(entry, runs)),
    }
    return page(request, "rig.html", shown, here="rigs")


async def check_rig(request: Request) -> Response:
    """Start the bring-up of a rig. A real wire is heated only after a tick in the box that says so."""
    context, form = context_of(request), dict(await form_texts(request))
    name = form.get("rig", "")
    entry = await run_in_threadpool(_entry, context, name)
    if entry.closed:
        raise UsageError(entry.closed[0])
    if not entry.is_bench or entry.problems:
        raise UsageError(entry.problems[0] if entry.problems else f"{name} has no devices to check.")
    code = await run_in_threadpool(own_code_of_rig, name, context.folder, opened=entry.is_opened)
    if own_code_digest(code) != form.get("code", ""):
        raise UsageError(
            f"The check would run {own_code_text(code)}, which was not shown. Open the page again."
        )
    if entry.is_real and form.get("heat") != "yes":
        raise UsageError(
            "The wire is heated gently, and its lease expires once. Tick the box if you are beside the rig."
        )
    await run_in_threadpool(context.rig_checks.start, name)
    context.scope.open_rig(entry.file)
    return back(f"/rigs/rig?{urlencode({'rig': name})}")


async def open_rig(request: Request) -> Response:
    """Open what a rig names outside of the folder, as it was shown: from now on the person has named this rig."""
    context, form = context_of(request), dict(await form_texts(request))
    name = form.get("rig", "")
    entry = await run_in_threadpool(rig_entry, name, context.folder)
    if entry.closed_mark != form.get("mark", ""):
        raise UsageError("What this rig names has changed since it was shown. Open the page again.")
    context.scope.opened.add(entry.closed_mark)
    return back(f"/rigs/rig?{urlencode({'rig': name})}")


async def stop_rig(request: Request) -> Response:
    """Stop whatever drives the wire of a rig, of any folder: somebody beside the rig must not look for its owner."""
    context, name = context_of(request), dict(await form_texts(request)).get("rig", "")
    return await run_in_threadpool(_stopped, context, name)


def _stopped(context: ConsoleContext, name: str) -> Response:
    runs = _on_its_wire(_entry(context, name), runs_in_progress())
    stop_runs(runs, f"'Stop this rig' in the console of {context.folder}", Requester.CONSOLE)
    text = "The rig is asked to stop: the current goes to zero." if runs else "Nothing drives this rig."
    return back(
        f"/rigs/rig?{urlencode({'rig': name}, errors='replace')}", text, "warning" if runs else "good"
    )


def _entry(context: ConsoleContext, name: str) -> RigEntry:
    return rig_entry(name, context.folder, context.scope.opened)


def _row(entry: RigEntry, context: ConsoleContext, runs: Sequence[RunInProgress]) -> dict[str, Any]:
    """The rig in a line: name, kind, wire, and its state in words with a level."""
    text, level = _state(entry, context, runs)
    file = entry.file
    return {
        "name": entry.name,
        "kind": entry.kind,
        "actuator": file.actuator if file else "",
        "wire": file.wire if file else "",
        "state": text,
        "level": level,
    }


def _state(entry: RigEntry, context: ConsoleContext, runs: Sequence[RunInProgress]) -> tuple[str, str]:
    if entry.closed:
        return f"Not opened: {entry.closed[0]}", "warning"
    if entry.is_template:
        return "Template: copy it, and give the addresses of your devices", ""
    if entry.problems:
        return f"Not ready: {entry.problems[0]}", "bad"
    assert entry.file is not None  # noqa: S101 - without a file there is a problem
    same_wire = _on_its_wire(entry, runs)
    if same_wire and not same_wire[0].is_check:
        return f"In use: {str(same_wire[0].info['protocol']).replace('_', ' ')}", "warning"
    last = _check_in_progress(entry, runs) or context.rig_checks.of(entry.name)
    if last is None and entry.has_own_driver:
        return "Its own driver is run by a check only", ""
    if last is None:
        return ("Its file is in order; not brought up here", "") if entry.is_bench else ("Ready", "good")
    at = time.strftime("%H:%M", time.localtime(last.began))
    if last.passed is None:
        return f"Being checked since {at}", "warning"
    return (f"Fit to run, checked at {at}", "good") if last.passed else (f"Check at {at} failed", "bad")


def _on_its_wire(entry: RigEntry, runs: Sequence[RunInProgress]) -> list[RunInProgress]:
    """The runs and checks that use the wire of a bench; twins have one each."""
    file, driving = entry.file, [run for run in runs if drives_bench(run.info)]
    return [run for run in driving if file and entry.is_bench and run.info["wire"] == file.wire]


def _check_in_progress(entry: RigEntry, runs: Sequence[RunInProgress]) -> RigCheck | None:
    """The check in progress of a rig, whoever has started it."""
    checks = [run for run in _on_its_wire(entry, runs) if run.is_check]
    return RigCheck(began=checks[0].info["start_epoch"]) if checks else None


def _facts(file: RigFile) -> list[tuple[str, str]]:
    limits, actuator = file.limits, Actuator.named(file.actuator)
    return [
        ("Actuator", actuator.name),
        ("Wire", file.wire),
        ("Tick", f"{file.period_s:g} s"),
        ("Current", f"{limits.current_min_A:g} to {limits.current_max_A:g} A"),
        ("Current rate", f"at most {limits.current_rate_A_per_s:g} A/s"),
        ("Temperature", f"at most {limits.temperature_max_K:g} K above ambient"),
        ("Ambient temperature", f"{file.ambient_degC:g} °C"),
        ("Lease", f"{file.lease_s:g} s without the host, then the output switches off"),
        ("Resolution of the position", f"{actuator.resolution(file.encoder):.3g} {actuator.unit}"),
    ]


def _links(file: RigFile) -> list[tuple[str, str, str]]:
    """The devices: role, driver, address."""
    if file.links is None:
        return []
    simulated = file.simulator is not None and file.simulator.start
    return [
        (role.replace("_", " "), link.driver, "simulated" if simulated else link.url)
        for role in type(file.links).model_fields
        if (link := getattr(file.links, role)) is not None
    ]


def _check(found: RigCheck | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "since": time.strftime("%H:%M:%S", time.localtime(found.began)),
        "runs": found.passed is None,
        "passed": found.passed,
        "sentence": found.sentence,
        "rows": [
            {"name": c.get("name", ""), "observed": c.get("seen", ""), "word": _word(c)} for c in found.checks
        ],
    }


def _word(check: dict[str, Any]) -> str:
    if not check.get("passed"):
        return "failed"
    return "limitation" if check.get("limitation") else "passed"


ROUTES = [
    Route("/rigs", rigs),
    Route("/rigs/rig", one_rig),
    Route("/rigs/check", check_rig, methods=["POST"]),
    Route("/rigs/open", open_rig, methods=["POST"]),
    Route("/rigs/stop", stop_rig, methods=["POST"]),
]
