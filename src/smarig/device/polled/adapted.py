"""Makes of a driver's instrument what a bench requires; queried instruments are sampled by the host's clock."""

from collections.abc import Sequence
from typing import Any

from smarig.config import RigFile
from smarig.core import LONGEST_LINE, ConfigError, shown
from smarig.device.polled.current_loop import CurrentLoop
from smarig.device.polled.polled_position import PolledPosition
from smarig.device.polled.polled_source import PolledSource
from smarig.device.roles.polled import (
    CurrentOutput,
    ForceInput,
    PositionInput,
    TemperatureInput,
    VoltageOutput,
)
from smarig.device.roles.ticked import CurrentSource, PositionSensor, missing_members


def as_current_source(instrument: Any, driver: str, rig: RigFile) -> CurrentSource:
    """A current source, a queried current output, or a voltage output with a current loop on the host."""
    kind = _first_fit(instrument, driver, (CurrentSource, CurrentOutput, VoltageOutput), "a current source")
    if kind is CurrentSource:
        return instrument
    return PolledSource(instrument if kind is CurrentOutput else CurrentLoop(instrument, rig))


def as_position_sensor(instrument: Any, driver: str, rig: RigFile) -> PositionSensor:
    """A position sensor with ticks of its own, or a queried position."""
    kind = _first_fit(instrument, driver, (PositionSensor, PositionInput), "a position sensor")
    return instrument if kind is PositionSensor else PolledPosition(instrument, rig)


def as_temperature_input(instrument: Any, driver: str) -> TemperatureInput:
    """A thermometer."""
    _first_fit(instrument, driver, (TemperatureInput,), "a thermometer")
    return instrument


def as_force_input(instrument: Any, driver: str) -> ForceInput:
    """A load cell."""
    _first_fit(instrument, driver, (ForceInput,), "a load cell")
    return instrument


def _first_fit(instrument: Any, driver: str, kinds: Sequence[type], role_text: str) -> type:
    """The first interface that is complete. Raises ConfigError naming what the nearest one lacks."""
    lacking = {kind: missing_members(instrument, kind) for kind in kinds}
    nearest = min(kinds, key=lambda kind: len(lacking[kind]))
    if lacking[nearest]:
        raise ConfigError(
            f"Driver {driver}: the returned object lacks {', '.join(lacking[nearest])}, which {role_text} requires."
        )
    identity = instrument.identity
    if not isinstance(identity, str) or len(identity) > LONGEST_LINE:
        raise ConfigError(
            f"Driver {driver}: identity is {shown(identity)}. Correct the driver: it must be a text of at most "
            f"{LONGEST_LINE} characters that names the instrument."
        )
    return next(kind for kind in kinds if not lacking[kind])
