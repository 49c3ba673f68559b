"""Proportional and integral action on the position error with any gain, shared by the PI controllers.

    s = ∫ k e dt/T_i + k e,        e = wanted − position, k in kelvin per unit

Conditional integration: the integral does not grow while the source s is at a limit and the error would drive it
further.
"""

from collections.abc import Callable

from smarig.control.tracking.controller_model import Controller, ControllerModel, ReferenceFunction
from smarig.control.tracking.heating_lag import clipped


def pi_feedback(
    controller_model: ControllerModel,
    reference: ReferenceFunction,
    gain: Callable[[float, float], float],
    *,
    integral_s: float,
    lead_s: float,
) -> Controller:
    """``gain(error, position)`` in K per unit; the error refers to the reference ``lead_s`` ahead."""
    setup = controller_model.setup
    integral_K = 0.0
    sample = yield setup.current_for(clipped(setup, 0.0))
    while True:
        error = reference(sample.t_s + lead_s) - sample.position
        proportional_K = gain(error, sample.position) * error
        limited_K = clipped(setup, integral_K + proportional_K)
        if (integral_K + proportional_K - limited_K) * error <= 0:
            integral_K += proportional_K * setup.period_s / integral_s
        sample = yield setup.current_for(limited_K)
