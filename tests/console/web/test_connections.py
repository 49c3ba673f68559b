"""Connections without the token cannot keep its holder out, and neither they nor malformed requests fill the log."""

import http.client
import logging
import os
import resource
import select
import socket
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from console.web.started_console import Console, started_console
from smarig.console.web.connection_limit import EACH, WINDOW_S, LogLimit

DESCRIPTORS, CROWD = 256, 400


@contextmanager
def few_descriptors():
    """Processes that are started meanwhile have few descriptors."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (DESCRIPTORS, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


@pytest.fixture(scope="module")
def console(tmp_path_factory):
    folder = tmp_path_factory.mktemp("console")
    with pytest.MonkeyPatch.context() as patch, ExitStack() as stack:
        patch.setenv("SMARIG_RUNNING_DIR", str(folder / "running"))
        with few_descriptors():
            found = stack.enter_context(started_console(folder / "runs"))
        yield found


@contextmanager
def crowd(console: Console, says: bytes = b""):
    """Many connections that stay open and do not show the token."""
    with ExitStack() as stack:
        for _ in range(CROWD):
            one = stack.enter_context(socket.create_connection(("127.0.0.1", console.port), 30))
            one.sendall(says)
        yield


def descriptors(console: Console) -> int:
    return len(list(Path(f"/proc/{console.process.pid}/fd").iterdir()))


LONGER = pytest.mark.long("takes three seconds")


@pytest.mark.parametrize(
    "says",
    [
        pytest.param(b"", marks=LONGER),
        b"GET / HTTP/1.1\r\nHost: 127",
        pytest.param(b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n", marks=LONGER),
    ],
)
def test_the_holder_of_the_token_gets_in_beside_a_crowd_without_it(console: Console, says):
    with crowd(console, says):
        for _ in range(5):
            assert console.ask("/overview/version").status == 200
        assert descriptors(console) < DESCRIPTORS / 2, "the rest is for the queue, the library and streams"


@pytest.mark.long("takes five seconds")
def test_a_connection_that_has_shown_the_token_stays_open(console: Console):
    own = http.client.HTTPConnection("127.0.0.1", console.port, timeout=30)
    own.connect()
    kept = own.sock
    for _ in range(2):
        own.request("GET", "/overview/version", headers=console.own)
        assert own.getresponse().read()
        assert own.sock is kept
        with crowd(console):
            console.ask("/overview/version")
    own.close()


def test_a_connection_without_the_token_is_closed_after_its_answer(console: Console):
    with socket.create_connection(("127.0.0.1", console.port), 30) as one:
        one.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{console.port}\r\n\r\n".encode())
        text = b"".join(iter(lambda: one.recv(65536), b""))
    assert text.startswith(b"HTTP/1.1 403")


@pytest.mark.long("takes three seconds")
def test_malformed_requests_and_crowds_do_not_fill_the_log(console: Console):
    for _ in range(100):
        with socket.create_connection(("127.0.0.1", console.port), 30) as one:
            one.sendall(b"\x00\xff none\r\n\r\n")
            assert one.recv(100).startswith(b"HTTP/1.1 400")
    with crowd(console):
        assert console.ask("/overview/version").status == 200
    log = logged(console)
    assert log.count(b"Invalid HTTP request") == EACH
    assert len(log) < 2000


def logged(console: Console) -> bytes:
    """What the console has written so far."""
    text = b""
    while select.select([console.process.stderr], [], [], 0)[0]:
        text += os.read(console.process.stderr.fileno(), 1 << 16)
    return text


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def test_the_log_says_how_many_messages_were_left_out():
    clock = Clock()
    limit = LogLimit(clock)

    def passes(text: str, *values: object) -> str:
        record = logging.LogRecord("a", logging.WARNING, "", 0, text, values, None)
        return record.getMessage() if limit.filter(record) else ""

    assert [passes("lost %s", k) for k in range(5)] == ["lost 0", "lost 1", "lost 2", "", ""]
    assert passes("another") == "another"
    clock.now_s = WINDOW_S
    assert passes("lost %s", "100 %d") == "lost 100 %d (2 more were left out before.)"
    assert len([k for k in range(1000) if passes(f"kind {k}")]) < 100, "kinds without end are one kind"


def test_a_log_record_is_short():
    record = logging.LogRecord("a", logging.WARNING, "", 0, "x" * 10**6, (), None)
    LogLimit().filter(record)
    assert len(record.getMessage()) < 5000
