"""The form of a new run, or of an entry that waits: made from a protocol's settings, previewed before it starts."""

import math
import os
from collections.abc import Mapping
from itertools import groupby
from pathlib import Path, PurePath
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route

from smarig.config import RigFile, load_campaign, shipped_names
from smarig.console.own_code import own_code_digest, own_code_text
from smarig.console.queue.allowed_entries import own_code_of_request
from smarig.console.queue.ensure_worker import ensure_worker
from smarig.console.queue.entry_preview import EntryPreview, preview_entry
from smarig.console.queue.entry_request import EntryRequest, Kind, shown_command
from smarig.console.queue.queue_entry import EntryState
from smarig.console.web.console_context import ConsoleContext, back, context_of, form_texts, page
from smarig.console.web.protocol_form import FormField, protocol_form
from smarig.console.web.rig_files import RigEntry, rig_entry, rig_names
from smarig.core import SmarigError, UsageError, catalogue_names, catalogue_summary, shown
from smarig.protocols import PROTOCOLS
from smarig.report import duration

CHARACTERISE = "characterise:"  # before the name of the campaign that a characterisation runs
_CAMPAIGN = "campaign:"
_FIRST = _CAMPAIGN + "quick_look"  # what the form of a newcomer begins with
_TEXTS = ("load", "wire", "notes", "out")


async def new_run(request: Request) -> Response:
    """The form, its preview, and the request that adds the run to the queue."""
    return await _form(request, None)


async def edit_entry(request: Request) -> Response:
    """The form of an entry that waits."""
    return await _form(request, request.path_params["number"])


async def _form(request: Request, number: int | None) -> Response:
    context = context_of(request)
    if request.method == "GET":
        values = dict(request.query_params)
        if number is not None and "experiment" not in values:
            values = _values_of(context.queue.entry(number).request)
        return await run_in_threadpool(_shown, request, context, values, number)
    values = dict(await form_texts(request))
    return await run_in_threadpool(_requested, request, context, values, number)


def _requested(
    request: Request, context: ConsoleContext, values: dict[str, str], number: int | None
) -> Response:
    try:
        wanted = entry_request_of(values)
        rig = rig_entry(wanted.rig, context.folder, context.scope.opened)
        if rig.closed:
            raise UsageError(rig.closed[0])
        code = own_code_of_request(wanted, context.folder, rig_is_opened=rig.is_opened)
        if own_code_digest(code) != values.get("code", ""):
            raise UsageError(
                f"This runs {own_code_text(code)}. Press the button again to allow it."
                if code
                else "The own code that was shown is not run any more. Press the button again."
            )
        if values.get("do") == "preview":
            return _shown(request, context, values, number, preview=preview_entry(wanted, context.folder))
        if number is None:
            context.queue.add(wanted)
            ensure_worker(context.folder)
            added = f"{wanted.experiment} was added to the queue"
            if context.queue.state().paused:
                return back(
                    "/", f"{added}, which is paused. It starts when you continue the queue.", "warning"
                )
            return back("/", f"{added}.")
        context.queue.edit(number, wanted)
        return back("/", "The entry was changed.")
    except SmarigError as error:
        return _shown(request, context, values, number, error=str(error))


def entry_request_of(values: Mapping[str, str]) -> EntryRequest:
    """What a form asks for. Fields that are empty are left to the command. Raises UsageError."""
    experiment = values.get("experiment", "")
    name = experiment
    kind: Kind = "protocol"
    if experiment.startswith(CHARACTERISE):
        kind, name = "characterise", experiment.removeprefix(CHARACTERISE)
    elif experiment.startswith(_CAMPAIGN):
        kind, name = "campaign", experiment.removeprefix(_CAMPAIGN)
    given = {k: v.strip() for k, v in values.items() if v.strip()}
    settings = {k.removeprefix("set."): v for k, v in given.items() if k.startswith("set.")}
    defaults = {f.key: f.default for f in protocol_form(name)} if kind == "protocol" else {}
    only_of_run = kind != "characterise"
    return EntryRequest(
        kind=kind,
        experiment=name,
        rig=given.get("rig", ""),
        out=given.get("out", ""),
        settings={k: v for k, v in settings.items() if v != defaults.get(k)},
        effects=tuple(part.strip() for part in given.get("effects", "").split(",") if part.strip()),
        seed=int(_number("Seed", given.get("seed", "0"))),
        speed=_number("Speed", given["speed"]) if only_of_run and "speed" in given else None,
        load=given.get("load", "") if only_of_run else "",
        wire=given.get("wire", ""),
        notes=given.get("notes", "") if only_of_run else "",
    )


def _number(name: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise UsageError(f"{name}: {shown(text)} is not a number.")
    return number


def _values_of(request: EntryRequest) -> dict[str, str]:
    """The fields of a form for a request."""
    start = {"characterise": CHARACTERISE, "campaign": _CAMPAIGN}.get(request.kind, "")
    values = {name: getattr(request, name) for name in _TEXTS}
    values |= {f"set.{key}": value for key, value in request.settings.items()}
    values |= {"seed": str(request.seed), "speed": "" if request.speed is None else f"{request.speed:g}"}
    values |= {"rig": request.rig, "experiment": start + request.experiment}
    return values | {"effects": ", ".join(request.effects)}


def _shown(
    request: Request,
    context: ConsoleContext,
    values: Mapping[str, str],
    number: int | None,
    *,
    preview: EntryPreview | None = None,
    error: str = "",
) -> HTMLResponse:
    rig = values.get("rig") or context.rig
    experiment = values.get("experiment") or _FIRST
    entry = rig_entry(rig, context.folder, context.scope.opened)
    file, text, fields = entry.file, "", ()
    try:
        if file is None and not entry.closed:
            raise UsageError(entry.problems[0])
        text, fields = _experiment(experiment)
    except SmarigError as problem:
        error, file = error or str(problem), None
    shown = {
        **_choices(rig, context.folder),
        "rig": rig,
        "rig_text": _rig_text(file),
        "rig_problems": entry.closed or (entry.problems if file else ()),
        "rig_wire": file.wire if file else "",
        "is_twin": file is not None and (file.kind == "twin" or file.simulator is not None),
        "experiment": experiment,
        "experiment_text": text,
        "is_characterisation": experiment.startswith(CHARACTERISE),
        "is_folder": experiment.startswith((CHARACTERISE, _CAMPAIGN)),
        "groups": [(name, list(group)) for name, group in groupby(fields, _group)],
        "values": {k.removeprefix("set."): v for k, v in values.items() if k.startswith("set.")},
        "out": values.get("out") or _free_name(context, experiment),
        "entry_id": number,
        "action": "/new" if number is None else f"/queue/{number}/edit",
        "busy": any(
            e.state in (EntryState.WAITING, EntryState.RUNNING) for e in context.queue.entries(newest=0)
        ),
        "paused": context.queue.state().paused,
        "preview": _preview(preview, file) if preview else None,
        "error": error,
        "command": _command(context, values, rig, experiment),
        **_code(context, values, entry, experiment),
        **{name: values.get(name, "") for name in ("wire", "load", "notes", "effects", "speed")},
        "seed": values.get("seed") or "0",
    }
    return page(request, "new_run.html", shown, here="new", status=422 if error else 200)


def _choices(rig: str, folder: Path) -> dict[str, list[tuple[str, str]]]:
    campaigns = [(name, name.replace("_", " ")) for name in shipped_names("campaigns")]
    rigs = [(name, "") for name in rig_names(folder)]
    return {
        "rigs": rigs if rig in dict(rigs) else [(rig, ""), *rigs],
        "protocols": [(name, name.replace("_", " ")) for name in catalogue_names(PROTOCOLS)],
        "campaigns": [(_CAMPAIGN + name, text) for name, text in campaigns],
        "characterisations": [(CHARACTERISE + name, text) for name, text in campaigns if _trains(name)],
    }


def _trains(campaign: str) -> bool:
    """Whether a campaign has runs to identify a model from; a characterisation needs one."""
    return any(step.purpose == "train" for step in load_campaign(campaign).step)


def _experiment(experiment: str) -> tuple[str, tuple[FormField, ...]]:
    """What an experiment does, and the fields of its settings."""
    for start, after in (
        (CHARACTERISE, " Then a model is identified, verified and diagnosed."),
        (_CAMPAIGN, ""),
    ):
        if experiment.startswith(start):
            return load_campaign(experiment.removeprefix(start)).summary + after, ()
    return catalogue_summary(PROTOCOLS, experiment), protocol_form(experiment)


def _group(field: FormField) -> str:
    return (
        "Settings"
        if not field.group
        else {"settle": "When a step counts as settled"}.get(field.group, field.group)
    )


def _rig_text(file: RigFile | None) -> str:
    if file is None:
        return ""
    bench = "Bench with simulated devices" if file.simulator else "Bench: real current"
    return f"{'Twin' if file.kind == 'twin' else bench}; {file.actuator}, tick {file.period_s:g} s"


def _free_name(context: ConsoleContext, experiment: str) -> str:
    """A name in the folder that neither a file nor an entry has."""
    folder = experiment.startswith((CHARACTERISE, _CAMPAIGN))
    stem, end = (
        experiment.rpartition(":")[2].rpartition("/")[2].removesuffix(".toml"),
        "" if folder else ".run.sqlite",
    )
    taken = {PurePath(e.request.out).name for e in context.queue.entries()}
    k = 1
    while (name := f"{stem}_{k:03d}{end}") in taken or os.path.lexists(context.folder / name):
        k += 1
    return name


def _command(context: ConsoleContext, values: Mapping[str, str], rig: str, experiment: str) -> str:
    try:
        start = {"rig": rig, "experiment": experiment, "out": _free_name(context, experiment)}
        return shown_command(
            entry_request_of({**start, **{k: v for k, v in values.items() if v}}), context.folder
        )
    except SmarigError as error:
        return str(error)


def _code(
    context: ConsoleContext, values: Mapping[str, str], rig: RigEntry, experiment: str
) -> dict[str, str]:
    """The own code that the buttons would run, in words, and its digest, which they send."""
    try:
        start = {"rig": rig.name, "experiment": experiment, "out": "x"}
        wanted = entry_request_of({**start, **{k: v for k, v in values.items() if v}})
    except SmarigError:
        return {"code": "", "code_digest": ""}
    code = () if rig.closed else own_code_of_request(wanted, context.folder, rig_is_opened=rig.is_opened)
    return {"code": own_code_text(code), "code_digest": own_code_digest(code)}


def _preview(found: EntryPreview, file: RigFile | None) -> dict[str, Any]:
    limits = file.limits if file else None
    return {
        "rows": [
            {
                "protocol": run["protocol"].replace("_", " "),
                "duration": duration(run["duration_s"]),
                "steps": run["steps"],
                "current": _current(run),
                "temperature": f"{run['peak_temperature_K']:.0f} K above ambient",
                "timed_out": run["timed_out"],
            }
            for run in found.runs
        ],
        "total": duration(found.duration_s),
        "limits": f"Limits of the rig: {limits.current_max_A:g} A, {limits.temperature_max_K:g} K."
        if limits
        else "",
    }


def _current(run: Mapping[str, Any]) -> str:
    lower_A = run.get("without_lease_A")
    lower = f" (at most {lower_A:.3g} A if its source turns out to have no lease)" if lower_A else ""
    return f"{run['peak_current_A']:.3g} A{lower}"


ROUTES = [
    Route("/new", new_run, methods=["GET", "POST"]),
    Route("/queue/{number:entry}/edit", edit_entry, methods=["GET", "POST"]),
]
