"""Builds the C firmware once per session and wraps its devices in Python; skips if tools are not installed."""

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

from firmware.codes import ARM, REARM
from smarig.device.encoding.crc import crc16
from smarig.device.encoding.register import RegisterMap, load_register_map, to_words

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware_protocol" / "firmware"
RTU, LINES = 0, 1
_ROOM = 640
_SHORT = {"amplifier": "amp", "encoder_daq": "daq"}


def make(folder: Path, target: str, needs: tuple[str, ...], *variables: str, source: Path = FIRMWARE) -> Path:
    """One product of a Makefile, with variables of it; skips where a program or a header for it is missing."""
    for need in ("make", *needs):
        if not (Path(need).exists() if need.startswith("/") else shutil.which(need)):
            pytest.skip(f"{need} is not installed")
    command = ["make", "-C", str(source), f"OUT={folder}", *variables, str(folder / target)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / target


def open_library(path: Path) -> ctypes.CDLL:
    """The library with its functions declared."""
    library = ctypes.CDLL(str(path))
    memory, word, data = ctypes.c_void_p, ctypes.c_uint16, ctypes.c_char_p
    sample = (ctypes.c_int16, ctypes.c_uint16)
    for short, values in (("amp", 2), ("daq", 1)):
        getattr(library, f"{short}_size").restype = ctypes.c_size_t
        getattr(library, f"{short}_boot").argtypes = (memory, ctypes.c_uint32)
        getattr(library, f"{short}_tick").argtypes = (memory, *[ctypes.c_int32] * values, *sample)
        answer = getattr(library, f"{short}_answer")
        answer.argtypes = (memory, ctypes.c_int, ctypes.c_uint8, data, word, data, word)
        answer.restype = word
    library.amp_output.argtypes = (memory,)
    library.amp_output.restype = ctypes.c_int32
    library.daq_now.argtypes = (memory, ctypes.c_int32)
    return library


def sealed(body: str) -> str:
    """A line with its check word."""
    return f"{body} *{crc16(body.encode()):04X}"


def frame(body: bytes) -> bytes:
    """An RTU frame from its address and what follows."""
    return body + crc16(body).to_bytes(2, "little")


class Reply(NamedTuple):
    """The code of a refusal, 0 for none, and the words that were read."""

    code: int
    words: list[int]


class Status(dict):
    """Raw values of the status block by name, and as ``samples`` what the ring's window shows."""

    samples: list[tuple[int, ...]]


def read_line(text: str) -> Reply:
    """A reply in the line framing, its check word proved."""
    body, _, _ = text.rpartition(" *")
    assert text == sealed(body)
    kind, *numbers = body.split(" ")
    return Reply(int(numbers[0]), []) if kind == "!" else Reply(0, [int(word, 16) for word in numbers])


def status_of(m: RegisterMap, words: list[int]) -> Status:
    """The whole status block by name."""
    status = Status(m.decode("status", words))
    status.samples = m.records(words, status["ring_count"])
    return status


class Device:
    """One device of the library with its own memory; it uses the text framing by default."""

    def __init__(self, library: ctypes.CDLL, name: str, boot_count: int = 7) -> None:
        self.map = load_register_map(name)
        self._library, self._short = library, _SHORT[name]
        self._memory = ctypes.create_string_buffer(self._call("size"))
        self._reply = ctypes.create_string_buffer(_ROOM)
        self.boot(boot_count)

    def boot(self, boot_count: int) -> None:
        """A start, after which sequences begin anew."""
        self._sequence, self._epoch = 0, boot_count
        self._call("boot", self._memory, boot_count)

    def _call(self, what: str, *arguments):
        return getattr(self._library, f"{self._short}_{what}")(*arguments)

    @property
    def memory(self) -> bytes:
        """The whole state of the device."""
        return self._memory.raw

    @property
    def output_uA(self) -> int:
        return self._call("output", self._memory)

    def tick(self, *inputs: int, times: int = 1) -> None:
        for _ in range(times):
            self._call("tick", self._memory, *inputs)

    def now(self, raw_counts: int) -> None:
        self._call("now", self._memory, raw_counts)

    def answer(self, request: bytes, framing: int, address: int | None = None, room: int = _ROOM) -> bytes:
        """The reply's bytes, none where there is none."""
        address = self.map.device.default_address if address is None else address
        n = self._call("answer", self._memory, framing, address, request, len(request), self._reply, room)
        return self._reply.raw[:n]

    def line(self, text: str) -> str | None:
        """Send one line and return the reply, both without their ends."""
        reply = self.answer(text.encode("latin-1") + b"\n", LINES).decode()
        return reply.removesuffix("\n") or None

    def ask(self, body: str) -> Reply:
        """A line that is sent with its check word, and its reply understood."""
        return read_line(self.line(sealed(body)) or "")

    def read(self, name: str) -> int:
        """One register as it stands, without a sign."""
        r = self.map[name]
        words = self.ask(f"r {r.address:x} {r.words:x}").words
        return words[0] << 16 | words[1] if r.words == 2 else words[0]

    def status(self) -> Status:
        reply = self.ask(f"r 0 {self.map.size('status'):x}")
        assert reply.code == 0
        return status_of(self.map, reply.words)

    def settings(self, **values: int) -> int:
        """Writes the whole block, safe values where none is given; the code of a refusal."""
        safe = {r.name: r.safe or 0 for r in self.map.blocks["settings"]}
        return self.ask(_write(self.map.start("settings"), self.map.encode("settings", safe | values))).code

    def command(self, **values: int) -> int:
        """Writes the command block up to the last value that is given, with a new sequence unless one is given.

        An order that arms carries the nonce of the status, unless another one is given.
        """
        self._sequence += 1
        arms = "nonce" in self.map.names["command"] and values.get("order") in (ARM, REARM)
        nonce = {"nonce": self.read("arm_nonce")} if arms else {}  # as a host does
        values = {"sequence": self._sequence, "epoch": self._epoch, **nonce, **values}
        words, length = [], 0
        for r in self.map.blocks["command"]:
            words += to_words(values.get(r.name, 0), r.words)
            length = len(words) if r.name in values else length
        return self.ask(_write(self.map.start("command"), words[:length])).code


def _write(at: int, words: list[int]) -> str:
    return " ".join(["w", f"{at:04x}", *(f"{word:04x}" for word in words)])
