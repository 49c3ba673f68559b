"""The readings of a run as a record of temperature and output in measured order, and how its temperatures read in °C.

Steps that settled give one reading each; a run without such steps gives all of its samples.
"""

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, Quality, UsageError
from smarig.measurement import dropouts
from smarig.plant import Actuator
from smarig.record import Run, counted
from smarig.replay import (
    is_heated_by_model,
    recorded_actuator,
    temperature_source,
    with_wire_temperature,
)
from smarig.transformation.heat_loss_error import HeatLossError, heat_loss_error

_ZERO_DEGC_K = 273.15
_OF_TWO_WIRES = "T1 - T2"
_LARGEST = 1e100
_FROM = {
    "power": "voltage and current, by the heat loss of the actuator file",
    "heating model": "the heating model along the current",
}
_MOVED_K = 1.0  # a larger range of the ambient temperature is stated


@dataclass(frozen=True, eq=False)
class TemperatureRecord:
    """Temperature ``u`` and output ``y`` (k,) in measured order, both known in every row.

    ``to_degC_K`` is added to u to give °C, None if the ambient temperature is not known; ``ambient_degC`` is its mean.
    ``t_s`` (k,) are the times of the readings of a run that did not settle, None if they are not known. ``lag_s`` is
    the time constant of the heating from which temperatures come, None for measured ones and settled points, and
    ``heat_loss`` its error. ``clipped_at``: the outputs at which the range of their sensor ends. ``notes`` state which
    readings were left out, and where temperatures were not measured.
    """

    u: Array
    y: Array
    unit: str
    input_unit: str
    to_degC_K: float | None
    ambient_degC: float | None
    settled: bool
    t_s: Array | None = None
    lag_s: float | None = None
    heat_loss: HeatLossError | None = None
    clipped_at: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def above_ambient(self) -> bool:
        """Whether u is counted from the ambient temperature."""
        return self.input_unit == "K" and self.to_degC_K != -_ZERO_DEGC_K


def temperature_record(run: Run) -> TemperatureRecord:
    """The record of a run. Raises UsageError if its hysteresis input is no temperature, or if a channel is missing."""
    _check_input(run)
    route = _route(run)
    run = route.run
    notes: list[str] = []
    whole, run = len(run), counted(run)
    if len(run) < whole:
        notes.append(
            f"{whole - len(run)} of {whole} rows were left out: they belong to steps that were repeated, or they "
            "contradict other readings."
        )
    u, y = (run.points()) if run.settled else (run["input"], run["position"])
    known = np.isfinite(u) & np.isfinite(y)
    if not known.any():
        raise UsageError(
            f"{run.name} has no row in which temperature and output are both numbers. Check its mapping file."
        )
    if absent := int(np.count_nonzero(~known)):
        notes.append(f"{absent} of {known.size} rows without temperature or output were left out.")
    t_s = None if run.settled or not np.isfinite(run["t_s"]).all() else run["t_s"][known]
    u, y = u[known], y[known]
    if (lost := dropouts(u)).any():
        notes.append(
            f"{int(lost.sum())} rows were left out whose temperature reads exactly 0, far from its neighbours."
        )
        u, y = u[~lost], y[~lost]
        t_s = None if t_s is None else t_s[~lost]
    _check_size(run, u, y)
    ambient = run["ambient_degC"][np.isfinite(run["ambient_degC"])]
    if ambient.size and np.ptp(ambient) > _MOVED_K:
        notes.append(
            f"The ambient temperature moved from {ambient.min():.1f} to {ambient.max():.1f} °C; its mean was used."
        )
    notes += route.notes
    mean = float(ambient.mean()) if ambient.size else None
    return TemperatureRecord(
        u=u,
        y=y,
        unit=run.unit,
        input_unit=run.input_unit,
        to_degC_K=_to_degC_K(run, mean),
        ambient_degC=mean,
        settled=bool(run.settled),
        t_s=t_s,
        lag_s=None if t_s is None or route.heated is None else route.heated.tau_s,
        heat_loss=route.heat_loss,
        clipped_at=_clipped_at(run),
        notes=tuple(notes),
    )


@dataclass(frozen=True)
class _Route:
    """The run with the temperature of its wire as input; the wire whose heating it was computed by, and its error."""

    run: Run
    heated: Actuator | None = None
    heat_loss: HeatLossError | None = None
    notes: tuple[str, ...] = ()


def _route(run: Run) -> _Route:
    """By the best that the run has measured: a thermometer, voltage and current, or the current alone."""
    if "heating model" not in (run.info.input.from_ or ""):
        return _Route(run)
    source, actuator = temperature_source([run]), _actuator(run)
    run = with_wire_temperature(run, source)
    if source == "thermometer":
        return _Route(run)
    note = f"No thermometer measured these temperatures: they come from {_FROM[source]}."
    if actuator is None:
        return _Route(run, notes=(f"{note} Its error is not in the intervals.",))
    if is_heated_by_model(run, actuator):
        return _Route(run, actuator, notes=(f"{note} The wire of this twin is heated by that model.",))
    error = heat_loss_error(actuator, measured_power=source == "power")
    return _Route(run, actuator, error, (f"{note} {error.sentence}",))


def _actuator(run: Run) -> Actuator | None:
    """The wire; a run that settled needs no lag of it, so its file may be missing."""
    with suppress(*(UsageError,) if run.settled else ()):
        return recorded_actuator(run)
    return None


def _check_input(run: Run) -> None:
    quantity = run.info.input.quantity or "not named"
    if run.input_unit not in ("K", "degC"):
        unit = f" ({run.input_unit})" if run.input_unit else ""
        raise UsageError(
            f"The hysteresis input of {run.name} is {quantity}{unit}, and transformation temperatures need a "
            "temperature. Import the data with a mapping file whose [input] is a temperature, or with --rig to compute "
            "it from the current."
        )
    if _OF_TWO_WIRES in quantity:
        raise UsageError(
            f"The hysteresis input of {run.name} is a difference of the temperatures of two wires, which has no "
            "transformation temperatures. Use a run of one wire."
        )


def _clipped_at(run: Run) -> tuple[float, ...]:
    """The outputs that the import found to be ends of the range of their sensor."""
    if not any(f.kind == "clipped output" for f in run.info.import_findings):
        return ()
    y, marks = run["position"], np.nan_to_num(run["quality"]).astype(int)
    saturated = y[(marks & Quality.SATURATED) > 0]
    return tuple(v for v in (float(np.nanmin(y)), float(np.nanmax(y))) if (saturated == v).sum() > 1)


def _check_size(run: Run, u: Array, y: Array) -> None:
    """Raise UsageError for numbers whose squares no computer holds."""
    largest, travel = max(float(np.abs(u).max()), float(np.abs(y).max())), float(np.ptp(y)) if y.size else 0.0
    if largest > _LARGEST or 0.0 < travel < 1.0 / _LARGEST:
        raise UsageError(
            f"{run.name} has numbers of the size {largest if largest > _LARGEST else travel:.3g}, which no wire gives. "
            "Check units and missing values in its mapping file."
        )


def _to_degC_K(run: Run, ambient_degC: float | None) -> float | None:
    if run.input_unit == "degC":
        return 0.0
    if "above ambient" in (run.info.input.quantity or ""):
        return ambient_degC
    return -_ZERO_DEGC_K
