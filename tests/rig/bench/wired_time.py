"""Both devices on one wire in simulated time, in Python or in C, in any framing; a host's links to them."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
import serial

from rig.bench.simulated_time import HostClient, HostPort, SimulatedTime
from simulators.firmware import FirmwareAmplifier, FirmwareDaq, open_library
from simulators.framed_device import PythonAmplifier, PythonDaq
from simulators.lines import TextFraming
from simulators.modbus import Rtu, Tcp
from simulators.simulated_bench import SimulatedBench
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange
from smarig.device.links.modbus_tcp import ModbusTcp
from smarig.device.links.serial_line import TEXT, SerialLine, rtu_framing
from smarig.rig.specimen import RawReading

PERIOD_s = 0.1
TIMEOUT_s = 0.15  # of a reply
ADDRESSES = {"amplifier": 65, "encoder_daq": 100}
FRAMINGS = {"lines": lambda _: TextFraming(), "modbus_rtu": Rtu, "modbus_tcp": Tcp}
ARM_ORDERS = (1, 3)


class FiveOhms:
    """A wire of 5 ohm; ten counts further with every tick."""

    def __init__(self) -> None:
        self.counts = 0

    def advance(self, output_A: float) -> RawReading:
        self.counts += 10
        flowed_uA = round(output_A * 1e6)
        return RawReading(flowed_uA, 5 * flowed_uA, self.counts, 2200, -32768, False)

    def counts_now(self) -> int:
        return self.counts


class Gateway:
    """A device of RTU behind a gateway of Modbus TCP."""

    def __init__(self, device: FirmwareAmplifier | FirmwareDaq, address: int) -> None:
        self._device, self.framing = device, Tcp(address)

    def __getattr__(self, name: str):
        return getattr(self._device, name)

    def answer(self, request: bytes) -> bytes | None:
        if self.framing.decode(request) is None:
            return None
        reply = self._device.answer(request[6:] + crc16(request[6:]).to_bytes(2, "little"))
        return reply and request[:4] + (len(reply) - 2).to_bytes(2, "big") + reply[:-2]


class World:
    """The devices, what flowed in every tick, and links of any number of hosts."""

    def __init__(self, framing: str, library: Path | None = None) -> None:
        self.time, self.framing = SimulatedTime(), framing
        made = {name: FRAMINGS[framing](address) for name, address in ADDRESSES.items()}
        if library:
            amplifier, daq = self._in_c(library, framing)
        else:
            amplifier, daq = PythonAmplifier(made["amplifier"]), PythonDaq(made["encoder_daq"])
        self.amplifier = amplifier
        self.bench = SimulatedBench(FiveOhms(), amplifier, daq, PERIOD_s, 2000)
        self.driven_uA = [0]  # by tick
        self.trips: Counter[str] = Counter()
        self._trip = ""
        self.time.every(PERIOD_s, self._tick)

    @staticmethod
    def _in_c(library: Path, framing: str):
        functions = open_library(library)
        inner = {
            name: TextFraming() if framing == "lines" else Rtu(address) for name, address in ADDRESSES.items()
        }
        devices = (
            FirmwareAmplifier(functions, inner["amplifier"]),
            FirmwareDaq(functions, inner["encoder_daq"]),
        )
        if framing != "modbus_tcp":
            return devices
        return tuple(Gateway(d, address) for d, address in zip(devices, ADDRESSES.values()))

    def _tick(self) -> None:
        self.driven_uA.append(self.amplifier.output_uA)
        self.bench.tick()
        before, self._trip = self._trip, self.amplifier.trip
        if self._trip and not before:
            self.trips[self._trip] += 1

    @property
    def ticks(self) -> int:
        return len(self.driven_uA) - 1

    def answer(self, name: str, request: bytes) -> bytes | None:
        """A device's reply to one frame, without the end of a line in the request."""
        return self.bench.answer(name, request)

    def arms(self, request: bytes) -> bool:
        """Whether a frame orders the amplifier to arm."""
        e = self.bench.decoded("amplifier", request)
        return (
            isinstance(e, Exchange) and e.write_at == 0x100 and len(e.words) > 4 and e.words[4] in ARM_ORDERS
        )

    def link(self, name: str, sent: Callable[[bytes], None], patch: pytest.MonkeyPatch):
        """A host's link, and what lets a reply arrive there; ``sent`` gets each of its frames."""

        def send(data: bytes) -> None:
            for request in self.bench.station(name).framing.receiver().take(data):
                sent(request)

        port = HostPort(self.time, send)
        if self.framing == "modbus_tcp":
            patch.setattr("smarig.device.links.modbus_tcp.ModbusTcpClient", HostClient)
            number = len(HostClient.port_of) + 1
            patch.setitem(HostClient.port_of, number, port)
            return ModbusTcp("simulated", number, ADDRESSES[name], TIMEOUT_s), port.arrive
        patch.setattr(serial, "serial_for_url", lambda *_, **__: port)
        framing = TEXT if self.framing == "lines" else rtu_framing(ADDRESSES[name])
        line = SerialLine(f"/dev/{name}", framing, TIMEOUT_s, clock=self.time)
        line.reopen = port.open  # the patch may be another link's by then
        return line, port.arrive
