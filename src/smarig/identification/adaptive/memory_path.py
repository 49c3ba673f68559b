"""The result and the cost of a planned hold: the memory after a move, and its settling time.

A memory is the path of its extrema (u₋, M₁, m₁, M₂, …, u): maxima fall, minima rise. Thousands of plans are tried,
so the path is a plain tuple here.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from smarig.core import Array, Settled
from smarig.identification.positive.observations import corners_of
from smarig.identification.positive.triangle import Triangle
from smarig.preisach import State
from smarig.protocols import Setup

MemoryPath = tuple[float, ...]
Corners = tuple[NDArray[np.int64], Array, Array, Array]


def path_after(path: MemoryPath, u: float) -> MemoryPath:
    """The path after a monotone move to u; loops that the move closes are wiped out (§3.3.1).

    >>> path_after((0.0, 100.0, 20.0, 80.0), 50.0)
    (0.0, 100.0, 20.0, 80.0, 50.0)
    >>> path_after((0.0, 100.0, 20.0, 80.0, 50.0), 90.0)
    (0.0, 100.0, 20.0, 90.0)
    >>> path_after((0.0, 100.0, 20.0), 0.0)
    (0.0,)
    """
    if u == path[-1]:
        return path
    rising, kept = u > path[-1], list(path)
    if rising == (len(kept) % 2 == 0):  # maxima are at odd indices: the move continues in its direction
        kept.pop()
    while len(kept) > 1 and (u >= kept[-2] if rising else u <= kept[-2]):
        del kept[-2:]
    return (*kept, u)


def paths_along(path: MemoryPath, inputs: tuple[float, ...]) -> list[MemoryPath]:
    """The path after each of several moves."""
    found = []
    for u in inputs:
        path = path_after(path, u)
        found.append(path)
    return found


def corners(paths: list[MemoryPath]) -> Corners:
    """Index of the path (t,), sign (t,), α (t,) and β (t,) of all corners on the FOD surface whose sums are the
    outputs.
    """
    terms = []
    for k, path in enumerate(paths):
        state = State(path, (0.0,) * len(path), path[-1], 0.0)
        terms += [(k, *corner) for corner in corners_of(state, path[0])[0]]
    table = np.array(terms, dtype=float).reshape(len(terms), 4)
    return table[:, 0].astype(np.int64), table[:, 1], table[:, 2], table[:, 3]


def duration_s(setup: Setup, settle: Settled, start_K: float, end_K: float) -> float:
    """The duration of a hold: τ ln(|ΔT| / approach) until the temperature is reached, then the window."""
    far = abs(end_K - start_K)
    approach_s = setup.tau_s * math.log(far / settle.approach_K) if far > settle.approach_K else 0.0
    return approach_s + settle.window_s


def rows(triangle: Triangle, paths: list[MemoryPath]) -> csr_matrix:
    """The output after each path as a row over the triangle's unknowns, (k, n)."""
    path, sign, alpha, beta = corners(paths)
    gather = csr_matrix((sign, (path, np.arange(path.size))), shape=(len(paths), path.size))
    return csr_matrix(gather @ triangle.values(alpha, beta))
