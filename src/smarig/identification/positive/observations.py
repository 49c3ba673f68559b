"""The observations of the ``positive`` identification: outputs as sums over the FOD surface.

The output after any history is a signed sum of the surface at the corners of the staircase (thesis §3.4):

    y = y(M₁,M₁) + [y(M₁,m₁) − y(M₁,M₁)] + [y(M₂,M₂) − y(M₂,m₁)] + …

From a diagonal state B_ℓ it is an integral of the surface's slopes along α + β = 2ℓ (theory.md §1). So any settled
point with a known memory is one linear equation, from any protocol.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, hstack, vstack

from smarig.core import Array, DataError
from smarig.identification.fod_data import FodData
from smarig.identification.positive.triangle import Triangle
from smarig.preisach import State
from smarig.record import Run
from smarig.replay import MemoryHistory, memory_histories

Integers = NDArray[np.int64]
COMMON = -1
MIN_REVERSAL = 0.01  # of the range: smaller reversals do not end a branch
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True, eq=False)
class Observations:
    """Outputs y (m,) in ``unit``, each Σ sign · y(α, β) over its terms (t,), plus integrals from B_ℓ.

    ``term`` (t,) is the observation of each term. ``curve`` (m,) is the number of the whole curve of a point.
    ``zero`` (m,) is the index of its unknown offset, or ``COMMON`` for the common zero of the encoder, which y₋
    includes. ``released`` are (observation, ℓ, u, sign): the output change of a move from ℓ to u in state B_ℓ.
    ``passed`` (p,) are levels at which the input turned without a measurement. ``known`` is the number of points with a
    known memory of each run.
    """

    y: Array
    curve: Integers
    zero: Integers
    term: Integers
    sign: Array
    alpha: Array
    beta: Array
    released: tuple[tuple[int, float, float, float], ...]
    lower: float
    upper: float
    unit: str = ""
    passed: Array = field(default_factory=lambda: np.empty(0))
    known: tuple[int, ...] = ()

    def __len__(self) -> int:
        return self.y.size

    @property
    def offsets(self) -> int:
        """Number of free offsets in addition to y₋."""
        return int(self.zero.max(initial=COMMON)) + 1

    @classmethod
    def of_points(
        cls, alpha: Array, beta: Array, y: Array, curve: Integers, ends: tuple[float, float], unit: str = ""
    ) -> "Observations":
        """First-order points y(α, β): one term each, for any set of curves."""
        n = np.arange(y.size)
        common = np.full(y.size, COMMON)
        return cls(
            y=y,
            curve=curve,
            zero=common,
            term=n,
            sign=np.ones(y.size),
            alpha=alpha,
            beta=beta,
            released=(),
            lower=ends[0],
            upper=ends[1],
            unit=unit,
        )

    @classmethod
    def of_fod(cls, data: FodData) -> "Observations":
        """The points of FOD data; a curve is a peak, as in the choice of a surface."""
        curve = np.unique(data.alpha, return_inverse=True)[1].astype(np.int64)
        return cls.of_points(data.alpha, data.beta, data.y, curve, (data.lower, data.upper), data.unit)

    @classmethod
    def of_runs(cls, runs: Sequence[Run]) -> "Observations":
        """Every point with a known memory of runs of any protocol; a curve is an excursion, out and back. Imported
        runs that continue each other are parts of one record, whose excursions go on; runs of a rig are experiments of
        their own.
        """
        lower, upper, records = memory_histories(runs)
        imported = [run.info.imported is not None for run in runs]
        curves = _curves(records, imported, MIN_REVERSAL * (upper - lower))
        parts = [
            cls._of_history(record, curve, (lower, upper), runs[0].unit)
            for record, curve in zip(records, curves)
        ]
        whole = joined_observations(parts, curves_go_on=True)
        if not len(whole):
            raise DataError(
                "No point of the runs has a known memory. Start a run in negative saturation, or let it "
                "reach saturation once."
            )
        return replace(whole, known=tuple(len(part) for part in parts))

    @classmethod
    def _of_history(
        cls, history: MemoryHistory, curve: Integers, ends: tuple[float, float], unit: str
    ) -> "Observations":
        known = {k: state for k, state in enumerate(history.states) if state is not None}
        rows = list(known)
        found = cls.of_states(list(known.values()), history.outputs[rows], curve[rows], ends, unit)
        return replace(found, passed=np.setdiff1d(history.turns, history.inputs))

    @classmethod
    def of_states(
        cls, states: Sequence[State], y: Array, curve: Integers, ends: tuple[float, float], unit: str = ""
    ) -> "Observations":
        """Outputs y (m,) of an operator at memories, with one common zero."""
        terms: list[tuple[int, float, float, float]] = []
        released: list[tuple[int, float, float, float]] = []
        for row, state in enumerate(states):
            corners, diagonal = corners_of(state, ends[0])
            terms += [(row, *corner) for corner in corners]
            released += [(row, *move) for move in diagonal]
        term, sign, alpha, beta = np.array(terms, dtype=float).reshape(len(terms), 4).T
        common = np.full(y.size, COMMON)
        return cls(
            y=y,
            curve=curve,
            zero=common,
            term=term.astype(np.int64),
            sign=sign,
            alpha=alpha,
            beta=beta,
            released=tuple(released),
            lower=ends[0],
            upper=ends[1],
            unit=unit,
        )

    def where(self, mask: NDArray[np.bool_]) -> "Observations":
        """The observations of a mask (m,); curve numbers, offsets and range stay."""
        place = np.cumsum(mask) - 1
        terms = mask[self.term]
        kept = tuple((int(place[k]), *rest) for k, *rest in self.released if mask[k])
        return replace(
            self,
            y=self.y[mask],
            curve=self.curve[mask],
            zero=self.zero[mask],
            term=place[self.term[terms]],
            sign=self.sign[terms],
            alpha=self.alpha[terms],
            beta=self.beta[terms],
            released=kept,
        )

    def mirrored(self) -> "Observations":
        """The same observations of the mirror image (u, y) → (−u, −y) of a hysteresis around zero.

        A point reached from negative saturation over α at β is, in the mirror, reached by a fall from positive
        saturation to −α and a rise to −β: −y = y(u₊, −α) + y(−β, −β) − y(−β, −α). A fit to both sets gives a
        symmetric measure, because the minimum of a convex function has the symmetry of the function.
        """
        if self.released:
            raise DataError("Observations that start in a diagonal state cannot be mirrored. Saturate first.")
        if abs(self.lower + self.upper) > 1e-6 * (self.upper - self.lower):
            raise DataError(
                f"Mirror symmetry needs a range around zero, but this one is [{self.lower:g}, {self.upper:g}]."
            )
        a, b, top = -self.beta, -self.alpha, np.full(self.alpha.size, self.upper)
        pieces = [(top, b, 1.0), (a, a, 1.0), (a, b, -1.0)]
        return replace(
            self,
            y=-self.y,
            term=np.tile(self.term, 3),
            sign=np.concatenate([self.sign * s for _, _, s in pieces]),
            alpha=np.concatenate([x for x, _, _ in pieces]),
            beta=np.concatenate([x for _, x, _ in pieces]),
            passed=np.concatenate([self.passed, -self.passed]),
        )

    def matrix(self, triangle: Triangle) -> csr_matrix:
        """Rows over the triangle's unknowns, then the free offsets: (m, unknowns + offsets)."""
        rows = self.corner_sums @ triangle.values(self.alpha, self.beta)
        if self.released:
            rows = rows + self._released(triangle)
        return csr_matrix(hstack([rows, self.free_zeros]))

    @property
    def corner_sums(self) -> csr_matrix:
        """The signed sums (m, t) over the surface's values at the corners."""
        places = (self.term, np.arange(self.sign.size))
        return csr_matrix((self.sign, places), shape=(len(self), self.sign.size))

    @property
    def free_zeros(self) -> csr_matrix:
        """Which free zero (m, offsets) each output has."""
        free = np.flatnonzero(self.zero != COMMON)
        return csr_matrix((np.ones(free.size), (free, self.zero[free])), shape=(len(self), self.offsets))

    def _released(self, triangle: Triangle) -> csr_matrix:
        """Contributions of moves from a diagonal state to the rows; many memories share a few such moves."""
        moves = list(dict.fromkeys((centre, u) for _, centre, u, _ in self.released))
        place = {move: k for k, move in enumerate(moves)}
        sign = [sign for *_, sign in self.released]
        row = [k for k, *_ in self.released]
        column = [place[centre, u] for _, centre, u, _ in self.released]
        chosen = csr_matrix((sign, (row, column)), shape=(len(self), len(moves)))
        return csr_matrix(chosen @ vstack([_released_row(triangle, *move) for move in moves]))


def _curves(
    records: Sequence[MemoryHistory], may_go_on: Sequence[bool], min_reversal: float
) -> list[Integers]:
    """The number of the excursion of each input of each record; those of different records differ, unless one that may
    go on continues the other.
    """
    chains: list[list[MemoryHistory]] = []
    for record, goes_on in zip(records, may_go_on):
        if record.continued and goes_on:
            chains[-1].append(record)
        else:
            chains.append([record])
    found, first = list[Integers](), 0
    for chain in chains:
        number = first + excursions(np.concatenate([record.inputs for record in chain]), min_reversal)
        first = int(number.max(initial=first - 1)) + 1
        found += np.split(number, np.cumsum([record.inputs.size for record in chain])[:-1])
    return found


def excursions(u: Array, min_reversal: float) -> Integers:
    """The number of the excursion of each input (k,): out to a turning point and back.

    Excursions start at the turning points that vary less. An excursion of first-order descending curves is a peak
    with the descent from it; for curves from positive saturation it is a valley with the rise. A peak held out
    alone would be predicted from its own descent.

    >>> excursions(np.array([0.0, 5.0, 0.0, 7.0, 3.0, 0.0, 9.0, 3.0]), 1.0).tolist()
    [0, 0, 0, 1, 1, 1, 2, 2]
    >>> excursions(np.array([9.0, 5.0, 9.0, 3.0, 5.0, 9.0, 0.0, 3.0]), 1.0).tolist()
    [0, 0, 0, 1, 1, 1, 2, 2]
    """
    branch = branches(u, min_reversal)
    ends = np.flatnonzero(np.diff(branch))
    if ends.size < 2:
        return np.zeros_like(branch)
    turns = u[np.concatenate([[0], ends])]
    first, second = np.ptp(turns[::2]), np.ptp(turns[1::2])
    return branch // 2 if first <= second else (branch + 1) // 2


def branches(u: Array, min_reversal: float) -> Integers:
    """The number of the monotone branch of each input (k,); reversals smaller than ``min_reversal`` are noise.

    >>> branches(np.array([0.0, 5.0, 9.0, 8.9, 10.0, 4.0, 6.0]), 1.0).tolist()
    [0, 0, 0, 0, 0, 1, 2]
    """
    number = np.zeros(u.size, dtype=np.int64)
    turn, count, rising = 0, 0, None
    low = high = float(u[0]) if u.size else 0.0
    for k, v in enumerate(u.tolist()):
        low, high = min(low, v), max(high, v)
        back = (high - v) if rising else (v - low)
        if rising is None:
            rising = (v - low > high - v) if high - low >= min_reversal else None
        elif back >= min_reversal:  # everything since the extremum belongs to the new branch
            rising, count = not rising, count + 1
            number[turn + 1 : k] = count
            low = high = v
        if v == (high if rising else low):
            turn = k
        number[k] = count
    return number


def joined_observations(parts: Iterable[Observations], *, curves_go_on: bool = False) -> Observations:
    """Several sets with one range joined; curves and offsets of different sets stay different, unless the numbers of
    their curves go on.
    """
    parts = [part for part in parts if len(part)] or list(parts)[:1]
    row = curve = zero = 0
    shifted = []
    for part in parts:
        shifted.append(
            replace(
                part,
                curve=part.curve + (0 if curves_go_on else curve),
                zero=np.where(part.zero == COMMON, COMMON, part.zero + zero),
                term=part.term + row,
                released=tuple((k + row, ell, u, sign) for k, ell, u, sign in part.released),
            )
        )
        row, curve, zero = row + len(part), curve + int(part.curve.max(initial=-1)) + 1, zero + part.offsets
    names = ("y", "curve", "zero", "term", "sign", "alpha", "beta", "passed")
    arrays: dict[str, Any] = {n: np.concatenate([getattr(part, n) for part in shifted]) for n in names}
    return replace(parts[0], released=tuple(r for part in shifted for r in part.released), **arrays)


def corners_of(
    state: State, lower: float
) -> tuple[list[tuple[float, float, float]], list[tuple[float, float, float]]]:
    """(sign, α, β) on the FOD surface, and (ℓ, u, sign) from the diagonal, whose sum is the output.

    β of the last one is the present input, by which ``adapted_nodes`` places its nodes.
    """
    path = [*state.extrema, state.u]
    corners: list[tuple[float, float, float]] = []
    released: list[tuple[float, float, float]] = []
    start, first = path[0], 1
    if state.diagonal:
        corners.append((1.0, lower, lower))
        released.append((start, lower, -1.0))  # ψ(ℓ): a fall to u₋ would switch all relays down
        if len(path) > 1 and path[1] != start:
            released.append((start, path[1], 1.0))
        start, first = path[1], 2
    else:
        corners.append((1.0, start, start))
    for before, now in zip(path[first - 1 :], path[first:]):
        if now > before:
            corners += [(-1.0, now, before), (1.0, now, now)]
        elif now < before:
            corners += [(-1.0, before, before), (1.0, before, now)]
    return corners, released


def _released_row(triangle: Triangle, centre: float, u: float) -> csr_matrix:
    """Output change of a move from ℓ = centre to u in B_ℓ, exact: Gauss quadrature between all kinks."""
    ends = sorted((centre, u))
    kinks = np.concatenate([triangle.nodes, 2 * centre - triangle.nodes, ends])
    edges = np.unique(kinks[(kinks >= ends[0]) & (kinks <= ends[1])])
    half = np.diff(edges)[:, None] / 2
    at = ((edges[1:] + edges[:-1])[:, None] / 2 + half * _NODES).ravel()
    weight = (half * _WEIGHTS).ravel() / (triangle.nodes[-1] - triangle.nodes[0])
    mirror = np.clip(2 * centre - at, triangle.nodes[0], triangle.nodes[-1])
    slopes = triangle.rising_slope(at, mirror) if u > centre else -triangle.falling_slope(mirror, at)
    return csr_matrix(weight[None, :]) @ slopes
