"""Proportional and leaky integral action."""

from smarig.control.velocity.velocity_controller import FirstOrderController, positive


def leaky_pi(
    gain: float = 100.0, integral_per_s: float = 30.0, leak_per_s: float = 0.1
) -> FirstOrderController:
    """H(s) = k_p + k_i/(s + a): an integral that decays at the rate a, because without a leak the gain is infinite.

    δ = k_p, γ = k_p + k_i/a.

        gain (K·s/unit): k_p, gain of the velocity error
        integral_per_s (K/unit): k_i, gain of its integral
        leak_per_s (1/s): a, decay rate of the integral

    >>> pi = leaky_pi(2.0, integral_per_s=0.6, leak_per_s=0.1)
    >>> pi.delta, round(pi.gamma, 12)
    (2.0, 8.0)
    """
    k, i, a = (
        positive(n, v)
        for n, v in (("gain", gain), ("integral_per_s", integral_per_s), ("leak_per_s", leak_per_s))
    )
    return FirstOrderController(k + i / a, k, a)
