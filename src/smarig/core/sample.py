"""The readings of a rig: one Sample per tick, with its quality."""

from enum import IntFlag
from typing import NamedTuple

NAN = float("nan")


class Quality(IntFlag):
    """Marks on a sample; 0 means good. Stored in the run as an integer.

    RETRIED: it took several requests. STALE: no new current reading. SATURATED: the amplifier could not drive the
    command. TRIPPED: the amplifier had tripped. SUSPECT: the readings contradict the command, each other or the wire.
    """

    GOOD = 0
    RETRIED = 1
    STALE = 2
    SATURATED = 4
    TRIPPED = 8
    SUSPECT = 16


class Sample(NamedTuple):
    """The readings of one tick. Time is the device's integer ``tick``; ``t_s`` is tick × period.

    ``counts`` are raw encoder counts since the last zero; ``position`` is the same in the rig's unit (mm or deg).
    ``temperature_degC`` is a measured wire temperature, or NaN without a sensor. This is a named tuple because a frozen
    dataclass takes three times as long in each tick.

    >>> Sample(tick=3, t_s=0.3, current_command_A=0.5, current_A=0.5, voltage_V=2.4,
    ...        temperature_degC=NAN, counts=12, position=0.565, ambient_degC=22.0, quality=0).counts
    12
    """

    tick: int
    t_s: float
    current_command_A: float
    current_A: float
    voltage_V: float
    temperature_degC: float
    counts: int
    position: float
    ambient_degC: float
    quality: int
