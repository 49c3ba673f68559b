"""A temperature on a LabJack: a linear sensor on an analogue input, or a result of the box's extended features."""

from typing import Literal

from pydantic import Field, model_validator

from smarig.config import LinkFile, RigFile
from smarig.core import TomlTable
from smarig.device.drivers import _labjack_registers as reg
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._labjack import AnalogueChannel, LabJack, reading


class ExtendedFeature(TomlTable):
    """A result that the box computes itself, in °C. ``configured``: as another program has configured it (Pt100)."""

    channel: int = Field(ge=0, le=254)  # number of the input
    thermocouple: Literal["E", "J", "K", "R", "T"] | None = None  # type; the cold junction is the box
    configured: bool = False  # read what is configured, in °C


class LabJackTemperatureSettings(TomlTable):
    """[links.thermometer.settings] of labjack_temperature. Either ``input`` or ``feature``."""

    input: AnalogueChannel | None = None  # sensor with a voltage, in °C
    feature: ExtendedFeature | None = None  # thermocouple, or another result of the box

    @model_validator(mode="after")
    def _one_kind(self) -> "LabJackTemperatureSettings":
        if (self.input is None) == (self.feature is None):
            raise ValueError("give either input (linear sensor) or feature (thermocouple, Pt100)")
        if self.feature and (self.feature.thermocouple is None) != self.feature.configured:
            raise ValueError("feature needs either thermocouple or configured = true")
        return self


def labjack_temperature(where: LinkFile, rig: RigFile) -> "LabJackTemperature":
    """The thermometer of a rig file."""
    del rig
    return LabJackTemperature(where, settings_of(where, LabJackTemperatureSettings))


class LabJackTemperature:
    """A thermometer; NaN without a reading, as with a broken thermocouple."""

    def __init__(self, where: LinkFile, settings: LabJackTemperatureSettings) -> None:
        self._input, self._feature = settings.input, settings.feature
        self._box = LabJack(where)
        with self._box.let_go_on_failure():
            if self._input:
                self._box.configure([self._input])
            elif self._feature and self._feature.thermocouple:
                self._configure(self._feature.channel, self._feature.thermocouple)
        used = self._input or self._feature
        self.identity = f"{self._box.identity}, AIN{used.channel if used else 0}"

    def temperature_degC(self) -> float:
        """The temperature now."""
        if self._input:
            return self._box.values(self._input)[0]
        assert self._feature is not None  # noqa: S101 - the model requires one of them
        return reading(self._box.number(reg.AIN_EF_READ_A + 2 * self._feature.channel))

    def close(self) -> None:
        """Leave the connection."""
        self._box.close()

    def _configure(self, channel: int, kind: str) -> None:
        for base, value in (
            (reg.AIN_EF_INDEX, 0),
            (reg.AIN_EF_INDEX, reg.THERMOCOUPLES[kind]),
            (reg.AIN_EF_CONFIG_A, 1),
            (reg.AIN_EF_CONFIG_B, reg.COLD_JUNCTION),
        ):
            self._box.write_whole(base + 2 * channel, value)
