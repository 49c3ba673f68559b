"""Configuration files: read from TOML into frozen, checked values."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.config.actuator_file import ActuatorFile as ActuatorFile
    from smarig.config.config_files import actuator_text as actuator_text
    from smarig.config.config_files import driver_names as driver_names
    from smarig.config.config_files import load_actuator as load_actuator
    from smarig.config.config_files import load_campaign as load_campaign
    from smarig.config.config_files import load_rig as load_rig
    from smarig.config.config_files import locate as locate
    from smarig.config.config_files import own_drivers as own_drivers
    from smarig.config.config_files import rig_text as rig_text
    from smarig.config.config_files import shipped_names as shipped_names
    from smarig.config.file_keys import FileKey as FileKey
    from smarig.config.file_keys import class_comments as class_comments
    from smarig.config.file_keys import comments_by_line as comments_by_line
    from smarig.config.file_keys import file_keys as file_keys
    from smarig.config.file_keys import file_tables as file_tables
    from smarig.config.file_keys import inner_model as inner_model
    from smarig.config.file_keys import type_text as type_text
    from smarig.config.file_keys import unit_of as unit_of
    from smarig.config.file_schemas import AmplifierFile as AmplifierFile
    from smarig.config.file_schemas import CampaignFile as CampaignFile
    from smarig.config.file_schemas import CampaignStep as CampaignStep
    from smarig.config.file_schemas import EncoderFile as EncoderFile
    from smarig.config.file_schemas import LimitsFile as LimitsFile
    from smarig.config.file_schemas import LinkFile as LinkFile
    from smarig.config.file_schemas import LinksFile as LinksFile
    from smarig.config.file_schemas import ProtectionFile as ProtectionFile
    from smarig.config.file_schemas import RigFile as RigFile
    from smarig.config.file_schemas import SimulatorFile as SimulatorFile
    from smarig.config.folder_source import data_led_out as data_led_out
    from smarig.config.folder_source import led_out as led_out
    from smarig.config.load_file import LoadFile as LoadFile
    from smarig.config.load_file import with_load as with_load
    from smarig.config.quantity import Quantity as Quantity
    from smarig.config.quantity import template_values as template_values
    from smarig.config.recorded_rig import rig_from_text as rig_from_text
    from smarig.config.thermomechanical_file import ThermomechanicalSection as ThermomechanicalSection
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
