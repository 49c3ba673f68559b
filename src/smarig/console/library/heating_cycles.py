"""The heating cycles of a run, counted as the history of its wire counts them (``record.Wear``)."""

import numpy as np

from smarig.config import ActuatorFile, LimitsFile
from smarig.core import Array
from smarig.plant import Actuator
from smarig.protocols import Setup
from smarig.record import COLD, HOT, AnyRun


def input_range_K(run: AnyRun) -> float | None:
    """The largest input that the limits of the recorded rig allow; None if the run does not hold its rig."""
    try:
        actuator = Actuator(ActuatorFile.model_validate(run.info.actuator_values))
        limits = LimitsFile.model_validate(run.info.rig_values["limits"])
        setup = Setup(actuator, limits, run.info.period_s or 0.1)
        return max(setup.upper_K, -setup.lower_K)
    except Exception:  # values of any origin: pydantic, the actuator and the setup each refuse them their way
        return None


def heating_cycles(u: Array, range_K: float) -> int:
    """How often the input (n,) rose above half of the range after it was below a quarter.

    >>> heating_cycles(np.array([0.0, 90.0, 40.0, 90.0, 10.0, 90.0]), 100.0)
    2
    """
    size = np.abs(u[np.isfinite(u)])
    hot, cold = size > HOT * range_K, size < COLD * range_K
    marks = np.where(hot, 1, np.where(cold, -1, 0))
    marks = marks[marks != 0]
    return int(np.count_nonzero(np.diff(marks) == 2))
