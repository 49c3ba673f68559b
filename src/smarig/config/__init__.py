"""Configuration files: TOML in, frozen and checked values out. Schemas in one file, where files are in another."""

from smarig.config.files import (
    listed,
    load_actuator,
    load_campaign,
    load_rig,
    locate,
    own_drivers,
    rig_text,
)
from smarig.config.schema import (
    ActuatorFile,
    CampaignFile,
    CampaignStep,
    In,
    LimitsFile,
    LinkFile,
    LinksFile,
    ProtectionFile,
    Quantity,
    RigFile,
    SimulatorFile,
)

__all__ = [
    "ActuatorFile",
    "CampaignFile",
    "CampaignStep",
    "In",
    "LimitsFile",
    "LinkFile",
    "LinksFile",
    "ProtectionFile",
    "Quantity",
    "RigFile",
    "SimulatorFile",
    "listed",
    "load_actuator",
    "load_campaign",
    "load_rig",
    "locate",
    "own_drivers",
    "rig_text",
]
