"""A conversation with one device in exchanges that are proven fresh, repeated at most a few times, never done twice.

A repeated exchange carries the same sequence word, and the device answers it without doing it again: so a lost reply
costs a repetition, and a lost request nothing. A line that stays silent is opened anew once; a port that is gone is
waited for a little. Knows maps and links; what registers mean for a rig is the drivers' business.

A late reply is never taken for the answer to another request. A granted command proves itself by its echo. Refusals,
handshakes and settings carry no sequence word: while a reply to an earlier request may still come, they are believed
only on a line that has been resynchronised, by a read of a length that no reply under way has. Replies come in the
order of requests, so none to an earlier request can follow it.
"""

import random
import time
from collections.abc import Iterator, Mapping
from itertools import accumulate, cycle, islice
from typing import NamedTuple

from smarig.core import ConfigError
from smarig.device.links.link import Link
from smarig.device.wire.exchange import Exchange, Refusal
from smarig.device.wire.link_faults import Garbled, Rebooted, Refused, Silent, Stale, WrongDevice, WrongMap
from smarig.device.wire.register import RawValues, RegisterMap

ATTEMPTS = 3  # on an open line, and once more on a line opened anew
STALE_REPLIES = 4  # thrown away before a request is repeated
FINAL = (1, 2, 3, 4)  # refusals of a request that was understood: to repeat it is of no use
PAUSES_S = (0.1, 0.2)  # between looks for a port that is gone: less than the least lease together
PROBED = 2  # records of the ring, at most, that a read takes in for its length alone


class Status(NamedTuple):
    """A device's answer: raw values by register, raw records of its ring, whether it took several attempts."""

    values: RawValues
    records: list[tuple[int, ...]]
    retried: bool


class _NoPort(Silent):
    """There is nothing to open."""


class Conversation:
    """With one device. ``handshake`` first."""

    def __init__(self, link: Link, map_: RegisterMap) -> None:
        self.link, self.map = link, map_
        self._sequence = 0
        self._boots: int | None = None
        ring = map_["ring"]
        self._head = ring.address - map_.start("status")
        self._record = ring.record_words
        self._most = ring.count
        self._lengths = probe_lengths(map_)
        self._late = True  # replies to earlier requests, of another process too, may still come

    @property
    def name(self) -> str:
        """Which device, and where."""
        return f"{self.map.device.name} at {self.link.where}"

    @property
    def identity(self) -> str:
        """The device, its map and how often it has started."""
        d = self.map.device
        return f"{self.name}, map version {d.version}, hash {self.map.hash:08X}, boot {self._boots}"

    def handshake(self) -> RawValues:
        """Is it the right device with the right map? Raises WrongDevice, WrongMap; returns its status."""
        if self._boots is None:  # no length of its map before the map is known to be its own
            self._late = False
            self._status()
            self._late = True
        values = self._status()
        self._boots = values["boot_count"]
        self._sequence = values["echo"]  # lest the first command pass for a repetition of the last one heard
        return values

    def _status(self) -> RawValues:
        words, _ = self._insisted(Exchange(self.map.start("status"), self._head))
        values = self.map.decode("status", words)
        self._check_identity(values)
        return values

    def settings(self, values: Mapping[str, int]) -> None:
        """Write the settings block and read it back. Raises ConfigError for what no such device keeps."""
        for name, raw in values.items():
            low, high = self.map[name].limits
            if not low <= raw <= high:
                v = self.map[name].value
                raise ConfigError(
                    f"{name} = {v.decode(raw):g} {v.unit} is outside {v.decode(low):g}…{v.decode(high):g} {v.unit}, "
                    f"which the {self.map.device.name} allows: mend the rig file."
                )
        written = self.map.encode("settings", values)
        at = self.map.start("settings")
        words, _ = self._insisted(Exchange(at, len(written), at, tuple(written)))
        if words != written:
            raise Garbled(f"The {self.name} keeps other settings than were written. {Garbled.remedy}")

    def command(self, values: Mapping[str, int], records: int = 0) -> Status:
        """Write the command block with a new sequence word, and read the status with up to so many samples."""
        self._sequence = self._sequence % 0xFFFF + 1
        records = min(records, self._most)
        written = self.map.encode("command", {"ring_want": records, **values, "sequence": self._sequence})
        count = self._head + records * self._record
        e = Exchange(self.map.start("status"), count, self.map.start("command"), tuple(written))
        words, retried = self._insisted(e, self._sequence)
        status = self.map.decode("status", words[: self._head])
        if status["boot_count"] != self._boots:
            self._boots = status["boot_count"]
            raise Rebooted(
                f"The {self.name} has started anew (boot {status['boot_count']}): look for a brown-out or a "
                "watchdog reset."
            )
        found = self.map.records(words, min(status["ring_count"], records))
        return Status(status, found, retried)

    def first_tick(self, status: Status, requested_tick: int) -> int:
        """The tick of the first record: not before the one that was asked for, the last not after the device's own."""
        first, own = status.values["ring_first"], status.values["tick"]
        if status.records and not requested_tick <= first <= own - len(status.records) + 1:
            raise Garbled(
                f"The {self.name} gives samples of tick {first} on where those from {requested_tick} on were asked "
                "for, and "
                f"has counted {own}: its ring cannot be trusted. {Garbled.remedy}"
            )
        return first

    def _insisted(self, e: Exchange, sequence: int | None = None) -> tuple[list[int], bool]:
        """The words of a fresh reply, and whether it took more than one attempt."""
        late, self._late = self._late, True
        proven = sequence is not None  # by its echo; a refusal has none
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
                    proven = False  # it may be a late one: ask again on a line without
                    continue
                self._late = sent > 1
                return self._granted(reply), attempt > 0
            except (Silent, Garbled, Stale) as failed:
                attempt += 1
                if attempt == 2 * ATTEMPTS or isinstance(failed, _NoPort):
                    raise type(failed)(f"The {self.map.device.name} cannot be reached. {failed}") from None

    def _fresh(self, e: Exchange, sequence: int | None) -> list[int] | Refusal:
        """The reply, without those that have another echo."""
        reply = self._send(e)
        for _ in range(STALE_REPLIES):
            if isinstance(reply, Refusal):
                if reply.code in FINAL:
                    return reply  # else of what was heard, not of what was meant
                raise Garbled(f"{self.link.where}: the device answers {reply}. {Garbled.remedy}")
            if sequence is None or reply[0] == sequence:
                return reply
            reply = self.link.more(e)
        raise Stale(f"{self.link.where}: replies to other requests only. {Stale.remedy}")

    def _granted(self, reply: list[int] | Refusal) -> list[int]:
        if isinstance(reply, Refusal):
            raise Refused(f"The {self.name} refuses: {reply}.", reply.code)
        return reply

    def _resynchronise(self) -> None:
        """Read so many words as no reply under way has; once they are there, every late reply has come."""
        e = Exchange(self.map.start("status"), next(self._lengths))
        reply = self._send(e)
        for _ in range(STALE_REPLIES):
            if not isinstance(reply, Refusal) and len(reply) == e.count:
                self._check_identity(self.map.decode("status", reply[: self._head]))
                return
            reply = self.link.more(e)
        raise Stale(f"{self.link.where}: replies to other requests only. {Stale.remedy}")

    def _send(self, e: Exchange) -> list[int] | Refusal:
        return self.link.exchange(e)

    def _reopened(self) -> None:
        """Opened anew, and still the right device. Who trips over a plug puts it in again: its port may come back."""
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

    def _check_identity(self, values: Mapping[str, int]) -> None:
        device = self.map.device
        if values["kind"] != device.kind:
            raise WrongDevice(
                f"At {self.link.where} answers a device of kind 0x{values['kind']:04X}, not the {device.name} "
                f"(0x{device.kind:04X}): are the two lines exchanged in the rig file?"
            )
        if values["map_hash"] != self.map.hash:
            behind = "smarig" if values["version"] > device.version else "its firmware"
            raise WrongMap(
                f"The {self.name} has register map version {values['version']}, hash {values['map_hash']:08X}; "
                f"this smarig has version {device.version}, hash {self.map.hash:08X}. Bring {behind} up to date: "
                "firmware is built from firmware_protocol/."
            )


def probe_lengths(map_: RegisterMap) -> Iterator[int]:
    """Lengths of a read of the status block that no other exchange has, in turn and without end.

    The first is any of them: replies to a process that has just been killed may still come.
    """
    ring = map_["ring"]
    head = ring.address - map_.start("status")
    ends = [r.address + r.words - map_.start("status") for r in map_.blocks["status"][:-1]]
    ends += accumulate([f.words for f in ring.field] * PROBED, initial=head)
    taken = {map_.size("settings"), *(head + k * ring.record_words for k in range(PROBED + 1))}
    identity = map_["boot_count"].address + 1 - map_.start("status")
    lengths = sorted({end for end in ends if end >= identity} - taken)
    return islice(cycle(lengths), random.SystemRandom().randrange(len(lengths)), None)
