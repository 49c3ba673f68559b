"""A LabJack T4, T7 or T8 over Modbus TCP: typed reads and writes on a connection that all its roles share."""

import math
import struct
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from pydantic import Field

from smarig.config import LinkFile
from smarig.core import NAN, ConfigError, Number, TomlTable
from smarig.device.drivers import _labjack_registers as reg
from smarig.device.encoding.exchange import Exchange, Refusal
from smarig.device.encoding.link_faults import Garbled, LinkFault, Refused, Silent, WrongDevice
from smarig.device.links.shared_link import shared

ADDRESS = 1  # a LabJack ignores it
TRIES = 3  # of one request: reads and absolute values may be repeated
LONGEST_BLOCK = 8  # channels that are read at once, including unused ones between them


class AnalogueChannel(TomlTable):
    """An analogue input: value = scale · V + offset. Without range or resolution, those of the box are kept."""

    channel: int = Field(ge=0, le=254)  # number of the input: 0 for AIN0
    scale: Number = Field(ge=-1e9, le=1e9)  # unit per volt
    offset: Number = Field(default=0.0, ge=-1e9, le=1e9)  # unit at 0 V
    range_V: Number | None = Field(default=None, gt=0, le=20)  # largest voltage, of those that the box has
    resolution_index: int | None = Field(default=None, ge=0, le=16)  # 0: default; higher: slower, less noise
    negative_channel: int | None = Field(default=None, ge=0, le=254)  # T7: differential; 199: ground


class LabJack:
    """One role's access to the box. The constructor checks the product."""

    def __init__(self, where: LinkFile) -> None:
        if where.framing != "modbus_tcp":
            raise ConfigError(f'A LabJack uses framing = "modbus_tcp"; the rig file gives "{where.framing}".')
        self._link = shared(where, ADDRESS)
        with self.let_go_on_failure():
            self.product = self._product()
            serial, version = self.whole(reg.SERIAL_NUMBER), self.number(reg.FIRMWARE_VERSION)
        self.identity = f"LabJack {reg.PRODUCTS[self.product]} {serial}, firmware {version:.4f}"
        self.where = self._link.where

    def number(self, at: int) -> float:
        """A FLOAT32."""
        return self.numbers(at, 1)[0]

    def numbers(self, at: int, count: int) -> list[float]:
        """Consecutive FLOAT32."""
        words = self._exchanged(Exchange(at, 2 * count))
        return list(struct.unpack(f">{count}f", struct.pack(f">{2 * count}H", *words)))

    def whole(self, at: int) -> int:
        """A UINT32."""
        high, low = self._exchanged(Exchange(at, 2))
        return high << 16 | low

    def write_number(self, at: int, value: float) -> None:
        """Write a FLOAT32."""
        self._exchanged(Exchange(write_at=at, words=struct.unpack(">2H", struct.pack(">f", value))))

    def write_whole(self, at: int, value: int) -> None:
        """Write a UINT32."""
        self._exchanged(Exchange(write_at=at, words=(value >> 16, value & 0xFFFF)))

    def write_word(self, at: int, value: int) -> None:
        """Write a UINT16."""
        self._exchanged(Exchange(write_at=at, words=(value,)))

    def configure(self, inputs: Iterable[AnalogueChannel]) -> None:
        """Write what the settings say about inputs; the box keeps it until it restarts."""
        for one in inputs:
            if one.range_V is not None:
                self.write_number(reg.AIN_RANGE + 2 * one.channel, one.range_V)
            if one.resolution_index is not None:
                self.write_word(reg.AIN_RESOLUTION_INDEX + one.channel, one.resolution_index)
            if one.negative_channel is not None:
                self.write_word(reg.AIN_NEGATIVE_CHANNEL + one.channel, one.negative_channel)

    def values(self, *inputs: AnalogueChannel) -> list[float]:
        """The values of analogue inputs now, in one request where their numbers are near; NaN without a reading."""
        first, last = min(i.channel for i in inputs), max(i.channel for i in inputs)
        if last - first < LONGEST_BLOCK:
            block = self.numbers(reg.AIN + 2 * first, last - first + 1)
            volts = [block[one.channel - first] for one in inputs]
        else:
            volts = [self.number(reg.AIN + 2 * one.channel) for one in inputs]
        return [one.scale * reading(volt) + one.offset for one, volt in zip(inputs, volts)]

    def close(self) -> None:
        """Leave the connection."""
        self._link.close()

    @contextmanager
    def let_go_on_failure(self) -> Iterator[None]:
        """Leave the connection if the body raises, because nobody else closes it then."""
        try:
            yield
        except BaseException:
            self._link.close()
            raise

    def _product(self) -> int:
        found = self.number(reg.PRODUCT_ID)
        if found not in reg.PRODUCTS:
            raise WrongDevice(
                f"The device at {self._link.where} has product number {found:g}. A LabJack T4, T7 or T8 is required."
            )
        return int(found)

    def _exchanged(self, exchange: Exchange) -> list[int]:
        """The reply, after repetitions if it is lost. Raises the last fault."""
        last: LinkFault = Silent(f"{self._link.where}: no reply. {Silent.remedy}")
        for _ in range(TRIES):
            try:
                reply = self._link.exchange(exchange)
            except (Silent, Garbled) as fault:
                last = fault
                continue
            if isinstance(reply, Refusal):
                at = exchange.write_at if exchange.words else exchange.read_at
                raise Refused(
                    f"The LabJack at {self._link.where} refused register {at}: {reply}.", reply.code
                )
            return reply
        raise last


def reading(value: float) -> float:
    """A reading; NaN for what the box sends if it has none."""
    return value if math.isfinite(value) and value > reg.NO_READING + 1 else NAN
