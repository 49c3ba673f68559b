"""How many extrema a wire remembers: the order n of the restricted model, judged on runs held out.

The hysteresis is identified elsewhere (first-order curves hold no deeper memory); each nested-loop run is
simulated with every order, up to one offset. An order is compatible when, run by run, its squares are
not significantly above the best one's (paired, Student's t). Knows no physics.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from smarig.core.errors import DataError
from smarig.identification.extended.extremum_chains import extremum_chains
from smarig.preisach.everett import Everett
from smarig.record import Run
from smarig.theory.extended.restricted_operator import RestrictedPreisach

Array = NDArray[np.float64]
ORDERS: tuple[int | None, ...] = (1, 2, 3, 4, 5, 6, None)


@dataclass(frozen=True)
class OrderChoice:
    """The order chosen (None: all extrema), those compatible, rms of each order, and rms on runs held out in turn."""

    order: int | None
    compatible: tuple[int | None, ...]
    rms: dict[int | None, float]
    held_out_rms: float


def choose_order(
    runs: Sequence[Run], hysteresis: Everett, orders: Sequence[int | None] = ORDERS
) -> OrderChoice:
    """The order with the least misfit; of orders that simulate the same, the largest (the classical model last).

    ``held_out_rms``: every run judged by the order the other runs choose. DataError with fewer than 3 runs.
    """
    if len(runs) < 3:
        raise DataError(f"{len(runs)} runs cannot hold one another out; give at least 3 with nested loops.")
    record = extremum_chains(runs)
    orders = sorted(set(orders), key=lambda n: np.inf if n is None else n, reverse=True)
    squares = np.empty((len(orders), len(runs)))
    for row, order in enumerate(orders):
        model = RestrictedPreisach(hysteresis, order)
        for r in range(len(runs)):
            here = record.run == r
            left = record.y[here] - model.simulate(record.u[here])
            squares[row, r] = np.sum((left - left.mean()) ** 2)
    points = np.bincount(record.run)
    best = int(np.argmin(squares.sum(axis=1)))
    held_out_squares = [
        squares[np.argmin(np.delete(squares, r, axis=1).sum(axis=1)), r] for r in range(len(runs))
    ]
    compatible = [n for n, row in zip(orders, squares, strict=True) if not _worse(row - squares[best])]
    return OrderChoice(
        orders[best],
        tuple(reversed(compatible)),
        {n: float(np.sqrt(row.sum() / points.sum())) for n, row in zip(orders, squares, strict=True)},
        float(np.sqrt(np.sum(held_out_squares) / points.sum())),
    )


def _worse(gain: Array) -> bool:
    """Whether paired differences (runs,) are above zero at 95 %, one-sided."""
    error = float(gain.std(ddof=1)) / gain.size**0.5
    return bool(gain.mean() > student.ppf(0.95, gain.size - 1) * error) if gain.any() else False
