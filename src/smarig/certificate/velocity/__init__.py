"""Velocity feedback (thesis §8.2): δ and γ of controllers, the loop on the operator, and the result of Thm 8.2."""

from smarig.certificate.velocity.passivity_indices import inequalities, violating_signal
from smarig.certificate.velocity.sampled_loop import VelocityLoop, velocity_loop
from smarig.certificate.velocity.stability import Stability, k_e, stability
from smarig.control import VelocityController

__all__ = [
    "Stability",
    "VelocityController",
    "VelocityLoop",
    "inequalities",
    "k_e",
    "stability",
    "velocity_loop",
    "violating_signal",
]
