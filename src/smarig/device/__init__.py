"""Instruments: framings and register maps (``encoding``), links, and one driver per instrument."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.device.drivers._conversation import ATTEMPTS as ATTEMPTS
    from smarig.device.drivers._roles import CurrentReading as CurrentReading
    from smarig.device.drivers._roles import CurrentSource as CurrentSource
    from smarig.device.drivers._roles import PositionReading as PositionReading
    from smarig.device.drivers._roles import PositionSensor as PositionSensor
    from smarig.device.drivers._roles import missing_members as missing_members
    from smarig.device.drivers.smarig_amplifier import smarig_amplifier as smarig_amplifier
    from smarig.device.encoding.crc import crc16 as crc16
    from smarig.device.encoding.exchange import Exchange as Exchange
    from smarig.device.encoding.exchange import Refusal as Refusal
    from smarig.device.encoding.link_faults import Garbled as Garbled
    from smarig.device.encoding.link_faults import LinkFault as LinkFault
    from smarig.device.encoding.link_faults import Silent as Silent
    from smarig.device.encoding.link_faults import WrongDevice as WrongDevice
    from smarig.device.encoding.register import VALUE_RANGES as VALUE_RANGES
    from smarig.device.encoding.register import RawValues as RawValues
    from smarig.device.encoding.register import Register as Register
    from smarig.device.encoding.register import RegisterMap as RegisterMap
    from smarig.device.encoding.register import from_words as from_words
    from smarig.device.encoding.register import load_register_map as load_register_map
    from smarig.device.encoding.register import to_words as to_words
    from smarig.device.links.text_line import TextLine as TextLine
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
