"""A positive measure and output terms, fitted to the readings of records under given measurement effects.

    minimise  ‖g P[v] + Σ b_k φ_k + z − y‖²/m + λ (roughness of the measure)    over masses ≥ 0, b and z free

v, g and φ as in ``smarig.measurement``. Masses, amplitudes and zeros are one convex programme; gains g of runs under
different conditions follow by alternation.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.identification.measured.mass_programme import CellRows, MassProgramme
from smarig.identification.measured.reading_plan import ReadingPlan
from smarig.identification.positive.adapted_partition import adapted_nodes
from smarig.identification.positive.observations import Observations, joined_observations
from smarig.identification.positive.triangle import Triangle
from smarig.measurement import (
    InputRecord,
    LearnedTerm,
    MeasurementEffect,
    Start,
    changed,
    learned_input,
    monotone_branches,
    reversals,
)
from smarig.preisach import FodTable, State
from smarig.replay import memory_states

Mask = NDArray[np.bool_]
INTERVALS = 30
SMOOTHINGS = (1e-14, 1e-12, 1e-10)
MAX_ALTERNATIONS = 15
GAIN_TOLERANCE = 2e-3


@dataclass(frozen=True, eq=False)
class MeasuredProblem:
    """The rows of a programme: readings (m, unknowns + zeros + terms) in units of ``scale``, output units.

    ``sign`` is −1 if the output falls while the input rises. ``zero`` (m,) is the index of the zero of each reading;
    ``term_scale`` (k,) normalises the terms. ``weight`` (m,) is the root of each reading's weight.
    ``centre`` (zeros,) is the mean output of each zero, which is subtracted: numbers far from 0 would cost digits.
    """

    plan: ReadingPlan
    effects: tuple[MeasurementEffect, ...]
    cells: CellRows
    sign: float
    scale: float
    terms: Array
    term_scale: Array
    weight: Array
    centre: Array

    @property
    def observations(self) -> Observations:
        """The readings as sums over the FOD surface."""
        return self.cells.observations

    @property
    def triangle(self) -> Triangle:
        """The cells of the measure."""
        return self.cells.triangle

    @property
    def centred(self) -> Array:
        """Outputs (m,) minus the centre of their zero."""
        return self.plan.y - self.centre[self.observations.zero]

    def programme(self, gains: Array) -> MassProgramme:
        """The convex programme for the gain of each record, with weighted rows; the last ones are kept."""
        return _programme(self, gains.tobytes())


@lru_cache(maxsize=4)
def _programme(problem: MeasuredProblem, gains: bytes) -> MassProgramme:
    weight, zero = problem.weight, problem.observations.zero
    zeros = np.equal(zero[:, None], np.arange(problem.observations.offsets)).astype(float)
    return MassProgramme(
        cells=problem.cells,
        factor=weight * problem.sign * np.frombuffer(gains)[problem.plan.record],
        columns=weight[:, None] * np.hstack([zeros, problem.terms / problem.term_scale]),
        y=weight * problem.centred / problem.scale,
    )


@dataclass(frozen=True, eq=False)
class MeasuredFit:
    """A solution: ``predicted`` (m,) for all readings, those not fitted included, in output units.

    ``x`` are the masses of the cells, y₋, the zeros and the amplitudes, as in ``MassProgramme``.
    ``table`` is the hysteresis; ``zeros`` and ``gains`` of each record; ``amplitudes`` (k,) of the terms.
    """

    problem: MeasuredProblem
    x: Array
    gains: Array
    predicted: Array

    @property
    def error(self) -> Array:
        """Measured minus predicted outputs (m,)."""
        return self.problem.plan.y - self.predicted

    @property
    def _unknowns(self) -> int:
        return self.problem.triangle.unknowns

    @property
    def zeros(self) -> Array:
        """Zero of each group of records with a common one, output units."""
        offsets = self.problem.observations.offsets
        return self.problem.scale * self.x[self._unknowns : self._unknowns + offsets] + self.problem.centre

    @property
    def amplitudes(self) -> Array:
        """Amplitude (k,) of each term, in output units per unit of the term."""
        offsets = self.problem.observations.offsets
        return self.problem.scale * self.x[self._unknowns + offsets :] / self.problem.term_scale

    @property
    def shape(self) -> Array:
        """The hysteresis at all readings (m,), with gain 1 and without zero or terms, in output units."""
        of_masses = self.problem.cells.of_masses @ self.x[: self._unknowns]
        return self.problem.scale * self.problem.sign * of_masses

    @property
    def table(self) -> FodTable:
        """The hysteresis, with the sign of the output and gain 1."""
        masses = self.problem.scale * np.maximum(self.x[: self._unknowns - 1], 0.0)
        rising = self.problem.triangle.table(
            masses, self.problem.scale * float(self.x[self._unknowns - 1]), ""
        )
        return rising if self.problem.sign > 0 else FodTable(rising.nodes, -rising.values, rising.unit)


def output_sign(records: Sequence[InputRecord]) -> float:
    """1 if the outputs rise with their inputs, −1 if they fall: the sign of the summed covariance.

    >>> u = np.linspace(0.0, 1.0, 5)
    >>> output_sign([InputRecord("a", u, -u, u, True, u, {}, np.arange(5))])
    -1.0
    """
    total = sum(
        float(np.mean((r.u - r.u.mean()) * (r.y - r.y.mean()))) / (np.ptp(r.u) or 1.0) for r in records
    )
    return -1.0 if total < 0 else 1.0


def measured_problem(
    plan: ReadingPlan,
    effects: Sequence[MeasurementEffect] = (),
    *,
    learned: Sequence[LearnedTerm] = (),
    extra_terms: Array | None = None,
    weight: Array | None = None,
    intervals: int = INTERVALS,
) -> MeasuredProblem:
    """The rows of all readings of a plan under effects, and under the learned terms that enter at the input.

    ``extra_terms`` (m, k) are added to the terms of the effects. ``weight`` (m,) multiplies the rows; None: equal
    weights.
    """
    changes = [changed(record, effects) for record in plan.records]
    applied = [learned_input(record, c.input, learned) for record, c in zip(plan.records, changes)]
    cells = _cell_rows(plan, tuple(u.tobytes() for u in applied), tuple(c.noise for c in changes), intervals)
    zero = cells.observations.zero
    terms = plan.of([c.terms for c in changes])
    terms = terms if extra_terms is None else np.hstack([terms, extra_terms])
    size = np.sqrt(np.mean(terms**2, axis=0)) if terms.size else np.ones(terms.shape[1])
    return MeasuredProblem(
        plan=plan,
        effects=tuple(effects),
        cells=cells,
        sign=output_sign(plan.records),
        scale=float(np.ptp(plan.y)) or 1.0,
        terms=terms,
        term_scale=np.where(size > 0, size, 1.0),
        weight=np.ones(len(plan)) if weight is None else weight,
        centre=np.bincount(zero, plan.y) / np.bincount(zero),
    )


@lru_cache(maxsize=4)
def _cell_rows(
    plan: ReadingPlan, applied: tuple[bytes, ...], noise: tuple[float | None, ...], intervals: int
) -> CellRows:
    """The readings under applied inputs, one of each record; the last ones are kept: many fits share their inputs."""
    paths = [(u, reversals(u, sd)) for u, sd in zip(map(np.frombuffer, applied), noise)]
    inputs = [monotone_branches(u, turns) for u, turns in paths]
    ends = min(float(u.min()) for u in inputs), max(float(u.max()) for u in inputs)
    parts: list[Observations] = []
    memory: State | None = None
    for k, (u, (_, turns), rows, record) in enumerate(zip(inputs, paths, plan.rows, plan.records)):
        start = memory if record.continues and memory else plan.starts[k].state or "negative"
        found, memory = _observations(u, turns, rows, record.y, start, ends, k)
        parts += [found] if rows.size else []
    joined = _joined(parts)
    return CellRows(joined, Triangle(adapted_nodes(joined, intervals)))


def _observations(
    u: Array,
    turns: list[int],
    rows: NDArray[np.int64],
    y: Array,
    start: Start | State,
    ends: tuple[float, float],
    zero: int,
) -> tuple[Observations, State | None]:
    """The observations at the rows of a record, and its final state."""
    path = np.unique(np.concatenate([rows, turns]))
    states = memory_states(np.clip(u[path], *ends), *ends, start)
    at = np.searchsorted(path, rows)
    found = Observations.of_states(
        [state for k in at.tolist() if (state := states[k]) is not None],
        y[rows],
        np.zeros(rows.size, dtype=np.int64),
        ends,
    )
    return replace(found, zero=np.full(rows.size, zero)), states[-1]


def _joined(parts: Sequence[Observations]) -> Observations:
    """Observations of several records; their zeros keep their numbers."""
    zeros = np.unique(np.concatenate([p.zero for p in parts]), return_inverse=True)[1]
    joined = joined_observations(replace(p, zero=np.zeros(len(p), dtype=np.int64)) for p in parts)
    return replace(joined, zero=zeros.astype(np.int64))


def fit_measured(
    problem: MeasuredProblem,
    smoothing: float,
    mask: Mask | None = None,
    *,
    gains: Array | None = None,
    free_gains: bool = False,
    near: MeasuredFit | None = None,
) -> MeasuredFit:
    """The fit to the readings of a mask; all are predicted. ``near``: a similar fit, to find the solution faster.

    ``free_gains``: each record has a gain of its own; those of records without a fitted reading stay as given.
    """
    g = np.ones(len(problem.plan.records)) if gains is None else gains.copy()
    if free_gains and gains is None:
        stroke = np.array([float(np.ptp(r.y)) for r in problem.plan.records])
        g = stroke / stroke.max()
    programme = problem.programme(g)
    x = programme.solved(smoothing, mask, start=None if near is None else near.x)
    for _ in range(MAX_ALTERNATIONS if free_gains else 0):
        again = _gains(problem, programme, x, g, mask)
        change = float(np.abs(again / g - 1).max())
        g, programme = again, problem.programme(again)
        x = programme.solved(smoothing, mask, start=x)
        if change < GAIN_TOLERANCE:
            break
    return MeasuredFit(problem, x, g, predicted_outputs(problem, programme, x))


def predicted_outputs(problem: MeasuredProblem, programme: MassProgramme, x: Array) -> Array:
    """Outputs (m,) at all readings for the unknowns of a programme, in output units."""
    centre = problem.centre[problem.observations.zero]
    return problem.scale * (programme.rows @ x) / problem.weight + centre


def _gains(
    problem: MeasuredProblem, programme: MassProgramme, x: Array, g: Array, mask: Mask | None
) -> Array:
    """Gains by least squares, given the shape: y = g · shape + zero + rest, for each record with a fitted reading."""
    n = problem.triangle.unknowns
    rest = (programme.rows[:, n:] @ x[n:]) / problem.weight
    shape = problem.sign * (problem.cells.of_masses @ x[:n])
    found = g.copy()
    used = np.ones(len(problem.plan), dtype=bool) if mask is None else mask
    for k in np.unique(problem.plan.record[used]).tolist():
        own = used & (problem.plan.record == k)
        s, y = shape[own] - shape[own].mean(), (programme.y / problem.weight - rest)[own]
        square = float(s @ s)
        if square > 0:
            found[k] = max(float(s @ y) / square, 1e-3)
    return found
