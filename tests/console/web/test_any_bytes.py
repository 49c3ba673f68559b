"""Whatever bytes a request is made of, the answer is a page or a sentence, never a failure of the server."""

import asyncio
import random
import re
from contextlib import ExitStack, closing
from urllib.parse import quote_from_bytes, urlencode

import pytest
from starlette.applications import Starlette
from starlette.routing import Route

from console.queue.entries import opened
from console.queue.entries import request as entry_request
from smarig.console.library.library import Library
from smarig.console.queue import ensure_worker, entry_preview
from smarig.console.web import evaluations, rig_checks, viewers
from smarig.console.web.access_guard import AccessGuard
from smarig.console.web.application import console_application
from smarig.console.web.console_context import ConsoleContext
from smarig.console.web.console_scope import ConsoleScope
from smarig.console.web.ended_runs import EndedRuns
from smarig.console.web.library_scanner import LibraryScanner
from smarig.console.web.pages import data_file_page, library_page
from smarig.console.web.rig_checks import RigChecks
from smarig.console.web.viewers import Viewers
from smarig.core import UsageError

PORT, TOKEN = 8765, "token-of-the-test"
HOST = f"127.0.0.1:{PORT}"
CAMPAIGN, LONG_CAMPAIGN = 1200, 20_000  # requests
FORM, MULTIPART = "application/x-www-form-urlencoded", "multipart/form-data; boundary=b"
NAMES = re.findall(
    r"\S+",
    "file text since until order offset tag wire rig protocol kind verdict model message level experiment out seed"
    " speed effects load notes do job choice tags note id input output input_unit split heat set.points code shown",
)
SOUND = (  # words that lead further in
    b"one_wire_twin one_wire_serial validation campaign:quick_look characterise:quick_look campaign: preview start"
    b" yes pause continue stop up down remove edit 1 2026-01-01 verify diagnose tags notes"
).split(b" ")
STRANGE = (
    rb"%|%00|%zz|..|/|//|/etc/passwd|absent.toml|absent.py|a.run.sqlite|-1|0|1e999|nan|inf|99999-99-99|'\";--"
    rb"|**********|\"a*\" OR NEAR(|{{7*7}}"
).split(b"|")
BROKEN = [
    b"",
    b"\0",
    b"a\0b",
    b"\xff\xfe",
    b"\xed\xa0\x80",
    b"\r\nX: y",
    b"\x1b[2J",
    "٣".encode() * 30,
    "²".encode(),
]
LONG = [b"9" * 20, b"9" * 5000, b"a" * 300, b"a/" * 3000, b"x" * 70_000]
VALUES = [*SOUND, *STRANGE, *BROKEN, *LONG]


@pytest.fixture(scope="module")
def application(tmp_path_factory):
    """The application of a folder, in this process. Nothing that it would start is started."""
    folder = tmp_path_factory.mktemp("any_bytes")

    def refuse(*_arguments, **_named):
        raise UsageError("Nothing is started here.")

    with pytest.MonkeyPatch.context() as patch, ExitStack() as stack:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder / "running"))
        patch.setattr(library_page, "_WAIT_S", 0.0)
        patch.setattr(ensure_worker, "_start", refuse)
        patch.setattr(rig_checks.RigChecks, "start", refuse)
        patch.setattr(viewers.Viewers, "start", refuse)
        for module in (entry_preview, evaluations, data_file_page):
            patch.setattr(module, "run_command", refuse)
        queue = stack.enter_context(opened(folder))
        queue.add(entry_request())
        library = Library.open(folder)
        scanner = stack.enter_context(LibraryScanner(library))
        started = [stack.enter_context(closing(each)) for each in (Viewers(), RigChecks(folder))]
        scope = ConsoleScope(folder)
        context = ConsoleContext(
            folder, "one_wire_twin", queue, library, scanner, scope, EndedRuns(scope), *started
        )
        yield console_application(context, TOKEN, PORT)


async def answer(application: AccessGuard, scope: dict, body: bytes) -> int:
    """The status of the answer to a request, passed on as the server does."""
    sent, received = [], [{"type": "http.request", "body": body, "more_body": False}]

    async def receive():
        if received:
            return received.pop()
        await asyncio.Event().wait()  # nothing more comes
        return {}

    async def send(message):
        sent.append(message)

    await application(scope, receive, send)
    assert sent, "no answer"
    return sent[0]["status"]


def request(chance: random.Random, routes: list[Route]) -> tuple[dict, bytes]:
    """A request that has the token, most often to a route that exists, with whatever in every place."""
    path = "/".join(part for part in _path(chance, chance.choice(routes)))
    fields = [(chance.choice(NAMES), _value(chance)) for _ in range(chance.choice((0, 0, 1, 2, 6)))]
    query = urlencode(fields) if chance.random() < 0.8 else _value(chance).decode("latin-1")
    method = chance.choice(("GET", "GET", "POST", "POST", "HEAD", "PUT", "\x7fBAD"))
    kind = chance.choice(
        (FORM, FORM, MULTIPART, "text/plain", "multipart/form-data", _value(chance).decode("latin-1"))
    )
    body = _body(chance, kind)
    headers = [
        ("host", HOST),
        ("origin", f"http://{HOST}"),
        ("cookie", f"smarig-console-{PORT}={TOKEN}"),
        ("content-type", kind),
        ("content-length", str(len(body)) if chance.random() < 0.9 else _value(chance).decode("latin-1")),
    ]
    if chance.random() < 0.3:
        name = chance.choice(
            ("range", "if-modified-since", "if-none-match", "accept", "x-any", "cookie", "expect")
        )
        headers.insert(chance.randrange(len(headers)), (name, _value(chance).decode("latin-1")))
    scope = {
        "type": "http",
        "method": method,
        "path": path,
        "raw_path": path.encode("utf-8", "replace"),
        "root_path": "",
        "query_string": query.encode("latin-1", "replace"),
        "headers": [(name.encode(), value.encode("latin-1")) for name, value in headers],
        "client": ("127.0.0.1", 4711),
        "server": ("127.0.0.1", PORT),
        "scheme": "http",
        "http_version": "1.1",
    }
    return scope, body


def _path(chance: random.Random, route: Route) -> list[str]:
    """The parts of an address of a route, with a value for each that is in braces."""
    parts = route.path.split("/")
    numbers = ("1", "9" * 18, "9" * 20, "-1")
    return (
        [_part(chance, numbers) if part.startswith("{") else part for part in parts]
        if chance.random() < 0.9
        else ["", _value(chance).decode("utf-8", "replace")]
    )


def _part(chance: random.Random, numbers: tuple[str, ...]) -> str:
    return chance.choice(numbers) if chance.random() < 0.3 else _value(chance).decode("utf-8", "replace")


def _value(chance: random.Random) -> bytes:
    if chance.random() < 0.8:
        return chance.choice(VALUES)
    return chance.randbytes(chance.choice((1, 3, 20, 300)))


def _body(chance: random.Random, kind: str) -> bytes:
    fields = [(chance.choice(NAMES), _value(chance)) for _ in range(chance.choice((0, 1, 3, 10)))]
    if kind == FORM:
        return "&".join(f"{name}={quote_from_bytes(value)}" for name, value in fields).encode()
    if kind == MULTIPART and chance.random() < 0.8:
        parts = [
            b'--b\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (n.encode(), v)
            for n, v in fields
        ]
        file = b'--b\r\nContent-Disposition: form-data; name="file"; filename="%s"\r\n\r\n%s\r\n'
        return b"".join(parts) + file % (_value(chance), _value(chance)) + b"--b--\r\n"
    return _value(chance)


def routes_of(application: AccessGuard) -> list[Route]:
    starlette = application.app
    assert isinstance(starlette, Starlette)
    return [route for route in starlette.routes if isinstance(route, Route)]


async def campaign(application: AccessGuard, requests: int) -> dict[int, int]:
    """How often each status was answered. Every request can be made again from its number."""
    routes, statuses = routes_of(application), {}
    for k in range(requests):
        scope, body = request(random.Random(k), routes)
        try:
            status = await answer(application, scope, body)
        except Exception as error:
            raise AssertionError(f"request {k}: {scope['method']} {scope['path'][:200]!r}") from error
        assert 200 <= status < 500, (
            f"request {k}: {status} for {scope['path'][:200]!r}, {scope['query_string'][:200]!r}"
        )
        statuses[status] = statuses.get(status, 0) + 1
    return statuses


def test_any_bytes_in_any_place_are_answered(application):
    statuses = asyncio.run(campaign(application, CAMPAIGN))
    assert statuses.keys() >= {200, 303, 400, 404, 422}, (
        "the campaign reaches pages, redirections and refusals"
    )


@pytest.mark.long
def test_many_requests_of_any_bytes_are_answered(application):
    print(asyncio.run(campaign(application, LONG_CAMPAIGN)))
