"""Modbus TCP against a server that replies as the test prescribes: errors have smarig's own messages only."""

import socket
import struct
import threading

import pytest

from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Garbled, Silent
from smarig.device.links.modbus_tcp import ModbusTcp

ASKED = Exchange(0, 2, 0x100, (1,))  # function 23


class Server:
    """Answers each request with the next of ``pdus``; None: closes the connection, b"": no reply."""

    def __init__(self, *pdus):
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        self._pdus = pdus
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self):
        channel, _ = self._listening.accept()
        with channel:
            for pdu in self._pdus:
                request = channel.recv(1024)
                if pdu is None:
                    return
                if pdu:
                    channel.sendall(request[:4] + struct.pack(">HB", len(pdu) + 1, request[6]) + pdu)
            channel.recv(1024)

    def close(self):
        self._thread.join(10)
        self._listening.close()


def asked(*pdus):
    server = Server(*pdus)
    link = ModbusTcp("127.0.0.1", server.port, 65, 0.3)
    try:
        return link.exchange(ASKED)
    finally:
        link.close()
        server.close()


def test_its_own_reply_is_taken_and_a_refusal_is_one():
    assert asked(bytes([23, 4, 0, 7, 0, 9])) == [7, 9]
    assert asked(bytes([23 | 0x80, 3])) == Refusal(3)


@pytest.mark.parametrize(
    ("pdu", "error", "says"),
    [
        (bytes([3, 4, 0, 7, 0, 9]), Garbled, "a reply to function 3"),
        (bytes([3 | 0x80, 2]), Garbled, "a reply to function 3"),
        (bytes([23, 6, 0, 7, 0, 9, 0, 1]), Garbled, "3 words instead of 2"),
        (b"", Silent, "no reply within 0.3 s"),
        (None, Garbled, "the connection was cut"),
    ],
)
def test_what_is_not_is_blamed_in_our_words_alone(pdu, error, says, capsys, caplog):
    with pytest.raises(error, match=says):
        asked(pdu)
    assert not capsys.readouterr().err
    assert not caplog.records
