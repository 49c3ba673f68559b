"""An instrument that begins to send readings by itself: no query waits for the end of what has none."""

import socket
import threading
import time

import pytest

from smarig.device.encoding.link_faults import Garbled
from smarig.device.links.text_line import CONTINUOUS, TextLine

TIMEOUT_S = 0.05
PATIENCE_S = 30.0  # ends a test that has failed


class Streaming:
    """It answers so many lines, and then sends a reading every so many seconds, whatever it is asked."""

    def __init__(self, answers, every_s):
        self._answers, self._every_s = answers, every_s
        self._server = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        connection, _ = self._server.accept()
        with connection, connection.makefile("rb") as lines:
            for _ in range(self._answers):
                connection.sendall(b"ACME,LASER,1,1\n" if b"IDN" in next(lines) else b"0.512\n")
            try:
                while True:
                    connection.sendall(b"0.512\n")
                    time.sleep(self._every_s)
            except OSError:
                pass  # the test is over

    def close(self):
        self._server.close()


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("every_s", [0.002, 2 * TIMEOUT_S])
@pytest.mark.parametrize("who", ["*IDN?", ""])
def test_a_query_among_lines_that_do_not_end_is_an_error_in_a_bounded_time(who, every_s):
    instrument = Streaming(2 if who else 0, every_s)
    line = TextLine(instrument.url, 9600, TIMEOUT_S, who)
    errors, began_s = [], []

    def ask():
        try:
            while True:  # a reading that nobody queried may pass for an answer, on a busy machine many times
                began_s.append(time.monotonic())
                line.number("MEAS:POS?")
                time.sleep(every_s)
        except Garbled as error:
            errors.append((time.monotonic(), str(error)))

    asking = threading.Thread(target=ask, daemon=True)
    asking.start()
    asking.join(PATIENCE_S)
    line.close()
    instrument.close()
    assert not asking.is_alive(), "it waits for ever"
    ended_s, message = errors[0]
    assert ended_s - began_s[-1] >= CONTINUOUS * TIMEOUT_S, "late answers have time to come"
    assert "goes on sending lines that nobody has queried. If it is set to continuous output" in message
