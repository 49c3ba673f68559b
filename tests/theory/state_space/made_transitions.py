"""A deep state, an input that wipes it out step by step, and a wrong transition that forgets."""

from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import G, H_left
from smarig.theory.state_space.memory_sequence import MemorySequence
from theory.state_space.made import BOUND

SOFT = thesis_surface("two_e")  # inputs within ±185


DEEP = G(MemorySequence((9.0, -8.0, 7.0, -6.0, 5.0), BOUND))
ONWARD = InputSignal((0, 1, 2, 3, 4), (5, -2, 4, -7, 8))


def forgetful(t1, t0, boundary, u):
    """Goes on from the present input, but with the memory of B*."""
    piece = u.between(t0, t1)
    return H_left(InputSignal((t0 - 1, *piece.times), (0.0, *piece.values)), t1, boundary.bound)
