"""Study somebody's file: its columns and first loop, questions answered by choosing, then ``smarig study`` as it is."""

import json
import re
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Route

from smarig.console.command_process import run_command
from smarig.console.web.console_context import ConsoleContext, back, context_of, form_texts, own_place, page
from smarig.console.web.loop_path import loop_path
from smarig.console.web.report_response import report_response
from smarig.core import SmarigError, UsageError, file_bytes, printable
from smarig.exchange import find_tables
from smarig.study import SPLITS, STUDY_JSON, STUDY_PAGE, VERDICT_LEVELS, TableGuess, guess_table

UPLOADS, STUDIES = "console_uploads", "studies"
LARGEST_BYTES = 500_000_000
LONGEST_S = 1800.0
_KEY = re.compile(r"[0-9a-f]{12}")
_LONGEST_NAME = 100  # bytes
_ROWS, _COLUMNS, _POINTS = 5, 40, 1500


def study(request: Request) -> HTMLResponse:
    """The page before a file is chosen."""
    return page(request, "study.html", {"draft": None, "error": "", "result": None}, here="study")


async def upload(request: Request) -> Response:
    """Keep the file in the folder, and show its columns."""
    size = request.headers.get("content-length", "")
    if not size.isdecimal() or int(size) > LARGEST_BYTES:
        return _refused(
            request,
            f"The file is larger than {LARGEST_BYTES // 1_000_000} MB. Use smarig study at a terminal.",
        )
    async with request.form(max_files=1) as form:
        file = form.get("file")
        if not isinstance(file, UploadFile) or not file.filename:
            return _refused(request, "Choose a file.")
        folder = context_of(request).folder
        place = folder / UPLOADS / secrets.token_hex(6) / _safe_name(file.filename)
        try:
            await run_in_threadpool(_kept, file, own_place(place, folder))
        except UsageError as error:
            return _refused(request, str(error))
        except OSError as error:
            return _refused(request, f"The file could not be stored: {error.strerror or error}.")
    return back(f"/study/{place.parent.name}")


def draft(request: Request) -> HTMLResponse:
    """The columns of a file, with what they are taken for."""
    file = _file(context_of(request), request.path_params["key"])
    try:
        shown: dict[str, Any] = {
            "draft": _draft(file),
            "error": "",
            "result": _finished(context_of(request), file),
        }
    except SmarigError as error:
        return _refused(request, str(error).replace(str(file), file.name))
    return page(request, "study.html", shown, here="study")


async def start(request: Request) -> Response:
    """Study the file with the answers, and show its page."""
    return await run_in_threadpool(_studied, request, dict(await form_texts(request)))


def alone(request: Request) -> Response:
    """The page of a study, without access to the console."""
    context = context_of(request)
    path = _out(context, _file(context, request.path_params["key"])) / STUDY_PAGE
    if not path.is_file():
        raise UsageError("This file has not been studied yet.")
    return report_response(request, path)


def _studied(request: Request, form: Mapping[str, str]) -> Response:
    context = context_of(request)
    file = _file(context, request.path_params["key"])
    names = [form.get(name, "") for name in ("input", "output")]
    command = ["study", str(file), f"--input={names[0]}", f"--output={names[1]}", "--yes"]
    for column, unit in zip(names, (form.get("input_unit", ""), form.get("output_unit", ""))):
        command += [f"--unit={column}={unit.strip()}"] if unit.strip() else []
    split = form.get("split", "auto")
    command += [f"--split={split if split in SPLITS else 'auto'}", "-o", str(_out(context, file))]
    try:
        done = run_command(["smarig", *command], context.folder, LONGEST_S)
    except UsageError as error:
        return back(f"/study/{file.parent.name}", str(error), "bad")
    if not done.returncode:
        return back(f"/study/{file.parent.name}", "The file was studied. The result is below.")
    output_lines = [line for line in done.stderr.splitlines() if line.strip()]
    text = printable(" ".join(output_lines[-8:])).replace(str(file), file.name)
    return back(f"/study/{file.parent.name}", text or "The study failed.", "bad")


def _draft(file: Path) -> dict[str, Any]:
    tables = find_tables(file, [file])
    guess = guess_table(max(tables, key=len), files=[file.name])
    drive, out = guess.first("input"), guess.first("output")
    columns = guess.table.columns[:_COLUMNS]
    rows = [[f"{column.values[k]:.6g}" for column in columns] for k in range(min(_ROWS, len(guess.table)))]
    return {
        "key": file.parent.name,
        "name": file.name,
        "columns": [column.name for column in columns],
        "rows": rows,
        "reasons": _reasons(guess),
        "input": drive.name if drive else "",
        "output": out.name if out else "",
        "input_unit": drive.unit if drive else "",
        "output_unit": out.unit if out else "",
        "loop": _loop(guess),
        "splits": SPLITS,
    }


def _reasons(guess: TableGuess) -> list[str]:
    return [
        f"{column.name}: {guess.shown_role(column.name).role}; {guess.shown_role(column.name).reason}"
        for column in guess.columns[:_COLUMNS]
        if guess.shown_role(column.name).role != "ignored"
    ]


def _loop(guess: TableGuess) -> str:
    drive, out = guess.first("input"), guess.first("output")
    if drive is None or out is None:
        return ""
    values = {column.name: column.values for column in guess.table.columns}
    u, y = values[drive.name], values[out.name]
    known = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
    known = known[:: max(1, known.size // _POINTS)]
    return loop_path(u[known].tolist(), y[known].tolist())


def _finished(context: ConsoleContext, file: Path) -> dict[str, str] | None:
    """The verdict of the study in its own words, and its page; None before it was studied."""
    out = _out(context, file)
    if not (out / STUDY_PAGE).is_file():
        return None
    try:
        about = json.loads(file_bytes(out / STUDY_JSON))
    except (UsageError, OSError, ValueError):
        about = {}
    text = " ".join(about.get("sentences") or ()) or "The page of this file:"
    level = VERDICT_LEVELS.get(str(about.get("verdict")), "")
    return {"level": level, "text": text, "page": f"/study/{file.parent.name}"}


def _out(context: ConsoleContext, file: Path) -> Path:
    return own_place(context.folder / STUDIES / f"{file.stem}_{file.parent.name}", context.folder)


def _file(context: ConsoleContext, key: str) -> Path:
    folder = context.folder / UPLOADS / key
    is_known = _KEY.fullmatch(key) and own_place(folder, context.folder).is_dir()
    files = [p for p in folder.iterdir() if p.is_file()] if is_known else []
    if len(files) != 1:
        raise UsageError("This file is not in the folder any more. Choose it again.")
    return own_place(files[0], context.folder)


def _kept(file: UploadFile, place: Path) -> None:
    place.parent.mkdir(parents=True)
    with place.open("xb") as target:
        while block := file.file.read(1 << 20):
            target.write(block)


def _safe_name(name: str) -> str:
    """The last part of a name, with letters that every file system has; its ending tells the format."""
    last = re.split(r"[/\\]", name)[-1]
    plain = re.sub(r"[^\w .+()\-]", "_", last).strip(" .")
    return plain.encode()[-_LONGEST_NAME:].decode("utf-8", "ignore").strip(" .") or "data"


def _refused(request: Request, sentence: str) -> HTMLResponse:
    return page(
        request, "study.html", {"draft": None, "error": sentence, "result": None}, here="study", status=422
    )


ROUTES = [
    Route("/study", study),
    Route("/study", upload, methods=["POST"]),
    Route("/study/{key:str}", draft),
    Route("/study/{key:str}", start, methods=["POST"]),
    Route("/study/{key:str}/alone", alone),
]
