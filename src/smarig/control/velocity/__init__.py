"""Velocity feedback (thesis §8.2): controllers from velocity error to input, the loop, and what Thm 8.2 says of it."""

from smarig.control.velocity.controller import VelocityController
from smarig.control.velocity.loop import Loop, velocity_loop
from smarig.control.velocity.on_a_plant import Outcome, velocity_feedback
from smarig.control.velocity.signals import inequalities, violating
from smarig.control.velocity.stability import Stability, k_e, stability

__all__ = [
    "Loop",
    "Outcome",
    "Stability",
    "VelocityController",
    "inequalities",
    "k_e",
    "stability",
    "velocity_feedback",
    "velocity_loop",
    "violating",
]
