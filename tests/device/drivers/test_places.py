"""Addresses of links: an invalid address gives an error message before anything is opened."""

import socket
import threading

import pytest

from smarig.config import load_rig
from smarig.core.errors import ConfigError
from smarig.device import no_scheme_text
from smarig.device.links.opening import opened
from smarig.device.links.text_line import TextLine


@pytest.mark.parametrize(
    ("framing", "url"),
    [
        ("modbus_tcp", "tcp://[bad:502"),
        ("modbus_tcp", "tcp://a..b:502"),
        ("modbus_tcp", f"tcp://{'a' * 64}:502"),
        ("modbus_tcp", "tcp://h:0"),
        ("modbus_tcp", "tcp://h:99999"),
        ("modbus_tcp", "/dev/ttyUSB0"),
        ("lines", "socket://h"),
        ("lines", "socket://h:99999"),
        ("lines", "tcp://h"),
        ("modbus_rtu", "rfc2217://[h"),
    ],
)
def test_an_invalid_address_is_reported(framing, url):
    links = load_rig("bench_one_wire").links
    with pytest.raises(ConfigError, match="is not an address of .*://HOST:PORT"):
        opened(links.amplifier.model_copy(update={"framing": framing, "url": url}), 65)


def test_a_pattern_that_is_none_is_a_line_that_is_not_there():
    links = load_rig("bench_one_wire").links
    with pytest.raises(Exception, match="Check its power"):
        opened(links.amplifier.model_copy(update={"framing": "lines", "url": "hwgrep://["}), 65)


@pytest.mark.parametrize("framing", ["lines", "modbus_rtu"])
@pytest.mark.parametrize("url", ["http://192.168.1.30:80", "TCP:/x://h:1", "udp://h:1"])
def test_an_unknown_scheme_is_a_sentence_that_lists_the_schemes(framing, url):
    links = load_rig("bench_one_wire").links
    where = links.amplifier.model_copy(update={"framing": framing, "url": url})
    for open_line in (lambda: opened(where, 65), lambda: TextLine(url, 9600, 0.3)):
        with pytest.raises(ConfigError, match=r"serial port, tcp://HOST:PORT .* or rfc2217://HOST:PORT"):
            open_line()


@pytest.mark.parametrize("framing", ["lines", "modbus_rtu"])
def test_an_address_without_its_scheme_is_the_sentence_of_the_rig_check(framing):
    url = "127.0.0.1:7199"
    links = load_rig("bench_one_wire").links
    where = links.amplifier.model_copy(update={"framing": framing, "url": url})
    for open_line in (lambda: opened(where, 65), lambda: TextLine(url, 9600, 0.3)):
        with pytest.raises(ConfigError) as refused:
            open_line()
        assert str(refused.value) == no_scheme_text(url)


@pytest.mark.parametrize("scheme", ["tcp", "socket"])
def test_both_names_of_a_tcp_socket_reach_the_instrument(scheme):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        threading.Thread(target=_answers_its_name, args=(server,), daemon=True).start()
        line = TextLine(f"{scheme}://127.0.0.1:{port}", 9600, 5.0)
        assert line.identify() == "ACME,BOX-1,42,1.0"
        assert line.where == f"{scheme}://127.0.0.1:{port}", "messages have it as it was given"
        line.close()


def _answers_its_name(server):
    connection, _ = server.accept()
    with connection:
        connection.recv(64)
        connection.sendall(b"ACME,BOX-1,42,1.0\n")
