"""Lead or lag."""

from smarig.control.velocity.velocity_controller import FirstOrderController, positive


def lead_lag(gain: float = 100.0, zero_s: float = 4.0, pole_s: float = 1.0) -> FirstOrderController:
    """H(s) = k (1 + s zero_s)/(1 + s pole_s): a lead for zero_s > pole_s, else a lag.

    H₀ = k and H∞ = k zero_s/pole_s; δ is the smaller, γ the larger.

        gain (K·s/unit): k, for steady velocity errors
        zero_s (s): time constant of the zero
        pole_s (s): time constant of the pole

    >>> lead = lead_lag(2.0, zero_s=4.0, pole_s=1.0)
    >>> lead.delta, lead.gamma
    (2.0, 8.0)
    """
    k, zero, pole = (positive(n, v) for n, v in (("gain", gain), ("zero_s", zero_s), ("pole_s", pole_s)))
    return FirstOrderController(k, k * zero / pole, 1.0 / pole)
