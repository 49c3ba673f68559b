"""Inputs, memory sequences and boundaries of every kind, and relays that count area.

No code is shared with ``smarig.theory.state_space`` beyond its constructors. Times are multiples of a half,
so that shifting them is exact. Values mix whole numbers (ties, edges, ±û) with arbitrary ones.
"""

import math
from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from preisach.relay_reference import Relays, cells, lower_half
from smarig.theory.state_space.boundary import Boundary, diagonal
from smarig.theory.state_space.input_signal import InputSignal
from smarig.theory.state_space.maps import G
from smarig.theory.state_space.memory_sequence import MemorySequence

BOUND = 10.0
LEVELS = np.arange(-10.0, 11.0)

whole = st.integers(-10, 10).map(float)
values = st.one_of(whole, st.floats(-BOUND, BOUND, allow_nan=False, width=32))


@st.composite
def sequences(draw, most: int = 7) -> MemorySequence:
    """Elements of 𝒮 with N(s) ≤ most: each element somewhere strictly between its two predecessors."""
    s = [draw(values)]
    other = -s[0]
    for share in draw(st.lists(st.sampled_from([0.03, 0.2, 0.5, 0.75, 0.98]), max_size=most - 1)):
        new = s[-1] + share * (other - s[-1])
        if not min(s[-1], other) < new < max(s[-1], other) or (len(s) == 1 and abs(new) >= abs(s[0])):
            break
        other = s[-1]
        s.append(new)
    return MemorySequence(tuple(s), BOUND)


@st.composite
def inputs(draw, of=values, least: int = 0) -> InputSignal:
    """Inputs of 𝒰 that begin at rest at t = 0."""
    moves = draw(st.lists(of, min_size=least, max_size=14))
    gaps = draw(st.lists(st.sampled_from([0.5, 1.0, 1.5]), min_size=len(moves), max_size=len(moves)))
    return InputSignal((0.0, *np.cumsum(gaps).tolist()), (0.0, *moves))


@st.composite
def curves(draw, least: int = 0) -> Boundary:
    """Any polyline of ℬ: β rises to u and α falls to u. Whole numbers make level and upright edges."""
    u = draw(values)
    left = st.one_of(st.integers(-10, math.floor(u)).map(float), st.floats(-BOUND, u))
    above = st.one_of(st.integers(math.ceil(u), 10).map(float), st.floats(u, BOUND))
    points = draw(st.lists(st.tuples(left, above), min_size=least, max_size=8))
    middle = zip(sorted(b for b, _ in points), sorted((a for _, a in points), reverse=True))
    return Boundary(((-BOUND, BOUND), *middle, (u, u)), BOUND)


reachable = sequences().map(G)
boundaries = st.one_of(reachable, curves(), values.map(lambda centre: diagonal(BOUND, centre)))


def drawn_coarsely(boundary: Boundary) -> bool:
    """Whether every edge is either level, upright or longer than rounding in both directions."""
    return all(d == 0 or abs(d) > 1e-6 for d in np.diff(boundary.points, axis=0).ravel())


def monotone_pieces(u: InputSignal) -> int:
    """How many rises and falls an input has."""
    signs = [np.sign(b - a) for a, b in pairwise(u.values) if a != b]
    return len(signs) and 1 + sum(a != b for a, b in pairwise(signs))


def area_relays() -> Relays:
    """Relays of unit density on the whole-number cells of the plane, in B*: ``nu`` is the area of each."""
    return cells(LEVELS, lambda a, b: -0.5 * (a - b) ** 2, 0.0, lower_half(lambda a, b: 1.0 + 0 * a * b))


def drawn_by_relays(moves) -> np.ndarray:
    """Which relays are up after B* and the moves, one relay at a time."""
    relays = area_relays()
    relays.drive(moves, 0.0)
    return relays.on


def points_of_relays() -> tuple[np.ndarray, np.ndarray]:
    """A point (α, β) inside each relay's cell, or inside its half of a cell cut by α = −β."""
    relays = area_relays()
    shift = np.where(relays.alpha + relays.beta == 0, np.where(relays.on, -0.2, 0.2), 0.0)
    return relays.alpha - 0.4 + shift, relays.beta + 0.4 + shift
