"""A bench without physics: a wire of 5 ohm, an encoder that moves as prescribed, and the devices."""

from collections.abc import Sequence

from simulators.faults import SimulatedFault
from simulators.framed_device import PythonAmplifier, PythonDaq
from simulators.lines import TextFraming
from simulators.pace import LockStep
from simulators.simulated_bench import SimulatedBench
from smarig.device.encoding import lines
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.rig.specimen import RawReading

PERIOD_s = 0.1


class FiveOhms:
    """Ten counts further with every tick."""

    def __init__(self) -> None:
        self.counts = 0

    def advance(self, output_A: float) -> RawReading:
        """Advance as prescribed."""
        self.counts += 10
        flowed_uA = round(output_A * 1e6)
        return RawReading(flowed_uA, 5 * flowed_uA, self.counts, 2200, -32768, False)

    def counts_now(self) -> int:
        """Without noise."""
        return self.counts


class Bench:
    """A world with a pace, and a host's hand on both devices."""

    def __init__(self, faults: Sequence[SimulatedFault] = ()) -> None:
        self.world = SimulatedBench(
            FiveOhms(), PythonAmplifier(TextFraming()), PythonDaq(TextFraming()), PERIOD_s, 2000, faults
        )
        self.pace = LockStep(self.world, self.world.tick)
        self.amplifier, self.daq = self.world.amplifier, self.world.daq

    def ask(self, name: str, exchange: Exchange) -> list[int] | Refusal | None:
        """As over a line of text; None for silence."""
        request = lines.request(exchange)[:-1]
        self.world.exchanges[name] += 1
        self.pace.before_answer(name, request)
        reply = self.world.answer(name, request)
        return None if reply is None else lines.find(exchange, reply)

    def samples(self, sequence: int, first: int, want: int) -> list[tuple[int, ...]] | None:
        """Samples of the DAQ: (counts, ambient, marks) each."""
        m = self.daq.map
        window = {"ring_next": first, "ring_want": want}
        words = tuple(m.encode("command", {"sequence": sequence, "epoch": self.daq.boot_count, **window}))
        status = self.ask("encoder_daq", Exchange(0, m.size("status"), m.start("command"), words))
        return None if status is None else m.records(status, m.decode("status", status)["ring_count"])

    def command(self, sequence: int, **values: int) -> list[int] | Refusal | None:
        """A command to the amplifier."""
        proof = {"sequence": sequence, "epoch": self.amplifier.boot_count}
        words = tuple(self.amplifier.map.encode("command", {**proof, **values}))
        return self.ask("amplifier", Exchange(0, 20, self.amplifier.map.start("command"), words))

    def armed(self, current_uA: int) -> None:
        """Set up, armed and driving; the lease is 2 s."""
        limits = {"period": 100, "lease": 2000, "current_max": 1_000_000, "slew_max": 100_000}
        wire = {"resistance_max": 20_000, "heat_max": 4_000_000_000, "heat_settle": 1000}
        words = tuple(self.amplifier.map.encode("settings", {**limits, **wire}))
        assert self.ask("amplifier", Exchange(write_at=0x200, words=words)) == []
        first = {"order": 1, "nonce": 1 << 16}  # boot 1, no order yet
        assert not isinstance(self.command(1, **first, current=current_uA), Refusal | None)
