"""The two branches of the major loop in a run of sweeps, passed at several rates.

A rise from rest at the lower end follows one curve of the input, whatever its rate and its end (wiping-out, §3.3.1; a
wire that is all martensite forgets as well). So does a fall from the upper end. No assumption on minor loops is needed,
so the branches determine the heating of a wire that is no Preisach operator.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from smarig.core import Array
from smarig.identification.positive.adapted_partition import nodes_along
from smarig.identification.sweeps.sweep_heat import SweepHeat
from smarig.identification.sweeps.sweep_record import SweepRecord

Integers = NDArray[np.int64]
KNOTS = 60
AT_TOP = 0.95  # of the range: a fall from above it starts at the upper end
ROUGHNESS = 1e-3  # of neighbouring coefficients, where no block lies
_FEWEST = 30  # blocks of a branch


@dataclass(frozen=True, eq=False)
class MajorBranches:
    """Blocks of a record on its major loop: ``branch`` (b,) is 0 on rises, 1 on falls from the top, −1 elsewhere."""

    record: SweepRecord
    branch: Integers
    knots: tuple[Array, ...]

    @classmethod
    def of(cls, record: SweepRecord) -> "MajorBranches | None":
        """The branches of a record; None if it does not contain both."""
        branch = np.where(record.sizes > 0, _branch_of_blocks(record), -1)
        if min(np.count_nonzero(branch == k) for k in (0, 1)) < _FEWEST:
            return None
        inputs, outputs = record.means(record.inputs_K(record.actuator.tau_s)), record.means(record.position)
        knots = []
        for k in (0, 1):
            rows = np.flatnonzero(branch == k)
            rows = rows[np.argsort(inputs[rows], kind="stable")]
            nodes = nodes_along(inputs[rows], outputs[rows], np.zeros(rows.size, dtype=np.int64), KNOTS)
            inside = nodes[(nodes > record.lower) & (nodes < record.upper)]
            knots.append(np.concatenate([[record.lower], inside, [record.upper]]))
        return cls(record, branch, tuple(knots))

    @property
    def sweep(self) -> Integers:
        """The sweep of each residual."""
        of_block = self.record.sweep[self.record.blocks]
        return np.concatenate([of_block[self.branch == k] for k in range(len(self.knots))])

    def residuals(self, tau_s: float, heat: SweepHeat) -> Array:
        """Residuals (m,) of the best curve of each branch, model minus measurement."""
        tried = self.record.with_heat(heat)
        inputs, outputs = tried.means(tried.inputs_K(tau_s)), tried.means(tried.position)
        parts = []
        for k, knots in enumerate(self.knots):
            rows = self.branch == k
            u = np.clip(inputs[rows], knots[0], knots[-1])
            padded = np.concatenate([[knots[0]] * 3, knots, [knots[-1]] * 3])
            design = BSpline.design_matrix(u, padded, 3).toarray()
            rough = ROUGHNESS * np.diff(np.eye(design.shape[1]), 2, axis=0)
            target = np.concatenate([outputs[rows], np.zeros(len(rough))])
            values = np.linalg.lstsq(np.vstack([design, rough]), target, rcond=None)[0]
            parts.append(design @ values - outputs[rows])
        return np.concatenate(parts)


def _branch_of_blocks(record: SweepRecord) -> Integers:
    """0, 1 or −1 of each block (b,); a rest belongs to the fall before it."""
    names = [step.branch for step in record.run.steps]
    inputs, edge = record.inputs_K(record.actuator.tau_s), record.lower + AT_TOP * record.span_K
    of_step = np.full(len(names) + 1, -1)
    for k, name in enumerate(names):
        rows = np.flatnonzero(record.sweep == k)
        if name.startswith("rise"):
            of_step[k] = 0
        elif name.startswith("fall") and rows.size and inputs[rows[0]] >= edge:
            of_step[k] = 1
        elif name.startswith("rest") and k:
            of_step[k] = of_step[k - 1]
    return of_step[record.sweep[record.blocks]]
