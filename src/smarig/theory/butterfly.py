"""The butterfly of Fig. 7.5, strain of a magnetostrictive rod against field: a hysteresis with negative relays.

In s = (α + β)/2 and r = (α − β)/2 the measure is odd about the line α = −β where s = 0:

    μ(s, r) ∝ s e^{−s²/2w²} e^{−(r − c)²/2d²}        positive for s > 0, negative for s < 0.

A falling field switches the positive relays first, so that the strain falls, and below −c the negative ones:
it rises again. The two wings of the major loop cross at u = 0, and both saturations have one output.
Not in M_P. Strain and field are no pair whose product is power, so a rod that dissipates may well have a
butterfly for which ∫u dy does not: §7.2 names it as the case its theorem misses. Knows no energy.
"""

import numpy as np
from numpy.typing import NDArray

from smarig.core import UsageError
from smarig.preisach import FodTable, RelayMeasure
from smarig.theory.properties.triangle_grid import table_of

Array = NDArray[np.float64]


def butterfly_table(levels: int = 24, upper: float = 1.0, coercive: float = 0.2) -> FodTable:
    """The butterfly as a table on ``levels`` even cells a side of [−upper, upper]; no reversible part.

    ``coercive``: field of the wings' lowest points, over ``upper``. Output 0 in both saturations and −1 at
    the lowest point of the major loop. UsageError unless levels ≥ 4, upper > 0 and 0 < coercive < 1.

    >>> table = butterfly_table()
    >>> y = table.y(1.0, table.nodes)                                       # the falling branch
    >>> bool(abs(y[0] - y[-1]) < 1e-15), round(float(y.min()), 12), bool(table.nodes[y.argmin()] < 0)
    (True, -1.0, True)
    """
    u, cells = _cells(levels, upper, coercive)
    return table_of(u, cells)


def butterfly_relays(levels: int = 24, upper: float = 1.0, coercive: float = 0.2) -> RelayMeasure:
    """The butterfly as relays, one for each cell of ``butterfly_table``, at its upper left corner.

    On the levels it is the table: same outputs, by the definition (3.1) alone.
    """
    u, cells = _cells(levels, upper, coercive)
    i, j = np.nonzero(np.tri(levels, k=-1, dtype=bool))
    return RelayMeasure.from_arrays(u[i + 1], u[j], cells[i, j] / 2)


def _cells(levels: int, upper: float, coercive: float) -> tuple[Array, Array]:
    """Levels (n + 1,) and masses ν (n, n) of the cells, odd about α = −β, major loop 0 … −1 … 0."""
    if levels < 4 or not upper > 0 or not 0 < coercive < 1:
        raise UsageError(
            f"A butterfly needs at least 4 levels, upper > 0 and 0 < coercive < 1; "
            f"got {levels}, {upper:g} and {coercive:g}."
        )
    u = np.linspace(-upper, upper, levels + 1)
    middle = (u[1:] + u[:-1]) / (2 * upper)
    s, r = (middle[:, None] + middle) / 2, (middle[:, None] - middle) / 2
    cells = np.tril(s * np.exp(-((s / 0.35) ** 2) / 2 - ((r - coercive) / 0.08) ** 2 / 2), k=-1)
    cells = (cells - cells[::-1, ::-1].T) / 2  # odd to the last bit
    falling = np.cumsum(cells.sum(axis=0))  # y(u₊, u_j) − y₋
    return u, cells / -falling.min()
