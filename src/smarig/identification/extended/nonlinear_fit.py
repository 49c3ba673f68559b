"""The identification of the nonlinear model from first- and second-order curves: base table, excess, and noise.

    Q(α, β, u) = y(α, β) + y(u, u) − y(u, β) − y_αβ(u)

is measured at each node of one partition: the first-order surface by falling from α, y_αβ(u) by rising again from β
(Mayergoyz, ch. 2; thesis §3.5). Repeats are averaged. If the first-order surface is known from the Everett function
F of an identified hysteresis,

    Q(α, β, u) = F(u, β) − [y_αβ(u) − y(α, β)]

needs the second-order curves only, each relative to the point at which it started. The restricted model of first
order has the same Q; the two models differ for deeper memories.

The excess of second-order curves of several runs, from the run that contains all curves of one partition.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError, chi2_tail, normal_quantile
from smarig.identification.extended.extremum_chains import ExtremumChains, extremum_chains
from smarig.identification.extended.fitted_extension import ExtensionData
from smarig.identification.interval_estimate import Estimate
from smarig.preisach import Everett, FodTable
from smarig.record import Run
from smarig.theory import NonlinearPreisach, RestrictedPreisach, SecondOrderExcess, second_order_mask

MOST_NODES = 34  # of the partition: 5,456 values of Q, whose covariance takes 0.2 GB


@dataclass(frozen=True, eq=False)
class NonlinearFit:
    """First-order table, excess Q, standard error of each Q (n, n, n; NaN where it is zero by definition).

    ``p_value`` tests Q ≡ 0, the classical model, from the second-order curves and ``noise`` (of one settled point).
    """

    hysteresis: Everett
    excess: SecondOrderExcess
    error: Array
    noise: float
    p_value: float

    def model(self) -> NonlinearPreisach:
        """The identified operator."""
        return NonlinearPreisach(self.hysteresis, self.excess)

    def restricted(self) -> RestrictedPreisach:
        """The restricted operator of first order with the same curves."""
        return RestrictedPreisach.first_order(self.hysteresis, self.excess)

    def interval(self) -> tuple[Array, Array]:
        """95 % interval of every Q."""
        half = normal_quantile(0.975) * self.error
        return self.excess.values - half, self.excess.values + half


def identify_nonlinear(runs: Sequence[Run], noise: float, hysteresis: Everett | None = None) -> NonlinearFit:
    """Identify Q from runs whose settled points cover all first- and second-order curves of one partition.

    ``hysteresis`` is the first-order surface if it is known, else it is tabulated from the runs. ``noise`` is the
    standard deviation of one settled output (see ``noise_floor``). Raises DataError with the missing point.
    """
    record = extremum_chains(runs)
    nodes, sums, counts = _first_order(record, _second_order_nodes(record, hysteresis))
    y = np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)
    base = FodTable(nodes, y, record.unit) if hysteresis is None else hysteresis
    second, repeats = _second_order(record, nodes)
    i, j, k = np.nonzero(second_order_mask(nodes.size) & (repeats > 0))
    missing = second_order_mask(nodes.size) & (repeats == 0)
    if missing.any():
        a, b, at = nodes[np.argwhere(missing)[0]]
        raise DataError(f"No second-order point at α = {a:g}, β = {b:g}, u = {at:g}. Measure that curve too.")
    q, error = np.zeros(missing.shape), np.full(missing.shape, np.nan)
    if hysteresis is None:
        q[i, j, k] = y[i, j] + y[k, k] - y[k, j] - second[i, j, k]
    else:
        q[i, j, k] = hysteresis.swept(nodes[k], nodes[j]) - (second[i, j, k] - y[i, j])
    # Each Q is a linear form of means: inverse counts add, and shared first-order points correlate the Qs.
    forms = _forms(i, j, k, nodes.size, known=hysteresis is not None)
    n = np.concatenate([counts[np.tril_indices(nodes.size)], repeats[i, j, k]])
    variance = noise**2 / np.where(n > 0, n, np.inf)
    covariance = (forms * variance) @ forms.T
    error[i, j, k] = np.sqrt(np.diag(covariance))
    statistic = float(q[i, j, k] @ np.linalg.solve(covariance, q[i, j, k]))
    return NonlinearFit(
        base, SecondOrderExcess.from_nodes(nodes, q), error, noise, chi2_tail(statistic, i.size)
    )


def _second_order_nodes(record: ExtremumChains, hysteresis: Everett | None) -> Array | None:
    """The inputs of the second-order curves and both ends; None if the first-order curves determine the partition."""
    if hysteresis is None:
        return None
    found, peak = _second_order_points(record)
    if not found.size:
        raise DataError(
            "The runs contain no second-order curves, which rise again from a fall after the first rise. Run "
            "second_order_transition."
        )
    inputs = np.concatenate([record.u[found], record.u[record.origin[found]], record.u[peak[found]]])
    inner = inputs[(inputs > hysteresis.lower) & (inputs < hysteresis.upper)]
    return np.unique([hysteresis.lower, *inner, hysteresis.upper])


def _check_size(record: ExtremumChains, nodes: int) -> None:
    """Raise DataError for a partition whose curves cannot all have been measured, or are too many to be computed."""
    if nodes <= MOST_NODES:
        return
    points, needed = _second_order_points(record)[0].size, comb(nodes - 1, 3)
    if points < needed:
        raise DataError(
            f"The curves turn and were read at {nodes} different inputs, and all second-order curves between these "
            f"have {needed:,} points, but the runs hold {points:,}. Run second_order_transition."
        )
    raise DataError(
        f"The partition has {nodes} inputs. The nonlinear model is identified with at most {MOST_NODES}."
    )


def _first_order(record: ExtremumChains, partition: Array | None) -> tuple[Array, Array, Array]:
    """Partition (n,), sums and counts (n, n) of y(α, β), the ascending branch on the diagonal."""
    up = record.origin < 0
    down = ~up & (np.append(record.origin, -1)[record.origin] < 0)
    alpha = np.where(up, record.u, record.u[record.origin])
    nodes = np.unique(record.u[up | down]) if partition is None else partition
    _check_size(record, nodes.size)
    used = (up | down) & np.isin(alpha, nodes) & np.isin(record.u, nodes)
    i, j = np.searchsorted(nodes, alpha[used]), np.searchsorted(nodes, record.u[used])
    sums, counts = np.zeros((nodes.size,) * 2), np.zeros((nodes.size,) * 2)
    np.add.at(sums, (i, j), record.y[used])
    np.add.at(counts, (i, j), 1)
    # Negative saturation is one state, reached in any way.
    sums[:, 0], counts[:, 0] = sums[:, 0].sum(), counts[:, 0].sum()
    return nodes, sums, counts


def _second_order(record: ExtremumChains, nodes: Array) -> tuple[Array, Array]:
    """Means and counts (n, n, n) of y_αβ(u): points whose origin β has an origin α on the ascending branch."""
    found, peak = _second_order_points(record)
    places = [record.u[peak[found]], record.u[record.origin[found]], record.u[found]]
    known = np.all([np.isin(p, nodes) for p in places], axis=0)
    index = tuple(np.searchsorted(nodes, p[known]) for p in places)
    sums, counts = np.zeros((nodes.size,) * 3), np.zeros((nodes.size,) * 3)
    np.add.at(sums, index, record.y[found[known]])
    np.add.at(counts, index, 1)
    return np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0), counts


def _second_order_points(record: ExtremumChains) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Points of second-order curves, and for every point the last but one extremum."""
    beyond = np.append(record.origin, -1)
    peak = beyond[record.origin]
    return np.flatnonzero((record.origin >= 0) & (peak >= 0) & (beyond[peak] < 0)), peak


def _forms(
    i: NDArray[np.intp], j: NDArray[np.intp], k: NDArray[np.intp], n: int, *, known: bool = False
) -> Array:
    """Q = y(α, β) + y(u, u) − y(u, β) − y_αβ(u) as rows over the first-order means, then the second-order ones.

    ``known``: y(u, u) − y(u, β) does not come from the data.
    """
    place = np.zeros((n, n), dtype=int)
    place[np.tril_indices(n)] = np.arange(n * (n + 1) // 2)
    first = np.zeros((i.size, n * (n + 1) // 2))
    row = np.arange(i.size)
    first[row, place[i, j]] += 1
    if not known:
        first[row, place[k, k]] += 1
        first[row, place[k, j]] -= 1
    return np.hstack([first, -np.eye(i.size)])


def fitted_excess(data: ExtensionData) -> NonlinearFit:
    """Q of the run with the finest partition with complete second-order curves; DataError if there is none."""
    noise, fits, reason = data.noise, [], ""
    for run in data.runs:
        try:
            fits.append(identify_nonlinear([run], noise, data.hysteresis))
        except DataError as error:
            reason = str(error)
    if not fits:
        raise DataError(
            f"No run contains all second-order curves of a partition (protocol second_order_transition): {reason}"
        )
    return max(fits, key=lambda fit: fit.excess.nodes.size)


def largest_excess(fit: NonlinearFit, unit: str) -> Estimate:
    """The largest |Q| with its 95 % interval."""
    values = np.where(np.isfinite(fit.error), np.abs(fit.excess.values), -1.0)
    at = np.unravel_index(int(np.argmax(values)), values.shape)
    low, high = fit.interval()
    alpha, beta, u = (float(fit.excess.nodes[k]) for k in at)
    source = f"largest |Q|, at α = {alpha:g}, β = {beta:g}, u = {u:g}"
    ends = float(low[at]), float(high[at])
    return Estimate(float(fit.excess.values[at]), ends, unit, source, int(np.isfinite(fit.error).sum()))


def excess_values(fit: NonlinearFit) -> dict[str, Any]:
    """Partition and tensor, for a model file."""
    return {"nodes": fit.excess.nodes.tolist(), "values": fit.excess.values.tolist()}
