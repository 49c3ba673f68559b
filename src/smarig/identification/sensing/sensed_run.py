"""A run prepared for self-sensing: voltage, current and position at every tick, on the scale of a model."""

from dataclasses import dataclass

import numpy as np

from smarig.core import Array, DataError
from smarig.identification.calibration.holds import valid_rows
from smarig.identification.verify import verify
from smarig.plant import Actuator
from smarig.preisach import Initial
from smarig.record import Run
from smarig.replay import Model, actuator_of, check_output, recorded_start


@dataclass(frozen=True, eq=False)
class SensedRun:
    """Columns (n,) of a run in model units; ``voltage_V`` is NaN where a reading is missing or marked as bad."""

    name: str
    voltage_V: Array
    current_A: Array
    position: Array
    period_s: float
    initial: Initial

    @property
    def largest_A(self) -> float:
        """The largest current."""
        return float(np.abs(self.current_A).max())


def sensed_run(model: Model, run: Run) -> SensedRun:
    """Prepare a run. Raises DataError if it has no voltage, current or position, or is of another kind of rig."""
    check_output(model, run)
    for name, text in (("voltage_V", "voltage"), ("current_A", "current"), ("position", "position")):
        if not run.has(name):
            raise DataError(
                f"{run.name} has no measured {text}. Self-sensing needs voltage, current and position."
            )
    if not run.info.period_s:
        raise DataError(
            f"{run.name} does not say the length of a tick, so it cannot be used for self-sensing."
        )
    current = run["current_A"]
    if not np.isfinite(current).all():
        current = np.nan_to_num(current)
    checked = verify(model, run).runs[0]
    start = recorded_start(run) or ("anhysteretic" if sensing_actuator(model).two_wire else "negative")
    return SensedRun(
        run.name,
        np.where(valid_rows(run), run["voltage_V"], np.nan),
        current,
        run["position"] - checked.offset,
        run.info.period_s,
        start,
    )


def sensing_actuator(model: Model) -> Actuator:
    """The wire of a model. Raises UsageError for a model that is not of the hysteresis of a heated wire alone."""
    model.check_classical("Self-sensing")
    if model.input.unit != "K" or model.measurement:
        raise DataError(f"Self-sensing needs a model of a wire heated by current; '{model.name}' is none.")
    return actuator_of(model)
