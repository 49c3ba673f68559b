"""The Preisach operator as a dynamical system (thesis Ch. 6): the state is a curve, and the time scale is arbitrary.

    inputs 𝒰 ──F──▶ reduced memory sequences 𝒮 ──G──▶ boundaries ℬ ──r──▶ outputs
             ◀──Fʳ─                            ◀─G⁻¹─

``input_signal`` is u, ``memory_sequence`` s(u, τ) and ``boundary`` B. ``maps`` connects them, ``transition`` is
φ (6.8), and ``read_out`` is r. ``rotation`` and ``distance`` make ℬ a metric space, ``reachability`` constructs Theorem
6.4, and ``operator_state`` converts to states of ``smarig.preisach.operator``. Use ``Preisach`` for
computations in a loop; this package contains what can be proved, drawn and measured about it.
"""

from smarig.theory.state_space.boundary import Boundary, RotatedBoundary, anhysteretic, diagonal, rotated
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import F, F_right, G, G_inverse, H, H_left
from smarig.theory.state_space.memory_sequence import MemorySequence
from smarig.theory.state_space.operator_state import boundary_of, distance, rotated_distance, state_of
from smarig.theory.state_space.reachability import reach, staircase
from smarig.theory.state_space.read_out import read_out
from smarig.theory.state_space.transition import sweep, transition

__all__ = [
    "Boundary",
    "F",
    "F_right",
    "G",
    "G_inverse",
    "H",
    "H_left",
    "InputSignal",
    "MemorySequence",
    "RotatedBoundary",
    "anhysteretic",
    "boundary_of",
    "diagonal",
    "distance",
    "reach",
    "read_out",
    "rotated",
    "rotated_distance",
    "staircase",
    "state_of",
    "sweep",
    "transition",
]
