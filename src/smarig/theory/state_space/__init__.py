"""The Preisach operator as a dynamical system (thesis Ch. 6): its state is a curve, its time is arbitrary.

    inputs 𝒰 ──F──▶ reduced memory sequences 𝒮 ──G──▶ boundaries ℬ ──r──▶ outputs
             ◀──Fʳ─                            ◀─G⁻¹─

``input_signal`` is u, ``memory_sequence`` s(u, τ), ``boundary`` B; ``maps`` joins them, ``transition`` is
φ (6.8), ``read_out`` r, ``rotation`` and ``metric`` make ℬ a metric space, ``reachability`` is Theorem 6.4
as a construction, ``operator_state`` speaks to ``smarig.preisach.operator``. ``Preisach`` is what runs in a
loop; this package is what can be proved, drawn and measured about it.
"""

from smarig.theory.state_space.boundary import Boundary, anhysteretic, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import F, F_right, G, G_inverse, H, H_left
from smarig.theory.state_space.memory_sequence import MemorySequence
from smarig.theory.state_space.operator_state import boundary_of, distance, rotated_distance, state_of
from smarig.theory.state_space.reachability import reach, staircase
from smarig.theory.state_space.read_out import read_out
from smarig.theory.state_space.rotation import RotatedBoundary, rotated
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
