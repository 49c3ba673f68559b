"""The gauge driver of the page on laboratory supplies, on a gauge that answers over TCP in place of a serial port."""

import socketserver
import threading
from pathlib import Path

import pytest

from docs.blocks import blocks
from smarig.config import LinkFile, load_rig
from smarig.device import Garbled

PAGE = Path(__file__).resolve().parents[2] / "docs/how_to/laboratory_supply.md"


class Answering(socketserver.StreamRequestHandler):
    """Answers each ? that ends with CR; anything else is not understood."""

    def handle(self):
        while (byte := self.rfile.read(1)) == b"?":
            assert self.rfile.read(1) == b"\r"
            self.wfile.write(next(self.server.answers).encode() + b"\r")
        assert byte == b""


@pytest.fixture
def gauge():
    """A function that starts a gauge with these answers and opens the page's driver on it."""
    (text,) = [block.content for block in blocks(PAGE) if block.file == "my_gauge.py"]
    names: dict = {}
    exec(compile(text, "my_gauge.py", "exec"), names)
    server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Answering)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    opened = []

    def start(*answers):
        server.answers = iter(answers)
        url = f"tcp://127.0.0.1:{server.server_address[1]}"
        where = LinkFile(driver="visa_meter", framing="lines", url=url, timeout_s=0.1, line_end="\r")
        opened.append(names["my_gauge"](where, load_rig("laboratory_supply")))
        return opened[-1]

    yield start
    for each in opened:
        each.close()
    server.shutdown()
    server.server_close()


def test_it_reads_millimetres(gauge):
    opened = gauge("+001.234 mm", "-000.500 mm", "+001.2\x00 mm", "+002.000 mm")
    assert opened.position() == -0.5
    assert opened.position() == 2.0  # asked once more
    assert (opened.unit, opened.absolute) == ("mm", False)


@pytest.mark.parametrize("answer", ["+0.0486 in", "+001.234", "--- mm", "1,234 mm"])
def test_it_refuses_what_is_no_number_of_millimetres(gauge, answer):
    with pytest.raises(Garbled, match="not a number of mm"):
        gauge(answer, answer)
