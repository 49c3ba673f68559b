"""A page of a report as the console shows it: without access to the console, with the script of its figures."""

from pathlib import Path

from starlette.requests import Request
from starlette.responses import FileResponse
from starlette.routing import Route

from smarig.report import LIBRARY, library_script


def report_response(request: Request, path: Path) -> FileResponse:
    """The page. It holds scripts of its own, and may come from somebody else: it runs without an origin, so that it can
    neither read the console nor send it anything. Of the console it may load scripts alone.
    """
    policy = (
        "sandbox allow-scripts allow-downloads allow-popups; default-src 'none'; "
        f"script-src 'unsafe-inline' http://{request.headers['host']}; "
        "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; frame-ancestors 'self'"
    )
    return FileResponse(path, media_type="text/html", headers={"content-security-policy": policy})


def _library(_request: Request) -> FileResponse:
    """Plotly's script, for a page without an origin."""
    headers = {"cross-origin-resource-policy": "cross-origin", "cache-control": "max-age=3600"}
    return FileResponse(library_script(), media_type="text/javascript", headers=headers)


# wherever a page looks for it: beside itself
ROUTES = [Route(f"/{LIBRARY}", _library), Route(f"/{{place:path}}/{LIBRARY}", _library)]
