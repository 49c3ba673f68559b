"""Ports that disappear and return under the same name."""

import os
import socket
import tty
from pathlib import Path

from simulators.transports import Pty, TcpPort


def test_tcp_port_keeps_its_number():
    port = TcpPort()
    url = port.url
    with socket.create_connection(("127.0.0.1", int(url.rsplit(":", 1)[1])), timeout=2) as host:
        assert port.read(port.channels()[0]) is None
        (_, connection) = port.channels()
        host.sendall(b"abc")
        assert port.read(connection) == b"abc"
        port.write(connection, b"def")
        assert host.recv(10) == b"def"
        port.unplug()
        port.unplug()
        assert (port.channels(), host.recv(10)) == ([], b"")
    port.write(connection, b"to nobody")
    port.plug()
    assert (port.url, len(port.channels())) == (url, 1)
    port.unplug()


def test_pty_is_raw_and_survives_hosts(tmp_path: Path):
    port = Pty(tmp_path / "amplifier")
    for _ in range(2):
        host = os.open(port.url, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(host)
        os.write(host, b"\x03\x04\r\n\x11\xff")
        assert port.read(port.channels()[0]) == b"\x03\x04\r\n\x11\xff"
        port.write(port.channels()[0], b"\n\r\x00")
        assert os.read(host, 10) == b"\n\r\x00"
        os.close(host)
    port.unplug()
    assert not (tmp_path / "amplifier").exists()
    port.plug()
    assert Path(port.url).is_char_device()
    port.unplug()


def test_a_host_that_does_not_read_holds_nothing_up():
    port = Pty()
    for _ in range(200):
        port.write(port.channels()[0], b"x" * 1000)
    port.unplug()
