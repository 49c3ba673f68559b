"""Settings that analogue outputs and positions of all data acquisition devices share, checked in one place."""

from typing import Any, Literal, Self

from pydantic import Field, model_validator

from smarig.config import RigFile
from smarig.core import NAN, Number, TomlTable
from smarig.plant import Actuator, largest_voltage_V


class StageSettings(TomlTable):
    """What an analogue output drives: a current amplifier, i = amperes_per_volt · V, or a voltage stage, V_wire =
    volts_per_volt · V. Exactly one of both is given.
    """

    amperes_per_volt: Number | None = Field(default=None, gt=0, le=1e3)  # of an external current amplifier
    volts_per_volt: Number | None = Field(default=None, gt=0, le=1e3)  # of an external voltage stage

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if (self.amperes_per_volt is None) == (self.volts_per_volt is None):
            raise ValueError(
                "give either amperes_per_volt (current amplifier) or volts_per_volt (voltage stage)"
            )
        if self.volts_per_volt is not None and getattr(self, "voltage_input", None) is None:
            raise ValueError(
                "a voltage stage needs voltage_input: its current loop works with the measured resistance"
            )
        return self

    @property
    def drives_current(self) -> bool:
        """Whether the output commands a current amplifier."""
        return self.amperes_per_volt is not None

    @property
    def scale(self) -> float:
        """Ampere, or volt across the wire, per volt of the output."""
        found = self.amperes_per_volt if self.drives_current else self.volts_per_volt
        assert found is not None  # noqa: S101 - the model requires one of them
        return found

    def largest_V_of(self, rig: RigFile) -> float:
        """The largest output that the limits of a rig need, in V."""
        limits = rig.limits
        if self.drives_current:
            return max(limits.current_max_A, -limits.current_min_A) / self.scale
        return largest_voltage_V(limits, Actuator.named(rig.actuator)) / self.scale


class RangeSettings(TomlTable):
    """The unit and the range of an analogue position; outside of it there is no position."""

    unit: Literal["mm", "deg"] | None = None  # unit of the analogue position
    minimum: Number = Field(default=-1e9, ge=-1e9, le=1e9)  # end of the sensor's range: no position below
    maximum: Number = Field(default=1e9, ge=-1e9, le=1e9)  # end of the sensor's range: no position above

    @model_validator(mode="after")
    def _has_unit_and_order(self) -> Self:
        given: Any = getattr(self, "input", None)
        if given is not None and self.unit is None:
            raise ValueError("input needs unit, mm or deg")
        if not self.minimum < self.maximum:
            raise ValueError("minimum must be less than maximum")
        return self

    def within(self, position: float) -> float:
        """The position, NaN outside the range."""
        return position if self.minimum <= position <= self.maximum else NAN
