"""A device behind the Link interface that sends what the test prescribes."""

from smarig.device.encoding.crc import crc16
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Silent
from smarig.device.encoding.register import RegisterMap, to_words


class Scripted:
    """Answers exchanges like a device, unless ``next_replies`` holds something else to say or raise.

    ``status`` holds registers that have this value whatever was ordered.
    """

    where = "/dev/scripted"

    def __init__(self, map_: RegisterMap, **status: int) -> None:
        self.map = map_
        d = map_.device
        self.status = {
            "kind": d.kind,
            "version": d.version,
            "map_hash": map_.hash,
            "boot_count": 3,
            "echo": 41,
        }
        self.status |= status
        self._follows = {"state": 0, "output": 0}  # what an amplifier was ordered
        self.settings: list[int] = [0] * map_.size("settings")
        self.asked: list[Exchange] = []
        self.next_replies: list[object] = []
        self.late: list[object] = []
        self.done: list[dict[str, int]] = []
        self.reopened = self.closed = 0
        self.gone = False

    def exchange(self, exchange: Exchange):
        self.asked.append(exchange)
        if self.gone:
            raise Silent("nothing")
        said = self.next_replies.pop(0) if self.next_replies else None
        if isinstance(said, BaseException):
            raise said
        granted = self._granted(exchange)
        return granted if said is None else said

    def more(self, exchange: Exchange):
        if not self.late:
            raise Silent("no more")
        said = self.late.pop(0)
        return self._granted(exchange) if said is None else said

    def reopen(self) -> None:
        self.reopened += 1

    def close(self) -> None:
        self.closed += 1

    def _granted(self, e: Exchange) -> list[int] | Refusal:
        if e.words and e.write_at == self.map.start("command"):
            values = self.map.decode("command", e.words)
            if values["epoch"] == self.status["boot_count"] and values["sequence"] != self.status["echo"]:
                self.done.append(values)
                self.status["echo"] = values["sequence"]
                self._follow(values)
        if e.words and e.write_at == self.map.start("settings"):
            self.settings = list(e.words)
        if e.read_at == self.map.start("settings"):
            return self.settings[: e.count]
        words: list[int] = []
        for r in self.map.blocks["status"]:
            words += [0] * r.words if r.field else to_words(self._register(r.name), r.words)
        return words[: e.count]

    def _follow(self, values: dict[str, int]) -> None:
        if values["order"]:
            self._follows = {"state": int(values["order"] in (1, 3)), "output": 0}
        if self._follows["state"]:
            self._follows["output"] = values.get("current", 0)

    def _register(self, name: str) -> int:
        no_limit = self.settings[-1] == 0x8000 and "wire_temperature_max" in self.map.registers
        settings = self.settings[:-1] if no_limit else self.settings
        made = {
            **self._follows,
            "settings_crc": crc16(b"".join(word.to_bytes(2, "big") for word in settings)),
            "arm_nonce": 3 << 16 | len(self.done),
            "board_max": 2_000_000,
        }
        return self.status.get(name, made.get(name, 0))
