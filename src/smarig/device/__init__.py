"""Instruments: framings and register maps (``encoding``), links, and one driver per instrument."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.device.contract.contract_case import Check as Check
    from smarig.device.contract.contract_case import ContractCase as ContractCase
    from smarig.device.contract.driver_contract import ROLES as ROLES
    from smarig.device.contract.driver_contract import Role as Role
    from smarig.device.contract.driver_contract import check_contract as check_contract
    from smarig.device.contract.driver_contract import contract as contract
    from smarig.device.drivers._conversation import ATTEMPTS as ATTEMPTS
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
    from smarig.device.links.network_address import no_scheme_text as no_scheme_text
    from smarig.device.links.shared_text_line import SharedTextLine as SharedTextLine
    from smarig.device.links.shared_text_line import shared_text_line as shared_text_line
    from smarig.device.links.text_line import TextLine as TextLine
    from smarig.device.polled.adapted import as_current_source as as_current_source
    from smarig.device.polled.adapted import as_force_input as as_force_input
    from smarig.device.polled.adapted import as_position_sensor as as_position_sensor
    from smarig.device.polled.adapted import as_temperature_input as as_temperature_input
    from smarig.device.polled.current_loop import CurrentLoop as CurrentLoop
    from smarig.device.polled.falling_current import OFF_PAUSE_S as OFF_PAUSE_S
    from smarig.device.polled.falling_current import current_after_off as current_after_off
    from smarig.device.polled.from_functions import FunctionInput as FunctionInput
    from smarig.device.polled.from_functions import FunctionOutput as FunctionOutput
    from smarig.device.polled.host_clock import HostClock as HostClock
    from smarig.device.polled.polled_position import PolledPosition as PolledPosition
    from smarig.device.polled.polled_source import PolledSource as PolledSource
    from smarig.device.polled.readings import number_from as number_from
    from smarig.device.roles.polled import CurrentOutput as CurrentOutput
    from smarig.device.roles.polled import Electrical as Electrical
    from smarig.device.roles.polled import ForceInput as ForceInput
    from smarig.device.roles.polled import PolledInstrument as PolledInstrument
    from smarig.device.roles.polled import PolledOutput as PolledOutput
    from smarig.device.roles.polled import PositionInput as PositionInput
    from smarig.device.roles.polled import TemperatureInput as TemperatureInput
    from smarig.device.roles.polled import VoltageOutput as VoltageOutput
    from smarig.device.roles.ticked import NO_MEASURED_CURRENT as NO_MEASURED_CURRENT
    from smarig.device.roles.ticked import AbsoluteZero as AbsoluteZero
    from smarig.device.roles.ticked import CurrentReading as CurrentReading
    from smarig.device.roles.ticked import CurrentSource as CurrentSource
    from smarig.device.roles.ticked import PositionReading as PositionReading
    from smarig.device.roles.ticked import PositionSensor as PositionSensor
    from smarig.device.roles.ticked import missing_members as missing_members
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
