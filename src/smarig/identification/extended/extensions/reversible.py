"""The model y = Γ[u] + r(u): a reversible part in addition to the hysteresis, from both major branches.

The reversible part from the mean of the ascending and descending major branches.

    r(u) = ½ [y⁺(u) − Γ⁺(u)] + ½ [y⁻(u) − Γ⁻(u)]

is the common difference of both branches from the hysteresis Γ (Mayergoyz, ch. 2: without Γ it is the fully
reversible component itself). Half the difference of the two terms is not explained by r.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import Array, DataError, chi2_tail, normal_quantile
from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.interval_estimate import Estimate
from smarig.preisach import Everett, Preisach
from smarig.record import Run
from smarig.replay import memory_histories
from smarig.theory import ReversiblePart, ReversiblePreisach


def reversible(data: ExtensionData) -> FittedExtension:
    """A function r(u) of the present input, added to the output."""
    fit = identify_reversible(data.runs, data.hysteresis, data.noise)
    nodes, values = fit.part.nodes, fit.part.values
    low, high = fit.interval()
    k = int(np.argmax(np.abs(values)))
    largest = Estimate(
        float(values[k]),
        (float(low[k]), float(high[k])),
        data.unit,
        f"largest |r|, at input {nodes[k]:g}",
        nodes.size,
    )
    kept = {"kind": "reversible", "nodes": nodes.tolist(), "values": values.tolist()}
    return FittedExtension("r(u), without memory", {"largest_r": largest}, fit.p_none, kept)


@dataclass(frozen=True, eq=False)
class ReversibleFit:
    """r at the inputs that both branches visit, its standard error (n,), and two p-values.

    ``p_none`` tests r ≡ constant. ``p_enough`` tests that the branches differ by noise only after r is removed.
    """

    hysteresis: Everett
    part: ReversiblePart
    error: Array
    p_none: float
    p_enough: float

    def model(self) -> ReversiblePreisach:
        """The identified operator."""
        return ReversiblePreisach(self.hysteresis, self.part)

    def interval(self) -> tuple[Array, Array]:
        """95 % interval of r at each input."""
        half = normal_quantile(0.975) * self.error
        return self.part.values - half, self.part.values + half


def identify_reversible(runs: Sequence[Run], hysteresis: Everett, noise: float) -> ReversibleFit:
    """Identify r in addition to a hysteresis without a reversible part; ``noise`` is that of one settled output.

    Raises DataError unless the runs contain both major branches, from saturation to saturation, at two common
    inputs at least.
    """
    lower, upper, records = memory_histories(runs)
    branches: dict[str, dict[float, list[float]]] = {"up": {}, "down": {}}
    for record in records:
        for u, y, state in zip(record.inputs.tolist(), record.outputs.tolist(), record.states, strict=True):
            if state is None or state.diagonal or state.extrema[0] != lower or not lower < u < upper:
                continue
            if len(state.extrema) == 1:
                branches["up"].setdefault(u, []).append(y)
            elif state.extrema[1:] == (upper,):
                branches["down"].setdefault(u, []).append(y)
    common = sorted(branches["up"].keys() & branches["down"].keys())
    if len(common) < 2:
        raise DataError(
            f"The ascending and the descending major branch share {len(common)} inputs, but the reversible part needs "
            "at least 2. Run both branches through one partition, from saturation to saturation."
        )
    model = Preisach(hysteresis)
    up = np.array([np.mean(branches["up"][u]) for u in common]) - model.simulate(common)
    down = (
        np.array([np.mean(branches["down"][u]) for u in common])
        - model.simulate(common[::-1], "positive")[::-1]
    )
    r = (up + down) / 2
    variance = sum(1 / np.array([len(branches[b][u]) for u in common]) for b in ("up", "down")) * noise**2 / 4
    weights = 1 / np.asarray(variance)
    level = float(r @ weights / weights.sum())
    return ReversibleFit(
        hysteresis,
        ReversiblePart(np.array(common), r),
        np.sqrt(np.asarray(variance)),
        chi2_tail(float((r - level) ** 2 @ weights), len(common) - 1),
        chi2_tail(float(((up - down) / 2) ** 2 @ weights), len(common)),
    )
