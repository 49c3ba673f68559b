"""``python -m simulators.labjack --rig RIG``: a LabJack behind Modbus TCP, with the twin's wire on its terminals.

Prints its address as one line of JSON, for each role of the rig file. Runs until standard input ends; its time is the
clock's, times ``--speed`` or ``simulator.speed`` of the rig file.
"""

import asyncio
import threading
import time
from collections.abc import Sequence
from typing import Any

import click
from pymodbus.constants import ExcCodes
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from simulators.labjack_wire import LabJackWire
from simulators.on_the_clock import serve, wire_options
from smarig.config import LinksFile, RigFile
from smarig.core import UsageError
from smarig.rig import TwinSettings

READ, WRITE = (3, 4), (6, 16)
REGISTERS = 65535


class LabJackServer:
    """A server in a thread of its own. ``wire`` is what it serves; ``delay_s``: before every reply."""

    def __init__(self, wire: LabJackWire, speed: float = 1.0, port: int = 0) -> None:
        self.wire, self._speed, self.delay_s = wire, speed, 0.0
        self._port, self._begin_s = port, time.monotonic()
        self._ready = threading.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._server: ModbusTcpServer | None = None
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)

    def start(self) -> "LabJackServer":
        """Listen. Raises UsageError if the port is in use."""
        self._thread.start()
        if not self._ready.wait(10):
            raise UsageError("The simulated LabJack cannot listen.")
        return self

    @property
    def urls(self) -> dict[str, str]:
        """Its address, for each link of the rig file that it serves."""
        links = {name: getattr(self.wire.file.links, name) for name in LinksFile.model_fields}
        return {name: self.url for name, link in links.items() if link and link.driver.startswith("labjack_")}

    def close(self) -> None:
        """Close all connections and end the thread."""
        if self._loop and self._server:
            asyncio.run_coroutine_threadsafe(self._server.shutdown(), self._loop).result(5)
        self._thread.join(5)

    @property
    def url(self) -> str:
        """Its address."""
        return f"tcp://127.0.0.1:{self._port}"

    def now_s(self) -> float:
        """Time of the box."""
        return (time.monotonic() - self._begin_s) * self._speed

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        memory = SimData(0, count=REGISTERS, datatype=DataType.REGISTERS)
        device = SimDevice(id=1, simdata=[memory], action=self._action)
        self._server = ModbusTcpServer(device, address=("127.0.0.1", self._port))
        await self._server.serve_forever(background=True)
        transport = self._server.transport
        assert isinstance(transport, asyncio.Server)  # noqa: S101 - it listens
        self._port = transport.sockets[0].getsockname()[1]
        pace = asyncio.create_task(self._pass_time())
        self._ready.set()
        await self._server.serving
        pace.cancel()

    async def _pass_time(self) -> None:
        """Time also passes without requests."""
        while True:
            self.wire.advance(self.now_s())
            await asyncio.sleep(min(0.02, self.wire.file.period_s / self._speed))

    async def _action(
        self,
        function: int,
        start: int,
        at: int,
        count: int,
        registers: list[int],
        values: Sequence[int] | None,
    ) -> ExcCodes | None:
        if self.delay_s:
            await asyncio.sleep(self.delay_s)
        now_s = self.now_s()
        self.wire.advance(now_s)
        if values is not None:
            refusal = self.wire.box.write(at, list(values), now_s) if function in WRITE else 1
            return ExcCodes(refusal) if refusal else None
        found = self.wire.box.read(at, count, now_s) if function in READ else 1
        if isinstance(found, int):
            return ExcCodes(found)
        registers[at - start : at - start + count] = found
        return None


@click.command()
@wire_options
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="TCP port; 0: a free one.")
@click.option("--product", type=click.Choice(["4", "7"]), default="7", help="T4 or T7.")
def main(port: int, product: str, **wire: Any) -> None:
    """Simulate a LabJack and the wire of a rig."""

    def start(file: RigFile, settings: TwinSettings, speed: float) -> LabJackServer:
        return LabJackServer(LabJackWire(file, settings, int(product)), speed, port).start()

    serve(start, **wire)


if __name__ == "__main__":
    main()
