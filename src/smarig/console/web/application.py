"""The web application: all pages of the console behind its guard, with a sentence for whatever goes wrong."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

from smarig.console.web import report_response
from smarig.console.web.access_guard import AccessGuard
from smarig.console.web.console_context import ConsoleContext, page
from smarig.console.web.pages import (
    data_file_page,
    library_page,
    live_run_page,
    new_run_page,
    overview_page,
    rig_page,
)
from smarig.core import DataError, InUse, SmarigError, UsageError

_STATUS = ((InUse, 409), (UsageError, 422), (DataError, 422))


def console_application(
    context: ConsoleContext, token: str, port: int, admit: Callable[[Any], None] = lambda _client: None
) -> AccessGuard:
    """The application for a context, for browsers that have the token; ``admit`` is told of each."""
    application = Starlette(
        routes=[
            *report_response.ROUTES,
            *new_run_page.ROUTES,
            *overview_page.ROUTES,
            *live_run_page.ROUTES,
            *library_page.ROUTES,
            *data_file_page.ROUTES,
            *rig_page.ROUTES,
            Mount("/static", StaticFiles(directory=Path(__file__).parent / "static")),
        ],
        exception_handlers={SmarigError: _refused, HTTPException: _not_found, Exception: _failed},
    )
    application.state.context = context
    return AccessGuard(application, token, port, admit)


def _refused(request: Request, error: Exception) -> Response:
    status = next((number for kind, number in _STATUS if isinstance(error, kind)), 500)
    return page(request, "problem.html", {"sentence": str(error)}, status=status)


def _failed(request: Request, error: Exception) -> Response:
    sentence = f"This request failed ({type(error).__name__}). The terminal of the console says more."
    return page(request, "problem.html", {"sentence": sentence}, status=500)


def _not_found(request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 500
    sentence = "There is no such page." if status == 404 else f"This request is not possible ({status})."
    return page(request, "problem.html", {"sentence": sentence}, status=status)
