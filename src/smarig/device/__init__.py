"""Instruments: framings and register maps (``wire``), links, and one driver per instrument."""

from typing import TYPE_CHECKING

from smarig.core.front_door import front_door

if TYPE_CHECKING:
    from smarig.device.drivers._roles import CurrentReading as CurrentReading
    from smarig.device.drivers._roles import CurrentSource as CurrentSource
    from smarig.device.drivers._roles import PositionReading as PositionReading
    from smarig.device.drivers._roles import PositionSensor as PositionSensor
    from smarig.device.drivers._roles import missing_members as missing_members
    from smarig.device.drivers.smarig_amplifier import smarig_amplifier as smarig_amplifier
    from smarig.device.links.text_line import TextLine as TextLine
    from smarig.device.wire.crc import crc16 as crc16
    from smarig.device.wire.exchange import Exchange as Exchange
    from smarig.device.wire.exchange import Refusal as Refusal
    from smarig.device.wire.link_faults import Garbled as Garbled
    from smarig.device.wire.link_faults import LinkFault as LinkFault
    from smarig.device.wire.link_faults import Silent as Silent
    from smarig.device.wire.link_faults import WrongDevice as WrongDevice
    from smarig.device.wire.register import VALUE_RANGES as VALUE_RANGES
    from smarig.device.wire.register import RawValues as RawValues
    from smarig.device.wire.register import Register as Register
    from smarig.device.wire.register import RegisterMap as RegisterMap
    from smarig.device.wire.register import from_words as from_words
    from smarig.device.wire.register import load_register_map as load_register_map
    from smarig.device.wire.register import to_words as to_words

__getattr__, __dir__, __all__ = front_door(__name__)
