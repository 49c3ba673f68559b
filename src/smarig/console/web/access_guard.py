"""Who may use the console: a browser of this computer that was given the token, and pages of the console itself.

One middleware guards every route. A request must name this server as its host, so that another name that resolves to
loopback (DNS rebinding) reaches nothing. It must carry the token, in the address once and in a cookie afterwards. What
changes something must come from a page of the console (``Origin``, or ``Sec-Fetch-Site``), whatever cookies it has.
A null character has no meaning in an address, and what lies behind (files, SQLite) fails on it: it is refused here.
"""

import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

from smarig.report import LIBRARY

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Application = Callable[[Scope, Receive, Send], Awaitable[None]]

TOKEN = "token"  # the parameter of the address
_READING = frozenset({"GET", "HEAD"})
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; form-action 'self'; frame-src 'self'; frame-ancestors 'self'; base-uri 'none'"
)
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "same-origin",  # with no-referrer, the forms of the console itself carry "Origin: null"
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "cache-control": "no-store",
}


@dataclass(frozen=True)
class AccessGuard:
    """ASGI middleware before ``app``; ``port`` is that of the server.

    ``admit`` is told the address of each client that has shown the token.
    """

    app: Application
    token: str
    port: int
    admit: Callable[[Any], None] = lambda _client: None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it."""
        if scope["type"] != "http":  # the console has no websockets
            if scope["type"] == "websocket":
                await send({"type": "websocket.close", "code": 1008})
            return
        headers = {k.decode("latin-1"): v.decode("latin-1") for k, v in scope["headers"]}
        reason = self._refusal(scope, headers)
        if reason:
            await _answer(send, 403, reason)
            return
        if scope["method"] in _READING and scope["path"].endswith(
            f"/{LIBRARY}"
        ):  # for pages without an origin
            await self.app(scope, receive, _with_headers(send))
            return
        query = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        in_address = self._is_token(dict(query).get(TOKEN, ""))
        if not in_address and not self._is_token(_cookies(headers).get(self.cookie, "")):
            await _answer(
                send, 403, "The token is missing or wrong. Open the address that smarig console printed."
            )
            return
        self.admit(scope.get("client"))
        if _is_malformed(scope, query):
            await _answer(send, 400, "The address holds a null character, or one that is not ASCII.")
        elif in_address:
            await self._remember(scope, query, send)
        else:
            await self.app(scope, receive, _with_headers(send))

    @property
    def cookie(self) -> str:
        """The name of the cookie; cookies do not tell ports apart, so the name does."""
        return f"smarig-console-{self.port}"

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> str:
        hosts = {f"{name}:{self.port}" for name in ("127.0.0.1", "localhost")}
        if headers.get("host", "") not in hosts:
            return "This address is not that of the console."
        origin, site = headers.get("origin"), headers.get("sec-fetch-site")
        if origin is not None and origin not in {f"http://{host}" for host in hosts}:
            return "Requests of other pages are refused."
        if scope["method"] not in _READING and origin is None and site != "same-origin":
            return "A request that changes something must come from a page of the console."
        if scope["method"] not in _READING and site not in (None, "same-origin"):
            return "Requests of other pages are refused."
        return ""

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode("utf-8", "replace"), self.token.encode())

    async def _remember(self, scope: Scope, query: list[tuple[str, str]], send: Send) -> None:
        """Keep the token in a cookie, and show the same page without it in its address."""
        rest = urlencode([(k, v) for k, v in query if k != TOKEN])
        place = "/" + quote(scope["path"].lstrip("/")) + (f"?{rest}" if rest else "")
        cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"
        await _answer(send, 303, "", {"location": place, "set-cookie": cookie})


def _is_malformed(scope: Scope, query: list[tuple[str, str]]) -> bool:
    texts = [scope["path"], *(text for pair in query for text in pair)]
    return not scope["query_string"].isascii() or any("\0" in text for text in texts)


def _cookies(headers: dict[str, str]) -> dict[str, str]:
    """Cookies of all ports of this computer arrive together: one that is badly formed must not hide the console's."""
    pairs = (part.partition("=") for part in headers.get("cookie", "").split(";"))
    return {name.strip(): value.strip() for name, _, value in pairs}


def _with_headers(send: Send) -> Send:
    async def sending(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            present = {name.lower() for name, _ in message["headers"]}
            own = {"content-security-policy": POLICY, **_HEADERS}
            extra = [(k.encode(), v.encode()) for k, v in own.items() if k.encode() not in present]
            message = {**message, "headers": [*message["headers"], *extra]}
        await send(message)

    return sending


async def _answer(send: Send, status: int, text: str, headers: dict[str, str] | None = None) -> None:
    closing = {"connection": "close"} if status == 403 else {}  # it has shown nothing that would keep it open
    every = {"content-type": "text/plain; charset=utf-8", **_HEADERS, **closing, **(headers or {})}
    start = {
        "type": "http.response.start",
        "status": status,
        "headers": [(k.encode(), v.encode("latin-1")) for k, v in every.items()],
    }
    await send(start)
    await send({"type": "http.response.body", "body": text.encode()})
