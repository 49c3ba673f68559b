"""Proportional and leaking integral."""

from smarig.control.velocity.velocity_controller import FirstOrderController, positive


def leaky_pi(
    gain: float = 100.0, integral_per_s: float = 30.0, leak_per_s: float = 0.1
) -> FirstOrderController:
    """H(s) = k_p + k_i/(s + a): an integral that forgets at the rate a, for without a leak there is no finite gain.

    δ = k_p, γ = k_p + k_i/a.

        gain (K·s/unit): k_p, of the velocity error itself
        integral_per_s (K/unit): k_i, of its integral
        leak_per_s (1/s): a, the rate at which the integral forgets

    >>> pi = leaky_pi(2.0, integral_per_s=0.6, leak_per_s=0.1)
    >>> pi.delta, round(pi.gamma, 12)
    (2.0, 8.0)
    """
    k, i, a = (
        positive(n, v)
        for n, v in (("gain", gain), ("integral_per_s", integral_per_s), ("leak_per_s", leak_per_s))
    )
    return FirstOrderController(k + i / a, k, a)
