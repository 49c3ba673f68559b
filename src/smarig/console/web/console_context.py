"""What the pages work on: one folder with its queue and its library, and the templates. Nothing else is shared.

Where the console writes. Whoever made its folder also chose the links in it, which could lead anywhere.
"""

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from starlette.convertors import Convertor, register_url_convertor
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.templating import Jinja2Templates

from smarig.console.library.library import Library
from smarig.console.queue.queue import Queue
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.console.web.evaluation_jobs import EvaluationJobs
from smarig.console.web.library_scanner import LibraryScanner
from smarig.console.web.rig_checks import RigChecks
from smarig.console.web.viewers import Viewers
from smarig.core import UsageError, place_inside, shown


def is_own_place(place: Path, folder: Path) -> bool:
    """Whether a place below the folder of a console is no link, and lies behind none."""
    return place_inside(place, folder) == folder.resolve() / place.relative_to(folder)


def own_place(place: Path, folder: Path) -> Path:
    """A place below the folder of a console. Raises UsageError if it is a link, or lies behind one."""
    if not is_own_place(place, folder):
        raise UsageError(
            f"{shown(str(place.relative_to(folder)))} is a link, or lies behind one. Remove the link: the console "
            "writes there, and only into its own folder."
        )
    return place


def _encodable(value: Any) -> Any:
    """A name of a file that is no UTF-8 is shown with marks; it must not end the page."""
    if type(value) is str and not value.isascii():
        return value.encode("utf-8", "replace").decode()
    return value


TEMPLATES = Jinja2Templates(Path(__file__).parent / "templates")
TEMPLATES.env.finalize = _encodable
LONGEST_NUMBER = 18  # digits of the number of an entry
_LEVELS = ("good", "warning", "bad")


@dataclass(frozen=True, eq=False)
class ConsoleContext:
    """The folder that a console serves. ``rig`` is the rig that forms begin with; ``closing``: the console ends."""

    folder: Path
    rig: str
    queue: Queue
    library: Library
    scanner: LibraryScanner
    scope: ConsoleScope
    ended_runs: EndedRuns
    viewers: Viewers
    rig_checks: RigChecks
    evaluations: EvaluationJobs = field(default_factory=EvaluationJobs)
    closing: threading.Event = field(default_factory=threading.Event)


class EntryNumber(Convertor[int]):
    """A number of an entry in an address, ``{number:entry}``: as many digits as the database can hold."""

    regex = f"[0-9]{{1,{LONGEST_NUMBER}}}"

    def convert(self, value: str) -> int:
        """The number."""
        return int(value)

    def to_string(self, value: int) -> str:
        """The digits."""
        return str(value)


register_url_convertor("entry", EntryNumber())


def context_of(request: Request) -> ConsoleContext:
    """The context of the application that answers a request."""
    return request.app.state.context


async def form_texts(request: Request) -> list[tuple[str, str]]:
    """The texts of a form, in order. Files that came with it are closed. Raises UsageError for a null character."""
    async with request.form() as form:
        texts = [(name, value) for name, value in form.multi_items() if isinstance(value, str)]
    if any("\0" in value for _, value in texts):
        raise UsageError("A text of the form holds a null character.")
    return texts


def named_file(text: str) -> Path:
    """The file that an address names, without links. Raises UsageError for a text that no file can have as its name."""
    try:
        text.encode()
        return Path(text).resolve()
    except (OSError, ValueError, RuntimeError):  # too long, no characters of a name, links in a circle
        raise UsageError(f"{shown(text)} is no name of a file.") from None


def page(
    request: Request, template: str, values: Mapping[str, Any], *, here: str = "", status: int = 200
) -> HTMLResponse:
    """A page of the console. A message that the address carries is shown above its content, as text."""
    text = request.query_params.get("message", "")
    level = request.query_params.get("level", "")
    message = {"text": text[:1000], "level": level if level in _LEVELS else ""} if text else None
    shared = {"here": here, "folder": str(context_of(request).folder), "message": message, "reading": False}
    return TEMPLATES.TemplateResponse(request, template, {**shared, **values}, status_code=status)


def back(place: str, text: str = "", level: str = "good") -> Response:
    """Show another page after a request that changed something, with a message."""
    joint = "&" if "?" in place else "?"
    query = joint + urlencode({"message": text, "level": level}) if text else ""
    return RedirectResponse(place + query, status_code=303)
