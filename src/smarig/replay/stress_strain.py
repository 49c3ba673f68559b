"""Stress and strain of a single wire along a run whose load changes, at its readings."""

from dataclasses import dataclass

from pydantic import ValidationError

from smarig.config import ActuatorFile
from smarig.core import Array, DataError
from smarig.record import Run
from smarig.replay.rig_record import stress_at_points


@dataclass(frozen=True, eq=False)
class StressStrainCurve:
    """Stress in MPa and strain (k,) at the readings of a run; strain counts from the first reading."""

    stress_MPa: Array
    strain: Array


def stress_strain(run: Run) -> StressStrainCurve:
    """The stress–strain curve of a run: means over the window of each reading.

        σ = F/A,      ε = −y/L        y: contraction, L: active length

    Raises DataError unless the run states a load that changes, the wire's length, and readings in mm.
    """
    stress_MPa = stress_at_points(run)
    if stress_MPa is None or not run.settled or run.unit != "mm":
        raise DataError(
            f"{run.path} has no stress–strain curve: it needs a load that changes and readings in mm."
        )
    try:
        length_mm = ActuatorFile.model_validate(run.info.actuator_values).wire.active_length.value
    except ValidationError:
        raise DataError(f"{run.path} does not state the length of its wire.") from None
    position = run.points()[1]
    return StressStrainCurve(stress_MPa, (position[0] - position) / length_mm)
