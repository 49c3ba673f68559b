"""Least squares of sweeps for one τ at a time: the density is eliminated (variable projection, Golub & Pereyra 1973).

    J(τ) = min over θ of ‖X(τ) θ − y‖²/m + λ θᵀR θ

X(τ) holds the block means as sums over the FOD surface along the input that τ predicts from the measured current. The
density may have any sign here: a constraint that the wire does not obey would be paid for with a wrong τ. λ is small:
without any, cells between the curves would follow a wrong τ.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_matrix

from smarig.core import Array
from smarig.identification.measured.mass_programme import unknowns_of_masses
from smarig.identification.positive.adapted_partition import nodes_along
from smarig.identification.positive.observations import COMMON, Observations, joined_observations
from smarig.identification.positive.triangle import Triangle
from smarig.identification.sweeps.sweep_record import SweepRecord

Integers = NDArray[np.int64]
SMOOTHING = 1e-13
RIDGE = 1e-13
CLOSEST = 2e-3  # of the range: closer nodes are one


@dataclass(frozen=True, eq=False)
class LagProblem:
    """Sweeps on a triangle of cells. Outputs are in units of ``scale``."""

    records: tuple[SweepRecord, ...]
    triangle: Triangle
    scale: float

    @classmethod
    def of(cls, records: Sequence[SweepRecord], intervals: int) -> "LagProblem":
        """The problem of records, with cells that suit the constants of their actuator."""
        records = with_common_range(records)
        paths = [record.branches() for record in records]
        inputs, outputs, sweep = (np.concatenate(parts) for parts in zip(*paths))
        ends = np.array([records[0].lower, records[0].upper])  # for every τ
        nodes = np.concatenate([ends, nodes_along(inputs, outputs, sweep, intervals)])
        return cls(tuple(records), Triangle(apart(nodes)), float(np.ptp(outputs)) or 1.0)

    @cached_property
    def sweep(self) -> Integers:
        """The number of the sweep of each block (m,), through all records."""
        return joined(self.records, self.records[0].actuator.tau_s).curve

    def projected(self, log_tau: float) -> tuple[float, Array]:
        """(J(τ) in squared output units, residuals (m,)) with the best density for this τ: model minus measurement."""
        observations = joined(self.records, float(np.exp(log_tau)))
        rows, y = self._rows(observations), (observations.y - self._zeros(observations)) / self.scale
        H = rows.T @ rows / y.size
        H[: self.triangle.cells, : self.triangle.cells] += SMOOTHING * self._roughness
        H[np.diag_indices_from(H)] += RIDGE
        x = np.asarray(cho_solve(cho_factor(H, overwrite_a=True), rows.T @ y / y.size))
        residual, density = self.scale * (rows @ x - y), x[: self.triangle.cells]
        rough = SMOOTHING * self.scale**2 * float(density @ self._roughness @ density)
        return float(np.mean(residual**2)) + rough, residual

    def _rows(self, observations: Observations) -> Array:
        """Rows (m, cells + 1 + offsets) over √area · density of each cell, y₋ and the free zeros.

        Over the outputs at the nodes, whose second differences are the density, the digits would not suffice.
        """
        cells = self.triangle.cells
        rows = observations.matrix(self.triangle)
        of_nodes, offsets = csr_matrix(rows[:, : cells + 1]), rows[:, cells + 1 :].toarray()
        of_masses = np.asarray(of_nodes @ unknowns_of_masses(self.triangle.nodes.size - 1))
        of_masses[:, :cells] *= self._root_area
        return np.hstack([of_masses, offsets])

    def _zeros(self, observations: Observations) -> Array:
        """What is subtracted from outputs (m,): the mean of those with one zero."""
        place = observations.zero + 1
        return (np.bincount(place, observations.y) / np.maximum(np.bincount(place), 1))[place]

    @cached_property
    def _root_area(self) -> Array:
        return np.sqrt(self.triangle.areas)

    @cached_property
    def _roughness(self) -> Array:
        """The roughness as a quadratic form of √area · density (cells, cells)."""
        return self._root_area[:, None] * self.triangle.roughness_of_masses.toarray() * self._root_area


def apart(nodes: Array) -> Array:
    """The nodes in order, without those that are closer to another than a node of rounding."""
    at = np.unique(nodes)
    keep = np.diff(at, prepend=-np.inf) > CLOSEST * np.ptp(at)
    keep[-1] = True
    if at.size > 2 and at[-1] - at[-2] <= CLOSEST * np.ptp(at):
        keep[-2] = False
    return at[keep]


def with_common_range(records: Sequence[SweepRecord]) -> list[SweepRecord]:
    """The records with one range of inputs."""
    lower, upper = min(r.lower for r in records), max(r.upper for r in records)
    return [replace(r, lower=lower, upper=upper) for r in records]


def joined(records: Sequence[SweepRecord], tau_s: float) -> Observations:
    """Observations of all records; each but the first has a zero of its own."""
    parts = []
    for k, record in enumerate(records):
        part = record.observations(tau_s)
        zero = np.full(len(part), 0 if k else COMMON)
        parts.append(replace(part, zero=zero, curve=np.unique(part.curve, return_inverse=True)[1]))
    return joined_observations(parts)
