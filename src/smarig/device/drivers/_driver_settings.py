"""Settings of a driver's own: the table [links.DEVICE.settings] of a rig file, checked by the driver's model."""

from typing import TypeVar

from smarig.config import LinkFile
from smarig.core import TomlTable, check_table

Settings = TypeVar("Settings", bound=TomlTable)


def settings_of(where: LinkFile, model: type[Settings]) -> Settings:
    """The settings of a link. Raises ConfigError naming the driver and the key."""
    return check_table(model, where.settings, f"settings of driver {where.driver}")
