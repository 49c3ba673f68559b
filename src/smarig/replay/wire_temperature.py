"""The temperature of a single wire in runs of a rig: of a thermometer, of the measured power, or of the heating model.

The heating model (5.1) has one resistance and one h, so its kelvins are not those of the wire: a slope dσ/dT by them is
another number. A thermometer, or voltage and current, give the temperature of the wire itself.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from pydantic import ValidationError

from smarig.config import ActuatorFile
from smarig.core import Array, DataError, UsageError
from smarig.plant import Actuator, PowerTemperature
from smarig.record import Run, Step

TemperatureSource = Literal["thermometer", "power", "heating model"]
SOURCES: tuple[TemperatureSource, ...] = ("thermometer", "power", "heating model")


def temperature_source(runs: Sequence[Run]) -> TemperatureSource:
    """The best source that all runs of a rig have."""
    if all(run.has("temperature_degC") and run.has("ambient_degC") for run in runs):
        return "thermometer"
    return "power" if all(map(_has_power, runs)) else "heating model"


def _has_power(run: Run) -> bool:
    """Whether voltage and current tell the heat of a single wire: a twin may be heated by its mean resistance."""
    measured = run.has("voltage_V") and run.has("current_A") and run.has("ambient_degC")
    actuator = _actuator(run) if measured else None
    return actuator is not None and not _heated_by_mean_resistance(run, actuator)


def is_heated_by_model(run: Run, actuator: Actuator) -> bool:
    """Whether a run is of a twin whose wire obeys the heating model (5.1), so that its temperatures are exact. An
    injected effect may change the heating.
    """
    return _heated_by_mean_resistance(run, actuator) and not run.info.effects


def _heated_by_mean_resistance(run: Run, actuator: Actuator) -> bool:
    file = actuator.file
    return run.twin and file.thermomechanical is None and file.heating.twin_heat == "mean_resistance"


def with_wire_temperature(run: Run, source: str) -> Run:
    """The run with the temperature above ambient of this source as its input, at samples and settled points.

    Raises DataError if the run does not have it.
    """
    if source == "heating model":
        return run
    ambient = run["ambient_degC"]
    if source == "thermometer" and run.has("temperature_degC") and run.has("ambient_degC"):
        rise = run["temperature_degC"] - ambient
        settled = [_window_mean(run, s, rise) for s in run.steps]
    else:
        actuator = _actuator(run)
        if source not in SOURCES or actuator is None or not (run.has("voltage_V") and run.has("current_A")):
            raise DataError(
                f"The model has the temperature of the wire as its input (by {source}), but {run.name} has not "
                "measured it. Give runs with the same readings as those of the model."
            )
        power = run["voltage_V"] * run["current_A"]
        wire = PowerTemperature(actuator)
        rise = _along(run, wire, power)
        settled = [
            wire.steady_K(_window_mean(run, s, power), _window_mean(run, s, ambient)) for s in run.steps
        ]
    steps = tuple(
        s if s.target is None or u != u else replace(s, target=float(u)) for s, u in zip(run.steps, settled)
    )
    return replace(run, columns={**run.columns, "input": rise}, steps=steps)


def _along(run: Run, wire: PowerTemperature, power_W: Array) -> Array:
    """Temperatures (n,) at the samples; a missing reading is that before it."""
    dt_s = np.diff(run["t_s"], prepend=run["t_s"][0] - float(run.info.period_s or 0.1))
    known = np.isfinite(power_W) & np.isfinite(run["ambient_degC"])
    last = np.maximum.accumulate(np.where(known, np.arange(power_W.size), 0))
    start_K = run["input"][0] if np.isfinite(run["input"][:1]).all() and run["input"].size else 0.0
    power, ambient = np.nan_to_num(power_W[last]), np.nan_to_num(run["ambient_degC"][last])
    return wire.along(power, np.nan_to_num(dt_s), ambient, float(start_K))


def _window_mean(run: Run, step: Step, values: Array) -> float:
    """Mean over the settle window of a step; NaN without samples."""
    window = values[run.window(step)]
    return float(np.nanmean(window)) if np.isfinite(window).any() else float("nan")


def _actuator(run: Run) -> Actuator | None:
    """The single-wire actuator that the run records; None if there is none."""
    try:
        found = Actuator(ActuatorFile.model_validate(run.info.actuator_values))
    except (ValidationError, UsageError):
        return None
    return None if found.two_wire else found
