"""One round of the server with a simulated clock: waiting requests are read before elapsed time is counted."""

import os
import tty

from benches import Bench

from simulators.faults import Delayed
from simulators.line import DeviceLine
from simulators.line_troubles import LineFaults
from simulators.lines import TextFraming
from simulators.server import Server
from simulators.transports import Pty
from smarig.device.encoding import lines
from smarig.device.encoding.exchange import Exchange


class Once(Bench):
    """A bench behind ptys, with a server."""

    def __init__(self, now_s: float) -> None:
        super().__init__()
        self.port = Pty()
        line = DeviceLine("amplifier", self.port, TextFraming(), self.world, LineFaults([]))
        self._reading, self._writing = os.pipe()
        self.server = Server(self.world, [line], self.pace, self._reading, 0.0, clock=lambda: now_s)

    def serve_one(self) -> None:
        """Until a request is answered."""
        answer = self.world.answer

        def answered(name, request):
            self.server.stop()
            return answer(name, request)

        self.world.answer = answered
        self.server.run()

    def close(self) -> None:
        """All descriptors."""
        self.port.unplug()
        os.close(self._reading)
        os.close(self._writing)


def test_delayed_devices_do_not_assume_that_their_host_has_ended():
    """Both processes stood still for a minute; the host's request lies there."""
    bench = Once(now_s=160.0)
    bench.armed(300_000)
    bench.pace.host_active(100.0)
    host = os.open(bench.port.url, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(host)
    os.write(host, lines.request(Exchange(0, 1)))
    bench.serve_one()
    assert os.read(host, 100).startswith(b"= 0001 *")
    os.close(host)
    bench.close()
    assert (bench.world.ticks, bench.amplifier.state) == (0, "armed")


class Kept:
    """A port that keeps what is written to it."""

    def __init__(self) -> None:
        self.written: list[bytes] = []

    def channels(self) -> list[int]:
        return [1]

    def write(self, channel: int, data: bytes) -> None:
        self.written.append(data)


def test_a_late_reply_keeps_back_those_after_it_and_no_others():
    bench, port = Bench(), Kept()
    second = Delayed(kind="delayed", device="amplifier", delay_s=0.3, from_exchange=2, to_exchange=3)
    line = DeviceLine("amplifier", port, TextFraming(), bench.world, LineFaults([second]))
    for now_s, reply in ((10.0, b"1"), (10.1, b"2"), (10.2, b"3")):
        bench.world.exchanges["amplifier"] += 1
        line.send(1, reply, now_s)
    assert port.written == [b"1"]
    assert line.next_due_s() == 10.4
    line.due(10.39)
    assert port.written == [b"1"]
    line.due(10.4)
    assert port.written == [b"1", b"2", b"3"]
    line.send(1, b"4", 10.5)
    assert port.written[-1] == b"4"
