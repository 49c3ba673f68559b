"""The driver talks to a simulated supply, which answers over TCP as an instrument would over a serial line."""

import contextlib
import socketserver
import threading

import pytest

from smarig.config import load_rig
from smarig.core import catalogue_entry, resolve_name

DRIVERS = "smarig.device.drivers"


class _Supply(socketserver.StreamRequestHandler):
    """Keeps a current, an output switch and a watchdog; its load has 4 Ω."""

    current_A, on, lease = 0.0, False, "0"

    def handle(self) -> None:
        with contextlib.suppress(OSError):
            for line in self.rfile:
                answer = self.answered(line.decode().split())
                if answer:
                    self.wfile.write(f"{answer}\n".encode())

    def answered(self, words: list[str]) -> str:
        match words:
            case ["*IDN?"]:
                return "ACME,PS-3005,0,1.0"
            case ["CURR", amount]:
                self.current_A = float(amount)
            case ["OUTP", switch]:
                type(self).on = switch == "ON"
            case ["SYST:WDOG", lease]:
                self.lease = lease
            case ["SYST:WDOG?"]:
                return self.lease
            case ["MEAS:POS?"]:
                return "3.25"
            case ["CURR?"]:
                return f"{self.current_A:.6f}"
            case ["OUTP?"]:
                return str(int(self.on))
            case ["MEAS:CURR?"]:
                return f"{self.current_A * self.on:.6f}"
            case ["MEAS:VOLT?"]:
                return f"{4.0 * self.current_A * self.on:.6f}"
        return ""


@pytest.fixture
def source():
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), _Supply) as server:
        server.daemon_threads = True
        threading.Thread(target=server.serve_forever, daemon=True).start()
        rig = load_rig("bench_one_wire")
        assert rig.links is not None
        url = f"tcp://127.0.0.1:{server.server_address[1]}"
        where = rig.links.amplifier.model_copy(update={"url": url, "timeout_s": 5.0})
        opened = catalogue_entry(DRIVERS, resolve_name(DRIVERS, "my_driver"))(where, rig)
        yield opened
        opened.close()
        server.shutdown()


def test_it_sets_reads_and_switches_off(source):
    assert not _Supply.on
    source.arm()
    assert source.has_lease
    source.set_current(0.5)
    assert _Supply.on
    reading = source.measure()
    assert (reading.current_A, reading.voltage_V) == (0.5, 2.0)
    assert source.position() == 3.25
    assert source.off() == ""
    assert not _Supply.on
