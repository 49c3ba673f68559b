"""Configuration files: TOML in, frozen and checked values out. Schemas in one file, where files are in another."""

from smarig.config.config_files import (
    load_actuator,
    load_campaign,
    load_rig,
    locate,
    own_drivers,
    rig_text,
    shipped_names,
)
from smarig.config.file_schemas import (
    ActuatorFile,
    CampaignFile,
    CampaignStep,
    LimitsFile,
    LinkFile,
    LinksFile,
    PositiveIn,
    ProtectionFile,
    Quantity,
    RigFile,
    SimulatorFile,
)

__all__ = [
    "ActuatorFile",
    "CampaignFile",
    "CampaignStep",
    "LimitsFile",
    "LinkFile",
    "LinksFile",
    "PositiveIn",
    "ProtectionFile",
    "Quantity",
    "RigFile",
    "SimulatorFile",
    "load_actuator",
    "load_campaign",
    "load_rig",
    "locate",
    "own_drivers",
    "rig_text",
    "shipped_names",
]
