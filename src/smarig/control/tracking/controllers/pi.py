"""Baseline: proportional and integral action on the position error, in kelvin of steady temperature."""

from smarig.control.tracking.controller_model import Controller, ControllerModel, ReferenceFunction
from smarig.control.tracking.pi_feedback import pi_feedback

RANGES = {"gain_share": (0.05, 100.0), "integral_s": (0.1, 200.0)}


def pi(
    controller_model: ControllerModel,
    reference: ReferenceFunction,
    *,
    gain_share: float = 20.0,
    integral_s: float = 1.3,
    lead_s: float = 0.0,
) -> Controller:
    """s = k (e + ∫e dt/T_i): source s in kelvin, e = wanted − position, the same in both directions.

    k is ``gain_share`` times the range of temperatures over that of positions; T_i is ``integral_s``. With ``lead_s``
    the error refers to the reference that much later, which a loop without preview does not have.

        gain_share (1): gain k, as a multiple of the range of temperatures over that of positions
        integral_s (s): integral time T_i
        lead_s (s): preview time of the reference; 0: no preview
    """
    setup, (low, high) = controller_model.setup, controller_model.reach
    gain = gain_share * (setup.upper_K - setup.lower_K) / (high - low)
    return pi_feedback(controller_model, reference, lambda *_: gain, integral_s=integral_s, lead_s=lead_s)
