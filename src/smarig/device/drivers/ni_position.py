"""A position on an NI device: a sensor on an analogue input, or an encoder on a counter. Untested on hardware."""

from pydantic import Field, model_validator

from smarig.config import LinkFile, RigFile
from smarig.device.drivers._analogue_stage import RangeSettings
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
from smarig.device.drivers._ni_sampled_counter import NiSampledCounter


class NiPositionSettings(RangeSettings):
    """[links.encoder_daq.settings] of ni_position. Either ``input`` with ``unit``, or ``counter``."""

    input: NiInput | None = None  # laser, LVDT or potentiometer, in ``unit``
    counter: str = Field(
        default="", max_length=40
    )  # counter of an encoder: "ctr0"; A and B at its default terminals
    clock: str = Field(
        default="", pattern="^(ctr[0-9]+)?$"
    )  # second counter, whose pulses sample the first: "ctr1"

    @model_validator(mode="after")
    def _one_kind(self) -> "NiPositionSettings":
        if (self.input is None) == (not self.counter):
            raise ValueError("give either input (analogue sensor) or counter (encoder)")
        if self.clock and (not self.counter or self.clock == self.counter):
            raise ValueError("clock is a second counter, beside that of the encoder")
        return self


def ni_position(where: LinkFile, rig: RigFile) -> "NiAnaloguePosition | NiCounterPosition | NiSampledCounter":
    """The position of a rig file, with ticks of its own if it has a ``clock``."""
    settings = settings_of(where, NiPositionSettings)
    if settings.clock:
        return NiSampledCounter(
            device_name(where), settings.counter, settings.clock, rig.period_s, rig.ambient_degC
        )
    return NiAnaloguePosition(where, settings) if settings.input else NiCounterPosition(where, settings)


class NiAnaloguePosition:
    """y = scale · V + offset; NaN outside minimum … maximum."""

    absolute = True  # its zero survives a restart

    def __init__(self, where: LinkFile, settings: NiPositionSettings) -> None:
        assert settings.input is not None  # noqa: S101 - see ni_position
        assert settings.unit is not None  # noqa: S101 - the model requires it
        device = device_name(where)
        self._settings, self.unit = settings, settings.unit
        self.identity = f"{identity_of(device)}, {settings.input.channel}"
        self._inputs = NiInputs(device, [settings.input])

    def position(self) -> float:
        """The position now."""
        (found,) = self._inputs.values()
        return self._settings.within(found)

    def close(self) -> None:
        """Give the input back."""
        self._inputs.close()


class NiCounterPosition:
    """Four counts per line of an encoder, counted in hardware from opening on (NI-DAQmx: encoder in ticks)."""

    unit = "count"

    def __init__(self, where: LinkFile, settings: NiPositionSettings) -> None:
        self._device = device = device_name(where)
        self.identity = f"{identity_of(device)}, {settings.counter}"
        with ni_errors(device):
            constants = ni_package().constants
            self._task = ni_package().Task()
            with closed_on_failure(self._task):
                self._task.ci_channels.add_ci_ang_encoder_chan(
                    f"{device}/{settings.counter}",
                    decoding_type=constants.EncoderType.X_4,
                    units=constants.AngleUnits.TICKS,
                )
                self._task.start()

    def position(self) -> float:
        """Counts since opening."""
        with ni_errors(self._device):
            return float(self._task.read())

    def close(self) -> None:
        """Give the counter back."""
        close_task(self._task)
