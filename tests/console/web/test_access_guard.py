"""Only a browser of this computer with the token, and pages of the console, reach it; all else is refused."""

import socket
import urllib.parse

import pytest

from console.web.started_console import Console, started_console


@pytest.fixture(scope="module")
def console(tmp_path_factory):
    folder = tmp_path_factory.mktemp("console")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder / "running"))
        with started_console(folder / "runs") as found:
            yield found


def test_the_token_is_kept_in_a_cookie_and_leaves_the_address(console: Console):
    reply = console.ask(f"/library?text=a&token={console.token}", headers={})
    assert (reply.status, reply.headers["location"]) == (303, "/library?text=a")
    assert "HttpOnly; SameSite=Strict" in reply.headers["set-cookie"]
    assert console.ask("/").status == 200


@pytest.mark.parametrize("path", ["/", "/static/run.js", "/stop-all", "/nowhere", "/overview/version"])
@pytest.mark.parametrize(
    "cookie", ["", "none=1", "smarig-console-{port}=wrong", "smarig-console-1={token}", "a=é"]
)
def test_without_the_token_nothing_is_shown(console: Console, path, cookie):
    cookie = cookie.format(port=console.port, token=console.token)
    reply = console.ask(path, headers={"Cookie": cookie.encode("latin-1")} if cookie else {})
    assert reply.status == 403
    assert "set-cookie" not in reply.headers
    assert console.token not in reply.body


@pytest.mark.parametrize("token", ["", "wrong", "%00", "%ff", "é".encode().hex(), "a" * 5000])
def test_a_wrong_token_is_refused(console: Console, token):
    assert console.ask(f"/?token={token}", headers={}).status == 403


@pytest.mark.parametrize("other", ["a=b{c}|", "bad name=1", "=", ';;;"', "a:b=1", '"'])
def test_cookies_of_other_ports_do_not_hide_that_of_the_console(console: Console, other):
    cookie = console.own["Cookie"]
    assert console.ask("/", headers={"Cookie": f"{other}; {cookie}"}).status == 200


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "localhost.evil:{port}", ""]
)
def test_another_host_is_refused(console: Console, host):
    reply = console.ask("/", headers={**console.own, "Host": host.format(port=console.port)})
    assert reply.status == 403
    assert (
        console.ask(f"/?token={console.token}", headers={"Host": host.format(port=console.port)}).status
        == 403
    )


def test_two_hosts_are_refused(console: Console):
    own = f"127.0.0.1:{console.port}"
    text = _raw(
        console, f"GET / HTTP/1.1\r\nHost: evil\r\nHost: {own}\r\nCookie: {console.own['Cookie']}\r\n\r\n"
    )
    assert text.startswith("HTTP/1.1 400")


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "https://127.0.0.1:{port}"},
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "none"},
        {"Origin": "http://127.0.0.1:{port}", "Sec-Fetch-Site": "cross-site"},
    ],
)
@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_what_changes_something_must_come_from_a_page_of_the_console(console: Console, headers, method):
    sent = {k: v.format(port=console.port) for k, v in headers.items()}
    reply = console.ask("/stop-all", method, {"Cookie": console.own["Cookie"], **sent})
    assert reply.status == 403
    assert "access-control-allow-origin" not in reply.headers


def test_a_page_of_the_console_may_change_something(console: Console):
    assert console.ask("/stop-all", "POST").status == 303
    sent = {"Cookie": console.own["Cookie"], "Sec-Fetch-Site": "same-origin"}
    assert console.ask("/stop-all", "POST", sent).status == 303


def test_reading_from_another_page_is_refused(console: Console):
    assert console.ask("/", headers={**console.own, "Origin": "http://evil.example"}).status == 403


@pytest.mark.parametrize("origin", [None, "http://evil.example"])
@pytest.mark.parametrize("has_cookie", [True, False])
def test_there_is_no_websocket(console: Console, origin, has_cookie):
    lines = [
        "GET / HTTP/1.1",
        f"Host: 127.0.0.1:{console.port}",
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        *([f"Origin: {origin}"] if origin else []),
        *([f"Cookie: {console.own['Cookie']}"] if has_cookie else []),
    ]
    answer = _raw(console, "\r\n".join([*lines, "", ""]))
    assert " 101 " not in answer.splitlines()[0]
    if origin or not has_cookie:
        assert answer.startswith("HTTP/1.1 403")


def test_every_page_has_the_policy(console: Console):
    for path in ("/", "/new", "/library", "/study", "/nowhere", "/static/run.js", "/library/1"):
        headers = console.ask(path).headers
        assert "default-src 'none'; script-src 'self'" in headers["content-security-policy"], path
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cache-control"] == "no-store"


@pytest.mark.parametrize("path", ["/smarig-figures.js", "/library/1/smarig-figures.js"])
def test_the_script_of_figures_needs_no_token_but_the_right_host(console: Console, path):
    reply = console.ask(path, headers={})
    assert (reply.status, reply.headers["content-type"].split(";")[0]) == (200, "text/javascript")
    assert "plotly" in reply.body[:2000].lower()
    assert console.ask(path, headers={"Host": "evil.example"}).status == 403
    assert console.ask(path, headers={}, method="POST").status == 403


@pytest.mark.parametrize("path", ["//evil.example", "/%5Cevil.example", "/%0d%0aX-Evil:%201", "/a%3Fb%23c"])
def test_the_redirect_after_the_token_stays_on_the_console(console: Console, path):
    reply = console.ask(f"{path}/?token={console.token}", headers={})
    place = reply.headers["location"]
    assert "x-evil" not in reply.headers
    assert urllib.parse.urlsplit(place).netloc == ""
    assert "\\" not in place
    assert not place.startswith("//")


def test_it_listens_on_loopback_only(console: Console):
    with open(f"/proc/{console.process.pid}/net/tcp") as file:  # noqa: PTH123
        rows = [line.split() for line in file.readlines()[1:]]
    own = [row[1] for row in rows if row[3] == "0A" and int(row[1].split(":")[1], 16) == console.port]
    assert own == [f"0100007F:{console.port:04X}"]


def _raw(console: Console, text: str) -> str:
    with socket.create_connection(("127.0.0.1", console.port), 30) as connection:
        connection.sendall(text.encode())
        return connection.recv(65536).decode()
