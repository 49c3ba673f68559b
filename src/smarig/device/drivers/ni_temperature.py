"""A temperature on an NI device: a linear sensor or a thermocouple on an analogue input. Untested on hardware."""

from typing import Literal

from pydantic import Field, model_validator

from smarig.config import LinkFile, RigFile
from smarig.core import TomlTable
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._ni import (
    NiInput,
    NiInputs,
    close_task,
    closed_on_failure,
    device_name,
    identity_of,
    ni_errors,
    ni_package,
)

LEAST_DEGC, MOST_DEGC = 0.0, 300.0  # expected range, which selects the gain


class NiThermocouple(TomlTable):
    """A thermocouple on a device with a cold junction of its own."""

    channel: str = Field(min_length=1, max_length=40)  # "ai0"
    type: Literal["E", "J", "K", "R", "S", "T"]  # of the thermocouple


class NiTemperatureSettings(TomlTable):
    """[links.thermometer.settings] of ni_temperature. Either ``input`` or ``thermocouple``."""

    input: NiInput | None = None  # sensor with a voltage, in °C
    thermocouple: NiThermocouple | None = None  # on a device with a cold junction

    @model_validator(mode="after")
    def _one_kind(self) -> "NiTemperatureSettings":
        if (self.input is None) == (self.thermocouple is None):
            raise ValueError("give either input (linear sensor) or thermocouple")
        return self


def ni_temperature(where: LinkFile, rig: RigFile) -> "NiLinearTemperature | NiThermocoupleTemperature":
    """The thermometer of a rig file."""
    del rig
    settings = settings_of(where, NiTemperatureSettings)
    device = device_name(where)
    if settings.input is not None:
        return NiLinearTemperature(device, settings.input)
    assert settings.thermocouple is not None  # noqa: S101 - the model requires one of them
    return NiThermocoupleTemperature(device, settings.thermocouple)


class NiLinearTemperature:
    """T = scale · V + offset."""

    def __init__(self, device: str, sensor: NiInput) -> None:
        self.identity = f"{identity_of(device)}, {sensor.channel}"
        self._inputs = NiInputs(device, [sensor])

    def temperature_degC(self) -> float:
        """The temperature now."""
        return self._inputs.values()[0]

    def close(self) -> None:
        """Give the input back."""
        self._inputs.close()


class NiThermocoupleTemperature:
    """The temperature as NI-DAQmx computes it."""

    def __init__(self, device: str, sensor: NiThermocouple) -> None:
        self._device = device
        self.identity = f"{identity_of(device)}, {sensor.channel}"
        with ni_errors(device):
            constants = ni_package().constants
            self._task = ni_package().Task()
            with closed_on_failure(self._task):
                self._task.ai_channels.add_ai_thrmcpl_chan(
                    f"{device}/{sensor.channel}",
                    min_val=LEAST_DEGC,
                    max_val=MOST_DEGC,
                    units=constants.TemperatureUnits.DEG_C,
                    thermocouple_type=constants.ThermocoupleType[sensor.type],
                    cjc_source=constants.CJCSource.BUILT_IN,
                )

    def temperature_degC(self) -> float:
        """The temperature now."""
        with ni_errors(self._device):
            return float(self._task.read())

    def close(self) -> None:
        """Give the input back."""
        close_task(self._task)
