"""A position on a LabJack: a laser, LVDT or potentiometer on an analogue input, or an encoder on a counter."""

from pydantic import Field, model_validator

from smarig.config import LinkFile, RigFile
from smarig.core import NAN, ConfigError
from smarig.device.drivers import _labjack_registers as reg
from smarig.device.drivers._analogue_stage import RangeSettings
from smarig.device.drivers._driver_settings import settings_of
from smarig.device.drivers._labjack import AnalogueChannel, LabJack

WRAP = 1 << 32  # of the counter


class LabJackPositionSettings(RangeSettings):
    """[links.encoder_daq.settings] of labjack_position. Either ``input`` with ``unit``, or ``counter_line``."""

    input: AnalogueChannel | None = None  # laser, LVDT or potentiometer, in ``unit``
    counter_line: int | None = Field(default=None, ge=0, le=20)  # first DIO line of an encoder

    @model_validator(mode="after")
    def _one_kind(self) -> "LabJackPositionSettings":
        if (self.input is None) == (self.counter_line is None):
            raise ValueError("give either input (analogue sensor) or counter_line (encoder)")
        return self


def labjack_position(where: LinkFile, rig: RigFile) -> "AnaloguePosition | QuadraturePosition":
    """The position of a rig file."""
    del rig
    settings = settings_of(where, LabJackPositionSettings)
    return AnaloguePosition(where, settings) if settings.input else QuadraturePosition(where, settings)


class AnaloguePosition:
    """y = scale · V + offset; NaN outside minimum … maximum."""

    absolute = True  # its zero survives a restart

    def __init__(self, where: LinkFile, settings: LabJackPositionSettings) -> None:
        assert settings.input is not None  # noqa: S101 - see labjack_position
        assert settings.unit is not None  # noqa: S101 - the model requires it
        self._settings, self._input, self.unit = settings, settings.input, settings.unit
        self._box = LabJack(where)
        with self._box.let_go_on_failure():
            self._box.configure([self._input])
        self.identity = f"{self._box.identity}, AIN{self._input.channel}"

    def position(self) -> float:
        """The position now."""
        (found,) = self._box.values(self._input)
        return self._settings.within(found)

    def close(self) -> None:
        """Leave the connection."""
        self._box.close()


class QuadraturePosition:
    """Four counts per line of an encoder. The counter has 32 bits; the position is continued when it wraps."""

    unit = "count"

    def __init__(self, where: LinkFile, settings: LabJackPositionSettings) -> None:
        assert settings.counter_line is not None  # noqa: S101 - see labjack_position
        self._line = settings.counter_line
        self._box = LabJack(where)
        with self._box.let_go_on_failure():
            self._enable()
            self._raw = self._box.whole(self._counter)
        self._position = 0
        self.identity = f"{self._box.identity}, DIO{self._line} and DIO{self._line + 1}"

    def position(self) -> float:
        """Counts since opening: the shorter change since the last reading is added. NaN after a restart of the box."""
        if not self._counts():
            return NAN  # a restart of the box lost the position
        raw = self._box.whole(self._counter)
        change = (raw - self._raw) % WRAP
        self._position += change - WRAP if change >= WRAP // 2 else change
        self._raw = raw
        return float(self._position)

    def close(self) -> None:
        """Leave the connection; the counter continues."""
        self._box.close()

    @property
    def _counter(self) -> int:
        return reg.DIO_EF_READ_A + 2 * self._line

    def _lines(self) -> tuple[int, int]:
        return 2 * self._line, 2 * self._line + 2

    def _counts(self) -> bool:
        return self._box.whole(reg.DIO_EF_ENABLE + 2 * self._line) == 1

    def _enable(self) -> None:
        """Switch the feature on, on both lines (LabJack: disable, index, enable)."""
        pairs = reg.PAIRS[self._box.product]
        if self._line not in pairs:
            raise ConfigError(
                f"counter_line = {self._line}: the quadrature inputs of a LabJack {reg.PRODUCTS[self._box.product]} "
                f"start at {', '.join(map(str, pairs))}."
            )
        for base, value in (
            (reg.DIO_EF_ENABLE, 0),
            (reg.DIO_EF_INDEX, reg.QUADRATURE),
            (reg.DIO_EF_ENABLE, 1),
        ):
            for line in self._lines():
                self._box.write_whole(base + line, value)
