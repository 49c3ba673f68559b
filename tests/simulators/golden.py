"""Exchanges as bytes: the expected content of each reply is written by hand and checked when it is recorded.

``python tests/simulators/write_golden.py`` writes firmware_protocol/golden. The C firmware and the Python
devices both reproduce these exchanges. ``why`` and ``title`` are for readers.
"""

import json
from pathlib import Path
from typing import Any

from simulators.framed_device import PythonAmplifier, PythonDaq
from simulators.lines import TextFraming
from simulators.modbus import Rtu
from smarig.core.resources import shipped
from smarig.device.encoding import lines, rtu
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.register import from_words, load_register_map, to_words

FOLDER = shipped("firmware_protocol") / "golden"
Samples = tuple[tuple[int, ...], ...]
ARMING = (1, 3)  # orders of an amplifier: arm, rearm
MAKERS = {"amplifier": PythonAmplifier, "encoder_daq": PythonDaq}


def made(script: dict[str, Any]) -> PythonAmplifier | PythonDaq:
    """The Python device that a script begins with."""
    framing = Rtu(script["address"]) if script["framing"] == "rtu" else TextFraming()
    device = MAKERS[script["device"]](framing)
    device.boot(script["boot_count"])
    return device


def asked(device: PythonAmplifier | PythonDaq, framing: str, request: str) -> str | None:
    """A request of a script and its reply, as written in the script."""
    if framing == "rtu":
        reply = device.answer(bytes.fromhex(request))
        return reply.hex() if reply is not None else None
    reply = device.answer(request.encode("latin-1"))
    return reply.decode().removesuffix("\n") if reply is not None else None


class Script:
    """Recorded step by step; a reply that is not what was stated is refused at once."""

    def __init__(self, name: str, device: str, framing: str, title: str) -> None:
        self.name, self._map = name, load_register_map(device)
        self.map_hash = self._map.hash
        address = self._map.device.default_address
        self.head = {
            "title": title,
            "device": device,
            "framing": framing,
            "address": address,
            "boot_count": 7,
        }
        self.steps: list[dict[str, Any]] = []
        self._device = made(self.head)
        self._framing = framing
        self.word = 0  # the last sequence given
        self.orders = 0  # that were executed

    @property
    def nonce(self) -> int:
        """What an amplifier asks of the next order that arms: its boot, then the orders since."""
        return self.head["boot_count"] << 16 | self.orders & 0xFFFF

    def next_word(self) -> int:
        """A new sequence."""
        self.word += 1
        return self.word

    def proof(self, word: int) -> tuple[int, ...]:
        """The words that a command begins with: a sequence, and the boot for which it is made."""
        return (*to_words(word, 2), *to_words(self.head["boot_count"], 2))

    def raw(self, why: str, request: str, reply: str | None) -> None:
        """Bytes or text as they are, and the reply that the contract gives them."""
        heard = asked(self._device, self._framing, request)
        assert heard == reply, (self.name, why, heard, reply)
        self.steps.append({"why": why, "request": request, "reply": reply})

    def ask(
        self, why: str, exchange: Exchange, refused: int = 0, samples: Samples | None = None, **says: int
    ) -> None:
        """An exchange: refused with a code, or accepted with these values and records of the ring in the reply."""
        request = self._request(exchange)
        reply = asked(self._device, self._framing, request)
        assert reply is not None
        answer = self._found(exchange, reply)
        if isinstance(answer, Refusal):
            assert answer.code == refused, (self.name, why, answer)
        else:
            found = {name: self._value(name, exchange, answer) for name in says}
            assert (refused, found) == (0, says), (self.name, why, found)
            shown = tuple(self._map.records(answer, len(samples or ())))
            assert samples is None or shown == samples, (self.name, why, shown)
        self.steps.append({"why": why, "request": request, "reply": reply})

    def command(self, why: str, refused: int = 0, again: bool = False, read: int = 0, **values: Any) -> None:
        """The command block with a new sequence (or the last one, ``again``), then the status block's head.

        Values in capital letters are written, others are what is said. An order that arms carries the nonce, unless
        another one is given.
        """
        written = {name.lower(): raw for name, raw in values.items() if name.isupper()}
        says = {name: raw for name, raw in values.items() if not name.isupper()}
        if not again:
            self.next_word()
        order = written.get("order", 0) if self.head["device"] == "amplifier" else 0
        nonce = {"nonce": self.nonce} if order in ARMING else {}
        written = {"sequence": self.word, "epoch": self.head["boot_count"], **nonce, **written}
        words = tuple(self._map.encode("command", written))
        head = self._map["ring"].address
        self.ask(why, Exchange(0, read or head, self._map.start("command"), words), refused, **says)
        executed = not again and not refused and written["epoch"] == self.head["boot_count"]
        self.orders += bool(order and executed)

    def settings(self, why: str, refused: int = 0, **values: int) -> None:
        """The whole settings block; what is not given is what is safe."""
        safe = {r.name: r.safe or 0 for r in self._map.blocks["settings"]}
        words = tuple(self._map.encode("settings", safe | values))
        self.ask(why, Exchange(write_at=self._map.start("settings"), words=words), refused)

    def tick(self, *reading: int, times: int = 1) -> None:
        """Ticks in which this was measured."""
        for _ in range(times):
            self._device.tick(*reading)
            self.steps.append({"tick": list(reading)})

    def now(self, raw_counts: int) -> None:
        """Where the encoder stands."""
        self._device.now(raw_counts)
        self.steps.append({"now": raw_counts})

    def _request(self, exchange: Exchange) -> str:
        if self._framing == "rtu":
            return rtu.request(self.head["address"], exchange).hex()
        return lines.request(exchange).decode().removesuffix("\n")

    def _found(self, exchange: Exchange, reply: str) -> list[int] | Refusal:
        if self._framing == "rtu":
            found = rtu.find(self.head["address"], exchange, bytes.fromhex(reply))
        else:
            found = lines.find(exchange, (reply + "\n").encode())
        assert found is not None
        return found

    def _value(self, name: str, exchange: Exchange, words: list[int]) -> int:
        r = self._map[name]
        at = r.address - exchange.read_at
        return from_words(words[at : at + r.words], r.type)

    def text(self) -> str:
        """The file: a line for each exchange, ticks side by side."""
        rows = [json.dumps(self.head, ensure_ascii=False)[:-1] + ', "script": [']
        for k, step in enumerate(self.steps):
            item = json.dumps(step, ensure_ascii=False) + ("," if k + 1 < len(self.steps) else "")
            packed = "tick" in step and rows[-1].startswith('{"tick"') and len(rows[-1]) < 90
            rows[-1:] = [f"{rows[-1]} {item}"] if packed else [rows[-1], item]
        return "\n".join([*rows, "]}", ""])

    def write(self, folder: Path) -> None:
        """Into a folder, by name."""
        folder.mkdir(exist_ok=True)
        (folder / f"{self.name}.json").write_text(self.text(), encoding="utf-8")
