"""Exchanges with one device: every reply is proven fresh, and a repeated request is never executed twice.

A repeated exchange carries the same sequence, and the device replies without executing it again. A lost reply
therefore costs one repetition, and a lost request has no effect. Every command also carries the boot for which it was
made: a device that has restarted executes none of them, and its replies tell. A line without replies is reopened
once. If the port has disappeared, the host waits briefly for it.

A late reply is never taken for the reply to another request. The echo of its sequence identifies the reply to a
command. Refusals, handshakes and settings carry no sequence: while a reply to an earlier request may still come,
they are accepted only after the line has been resynchronised by a read whose length differs from all pending replies.
Replies come in the order of requests, so no reply to an earlier request can follow.
"""

import random
import time
from collections.abc import Iterator, Mapping
from itertools import accumulate, cycle, islice
from typing import NamedTuple

from smarig.core import ConfigError
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import (
    Garbled,
    Rebooted,
    Refused,
    Silent,
    Stale,
    WrongDevice,
    WrongMap,
)
from smarig.device.encoding.register import RawValues, RegisterMap, from_words
from smarig.device.links.link import Link

ATTEMPTS = 3  # on an open line, and the same number again after it was reopened
STALE_REPLIES = 4  # discarded before a request is repeated
NOT_NOW = 4  # the refusal of what is not possible in this state
FINAL = (1, 2, 3, NOT_NOW)  # refusals of a request that was received correctly: repeating it is useless
PAUSES_S = (0.1, 0.2)  # between attempts to open a missing port: in sum less than the shortest lease
COUNTED = 2**32  # a device counts its ticks modulo this
PROBED = 2  # largest number of ring records that a read of a probing length covers


class Status(NamedTuple):
    """A device's reply: raw values by register, raw records of its ring, whether it took several attempts."""

    values: RawValues
    records: list[tuple[int, ...]]
    retried: bool


class _NoPort(Silent):
    """The port does not exist."""


class Conversation:
    """Exchanges with one device. Call ``handshake`` first."""

    def __init__(self, link: Link, map_: RegisterMap) -> None:
        self.link, self.map = link, map_
        self._sequence = self._tick = 0
        self.version = map_.first_version  # of the device's map; the handshake tells
        self._boots: int | None = None
        ring = map_["ring"]
        self._head = ring.address - map_.start("status")
        self._record = ring.record_words
        self._most = ring.count
        self._lengths = probe_lengths(map_)
        self._late = True  # replies to earlier requests, also of another process, may still come
        self.reconnections = 0

    @property
    def name(self) -> str:
        """The device and its link."""
        return f"{self.map.device.name} at {self.link.where}"

    @property
    def identity(self) -> str:
        """The device, its map and its number of starts."""
        return f"{self.name}, map version {self.version}, hash {self.map.hash:08X}, boot {self._boots}"

    def handshake(self) -> RawValues:
        """Check that this is the right device with the right map. Returns its status; raises WrongDevice, WrongMap."""
        if self._boots is None:  # lengths are taken from the map, which is not yet verified
            self._late = False
            self._status()
            self._late = True
        values = self._status()
        self._follow(values)
        return values

    def _follow(self, values: Mapping[str, int]) -> None:
        """Continue where the device is: with its boot, its last sequence and its tick."""
        if self._boots != values["boot_count"]:
            self._tick = values["tick"]
        self._boots = values["boot_count"]
        self.version = values["version"]
        self._sequence = values["echo"]  # otherwise the device could take the first command for a repetition

    def _status(self) -> RawValues:
        words, _ = self._insisted(Exchange(self.map.start("status"), self._head))
        values = self.map.decode("status", words)
        self._check_identity(values)
        return values

    def settings(self, values: Mapping[str, int]) -> None:
        """Write the settings block and read it back. Raises ConfigError for values outside the register limits."""
        for name, raw in values.items():
            low, high = self.map[name].limits
            if not low <= raw <= high:
                v = self.map[name].value
                raise ConfigError(
                    f"{name} = {v.decode(raw):g} {v.unit} is outside {v.decode(low):g}…{v.decode(high):g} {v.unit}, "
                    f"which the {self.map.device.name} allows. Change the rig file."
                )
        written = self.map.encode("settings", values)[: self.map.size("settings", self.version)]
        at = self.map.start("settings")
        words, _ = self._insisted(Exchange(at, len(written), at, tuple(written)))
        if words != written:
            raise Garbled(f"The settings read back from the {self.name} differ. {Garbled.remedy}")

    def command(self, values: Mapping[str, int], records: int = 0) -> Status:
        """Write the command block with a new sequence; read the status with at most ``records`` samples.

        Ticks, also ``ring_next``, go on where those of the device wrap.
        """
        self._count_command()
        records = min(records, self._most)
        proof = {"sequence": self._sequence, "epoch": self._boots or 0}
        written = self.map.encode("command", {"ring_want": records, **values, **proof})
        count = self._head + records * self._record
        e = Exchange(self.map.start("status"), count, self.map.start("command"), tuple(written))
        words, retried = self._insisted(e, self._sequence)
        status = self.map.decode("status", words[: self._head])
        self._tick = status["tick"] = self._unwrapped(status["tick"])
        status["ring_first"] = self._unwrapped(status["ring_first"])
        found = self.map.records(words, min(status["ring_count"], records))
        return Status(status, found, retried)

    def _count_command(self) -> None:
        if self._sequence == self.map["sequence"].limits[1]:
            raise Refused(
                f"The {self.name} has executed {self._sequence:,} commands since it started, the most that it "
                "counts. Switch its supply off and on.",
                NOT_NOW,
            )
        self._sequence += 1

    def _unwrapped(self, tick: int) -> int:
        """The number nearest to the last tick that is this one to the device."""
        return self._tick + (tick - self._tick + COUNTED // 2) % COUNTED - COUNTED // 2

    def first_tick(self, status: Status, requested_tick: int) -> int:
        """The tick of the first record, checked: at or after the requested tick, and none after the device's tick."""
        first, own = status.values["ring_first"], status.values["tick"]
        if status.records and not requested_tick <= first <= own - len(status.records) + 1:
            raise Garbled(
                f"The {self.name} returned samples from tick {first} on; samples from {requested_tick} on were "
                "requested, "
                f"and its tick is {own}. Its ring buffer is inconsistent. {Garbled.remedy}"
            )
        return first

    def _insisted(self, e: Exchange, sequence: int | None = None) -> tuple[list[int], bool]:
        """The words of a fresh reply, and whether it took more than one attempt."""
        late, self._late = self._late, True
        proven = sequence is not None  # the echo proves a reply; a refusal has none
        attempt = sent = 0
        while True:
            try:
                if attempt == ATTEMPTS:
                    self._reopened()
                    late, sent = False, 0
                if late and not proven:
                    self._resynchronise()
                    late, sent = False, 0
                sent += 1
                reply = self._fresh(e, sequence)
                if late and isinstance(reply, Refusal):
                    proven = False  # the refusal may be a late one: resynchronise, then repeat
                    continue
                self._late = sent > 1
                return self._granted(reply), attempt > 0
            except (Silent, Garbled, Stale) as failed:
                attempt += 1
                if attempt == 2 * ATTEMPTS or isinstance(failed, _NoPort):
                    raise type(failed)(f"The {self.map.device.name} cannot be reached. {failed}") from None

    def _fresh(self, e: Exchange, sequence: int | None) -> list[int] | Refusal:
        """The reply; replies with another echo are skipped. Raises Rebooted if the device has restarted."""
        reply = self._send(e)
        for _ in range(STALE_REPLIES):
            if isinstance(reply, Refusal):
                if reply.code in FINAL:
                    return reply  # other codes mean that the request was not received correctly
                raise Garbled(f"{self.link.where}: the device refused: {reply}. {Garbled.remedy}")
            if sequence is None or self._echo(reply) == sequence:
                return reply
            self._check_boot(reply)
            reply = self.link.more(e)
        raise Stale(f"{self.link.where}: only replies to other requests arrived. {Stale.remedy}")

    def _echo(self, reply: list[int]) -> int:
        echo = self.map["echo"]
        return from_words(reply[echo.address - self.map.start("status") :][: echo.words], echo.type)

    def _check_boot(self, reply: list[int]) -> None:
        """Raise Rebooted if a reply to a command tells another boot: late replies are of this one, or of one before."""
        status = self.map.decode("status", reply[: self._head])
        if self._boots is not None and 0 < (status["boot_count"] - self._boots) % COUNTED < COUNTED // 2:
            self._follow(status)
            raise Rebooted(
                f"The {self.name} has restarted (boot {status['boot_count']}). Check for a brown-out or a "
                "watchdog reset."
            )

    def _granted(self, reply: list[int] | Refusal) -> list[int]:
        if isinstance(reply, Refusal):
            raise Refused(f"The {self.name} refused the request: {reply}.", reply.code)
        return reply

    def _resynchronise(self) -> None:
        """Read with a length that no pending reply has. When that reply arrives, all late replies have arrived."""
        e = Exchange(self.map.start("status"), next(self._lengths))
        reply = self._send(e)
        for _ in range(STALE_REPLIES):
            if not isinstance(reply, Refusal) and len(reply) == e.count:
                self._check_identity(self.map.decode("status", reply[: self._head]))
                return
            reply = self.link.more(e)
        raise Stale(f"{self.link.where}: only replies to other requests arrived. {Stale.remedy}")

    def _send(self, e: Exchange) -> list[int] | Refusal:
        return self.link.exchange(e)

    def _reopened(self) -> None:
        """Reopen the line and check the device. A port that was unplugged briefly may reappear."""
        for pause_s in (*PAUSES_S, None):
            try:
                self.link.reopen()
                break
            except Silent as no_port:
                if pause_s is None:
                    raise _NoPort(str(no_port)) from None
                time.sleep(pause_s)
        words = self._granted(self._fresh(Exchange(self.map.start("status"), self._head), None))
        self._check_identity(self.map.decode("status", words))
        self._resynchronise()
        self.reconnections += 1

    def _check_identity(self, values: Mapping[str, int]) -> None:
        device = self.map.device
        if values["kind"] != device.kind:
            raise WrongDevice(
                f"The device at {self.link.where} is of kind 0x{values['kind']:04X}, not the {device.name} "
                f"(0x{device.kind:04X}). Check whether the two lines are exchanged in the rig file."
            )
        if values["map_hash"] != self.map.hash:
            behind = "smarig" if values["version"] > device.version else "its firmware"
            raise WrongMap(
                f"The {self.name} has register map version {values['version']}, hash {values['map_hash']:08X}; "
                f"this smarig has version {device.version}, hash {self.map.hash:08X}. Update {behind}; "
                "firmware is built from firmware_protocol/."
            )


def probe_lengths(map_: RegisterMap) -> Iterator[int]:
    """Lengths of a read of the status block that no other exchange has, as an endless cycle.

    The start is random, because replies to a process that has just been killed may still come.
    """
    ring = map_["ring"]
    head = ring.address - map_.start("status")
    ends = [r.address + r.words - map_.start("status") for r in map_.blocks["status"][:-1]]
    ends += accumulate([f.words for f in ring.field] * PROBED, initial=head)
    settings = {map_.size("settings", version) for version in (map_.first_version, map_.device.version)}
    taken = settings | {*(head + k * ring.record_words for k in range(PROBED + 1))}
    identity = map_["boot_count"].address + map_["boot_count"].words - map_.start("status")
    lengths = sorted({end for end in ends if end >= identity} - taken)
    return islice(cycle(lengths), random.SystemRandom().randrange(len(lengths)), None)
