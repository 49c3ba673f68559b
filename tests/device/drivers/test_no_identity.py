"""An instrument that knows a single query and has no identity: a dial gauge that answers ``?`` with its reading."""

import socket
import threading

import pytest

from smarig.core import UsageError
from smarig.device.encoding.link_faults import Silent
from smarig.device.links.text_line import QUIET, TextLine

TIMEOUT_S = 0.1


class Gauge:
    """It answers each ``?`` with the next of ``readings``; None is a lost reply."""

    def __init__(self, readings, stale=b""):
        self._readings, self._stale = iter(readings), stale
        self._server = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        connection, _ = self._server.accept()
        with connection:
            connection.sendall(self._stale)  # the answer to a host before this one
            while connection.recv(1):
                if (reading := next(self._readings, None)) is not None:
                    connection.sendall(f"{reading}\n".encode())
                connection.recv(1)

    def close(self):
        self._server.close()


@pytest.fixture
def line_to():
    opened = []

    def line(readings, who="", stale=b""):
        gauge = Gauge(readings, stale)
        opened.extend([gauge, made := TextLine(gauge.url, 9600, TIMEOUT_S, who)])
        return made

    yield line
    for one in reversed(opened):
        one.close()


def test_readings_that_stay_the_same_are_answers(line_to):
    line = line_to(["+000.403 mm"] * 6)
    assert "tcp://127.0.0.1" in line.identify()
    assert [line.ask("?") for _ in range(6)] == ["+000.403 mm"] * 6
    assert line.repeats == 0


def test_an_answer_to_an_earlier_host_is_discarded(line_to):
    line = line_to(["2.0", "3.0"], stale=b"1.0\n")
    assert [line.number("?"), line.number("?")] == [2.0, 3.0]


def test_a_lost_reply_is_asked_for_again_once_the_line_is_quiet(line_to):
    line = line_to(["1.0", None, "2.0", *[None] * 3 * QUIET])
    assert [line.number("?"), line.number("?")] == [1.0, 2.0]
    assert line.repeats == 1
    with pytest.raises(Silent):
        line.number("?")


def test_the_query_of_the_identity_is_refused_as_a_reading(line_to):
    line = line_to(["+000.403 mm"] * 6, who="?")
    line.identify()
    with pytest.raises(UsageError, match=r'who=""'):
        line.ask("?")
