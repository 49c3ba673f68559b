"""Instruments that end their lines with a line feed, CR LF or CR: what they get, what is read, what is said if not."""

import contextlib
import socket
import threading

import pytest

from smarig.config import LinkFile
from smarig.core import ConfigError
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.opening import opened
from smarig.device.links.shared_text_line import shared_text_line

ENDS = ["\n", "\r\n", "\r"]


def talks(server, end):
    """Acts on lines that end so, as nothing else ends a line to it, and answers in its own way."""
    connection, _ = server.accept()
    received = b""
    with connection, contextlib.suppress(OSError):
        while data := connection.recv(64):
            *lines, received = (received + data).split(end)
            for line in lines:
                assert b"\r" not in line
                assert b"\n" not in line
                answers = {b"ID": b"BOX 1", b"X?": b"2.5", b"Y?": b"ERR 4"}
                if answer := answers.get(line.strip(b"\t")):
                    connection.sendall(answer + end)


@pytest.fixture
def box():
    with socket.create_server(("127.0.0.1", 0)) as server:

        def started(end):
            threading.Thread(target=talks, args=(server, end.encode()), daemon=True).start()
            return f"tcp://127.0.0.1:{server.getsockname()[1]}"

        yield started


def link(url, line_end, timeout_s=5.0):
    return LinkFile(driver="./my.py", framing="lines", url=url, timeout_s=timeout_s, line_end=line_end)


@pytest.mark.parametrize("end", ENDS)
def test_each_is_spoken(box, end):
    line = shared_text_line(link(box(end), end), who="ID")
    assert line.identify() == "BOX 1"
    line.write("SET 1")
    assert [line.number("X?") for _ in range(3)] == [2.5] * 3
    assert line.repeats == 0
    line.close()


def test_replies_that_end_with_more_than_was_said_cost_no_query():
    """Commands end with CR, replies with CR LF: the LF is no reply, and the identity is asked for once."""
    asked = []

    def answers(server):
        connection, _ = server.accept()
        with connection, contextlib.suppress(OSError):
            while data := connection.recv(64):
                for query in data.split(b"\r")[:-1]:
                    asked.append(query)
                    connection.sendall(b"BOX 1\r\n" if query == b"ID" else b"2.5\r\n")

    with socket.create_server(("127.0.0.1", 0)) as server:
        threading.Thread(target=answers, args=(server,), daemon=True).start()
        line = shared_text_line(link(f"tcp://127.0.0.1:{server.getsockname()[1]}", "\r"), who="ID")
        line.identify()
        assert [line.number("X?") for _ in range(5)] == [2.5] * 5
        line.close()
    assert asked.count(b"ID") == 1
    assert asked.count(b"X?") == 5


def test_the_remedy_names_the_key(box):
    line = shared_text_line(link(box("\r\n"), "\n", 0.1), who="ID")
    with pytest.raises(
        Silent,
        match=r"does not answer ID\. .* not end with a line feed, set line_end of its link; if it takes longer than "
        r"0\.1 s to answer, timeout_s\. Or the urls of two links are exchanged\.$",
    ):
        line.identify()
    line.close()


def test_a_reply_with_another_end_is_told_of():
    with socket.create_server(("127.0.0.1", 0)) as server:
        line = shared_text_line(link(f"tcp://127.0.0.1:{server.getsockname()[1]}", "\n", 0.2), who="ID")
        connection, _ = server.accept()
        connection.sendall(b"BOX 1\r")
        with pytest.raises(Silent, match=r"sent something that does not end with a line feed: set line_end"):
            line.identify()
        line.close()
        connection.close()


def test_a_message_shows_no_line_end(box):
    line = shared_text_line(link(box("\n"), "\n"), who="ID")
    with pytest.raises(Garbled) as error:
        line.number("Y?\t")
    line.close()
    assert "to Y?. " in str(error.value)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"line_end": "\r\n", "framing": "modbus_tcp"}, 'line_end belongs to framing = "lines"'),
        ({"line_end": "\n\r"}, "line_end"),
        ({"line_end": ""}, "line_end"),
    ],
)
def test_only_lines_have_an_end_and_only_one_of_three(values, sentence):
    with pytest.raises(ValueError, match=sentence):
        LinkFile.model_validate({"driver": "smarig_amplifier", "framing": "lines", **values})


def test_the_lines_of_the_firmware_have_theirs():
    with pytest.raises(ConfigError, match="leave out line_end"):
        opened(link("/dev/ttyUSB7", "\r\n"), 65)
