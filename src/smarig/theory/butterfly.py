"""The butterfly loop of Fig. 7.5 (strain of a magnetostrictive rod against field): a hysteresis with negative relays.

In s = (α + β)/2 and r = (α − β)/2 the measure is odd about the line α = −β, where s = 0:

    μ(s, r) ∝ s e^{−s²/2w²} e^{−(r − c)²/2d²}        positive for s > 0, negative for s < 0.

A falling field first switches the positive relays, so the strain falls. Below −c it switches the negative relays, so
the strain rises again. The two wings of the major loop cross at u = 0, and the output is the same in both saturations.
The measure is not in M_P. The product of strain and field is not a power, so a dissipating rod may have a butterfly
loop for which ∫u dy does not dissipate. §7.2 names this case as one that its theorem does not cover.
"""

import numpy as np

from smarig.core import Array, UsageError
from smarig.preisach import FodTable, RelayMeasure
from smarig.theory.properties.triangle_grid import table_of


def butterfly_table(levels: int = 24, upper: float = 1.0, coercive: float = 0.2) -> FodTable:
    """The butterfly as a table with ``levels`` equal cells per side on [−upper, upper], without reversible part.

    ``coercive`` is the field at the lowest points of the wings, relative to ``upper``. The output is 0 in both
    saturations and −1 at the lowest point of the major loop. UsageError unless levels ≥ 4, upper > 0 and
    0 < coercive < 1.

    >>> table = butterfly_table()
    >>> y = table.y(1.0, table.nodes)                                       # the falling branch
    >>> bool(abs(y[0] - y[-1]) < 1e-15), round(float(y.min()), 12), bool(table.nodes[y.argmin()] < 0)
    (True, -1.0, True)
    """
    u, cells = _cells(levels, upper, coercive)
    return table_of(u, cells)


def butterfly_relays(levels: int = 24, upper: float = 1.0, coercive: float = 0.2) -> RelayMeasure:
    """The butterfly as relays: one for each cell of ``butterfly_table``, at its upper left corner.

    At the levels it has the same outputs as the table, by the definition (3.1) alone.
    """
    u, cells = _cells(levels, upper, coercive)
    i, j = np.nonzero(np.tri(levels, k=-1, dtype=bool))
    return RelayMeasure.from_arrays(u[i + 1], u[j], cells[i, j] / 2)


def _cells(levels: int, upper: float, coercive: float) -> tuple[Array, Array]:
    """Levels (n + 1,) and masses ν (n, n) of the cells, odd about α = −β, with the major loop 0 … −1 … 0."""
    if levels < 4 or not upper > 0 or not 0 < coercive < 1:
        raise UsageError(
            f"A butterfly needs at least 4 levels, upper > 0 and 0 < coercive < 1; "
            f"got {levels}, {upper:g} and {coercive:g}."
        )
    u = np.linspace(-upper, upper, levels + 1)
    middle = (u[1:] + u[:-1]) / (2 * upper)
    s, r = (middle[:, None] + middle) / 2, (middle[:, None] - middle) / 2
    cells = np.tril(s * np.exp(-((s / 0.35) ** 2) / 2 - ((r - coercive) / 0.08) ** 2 / 2), k=-1)
    cells = (cells - cells[::-1, ::-1].T) / 2  # exactly odd
    falling = np.cumsum(cells.sum(axis=0))  # y(u₊, u_j) − y₋
    return u, cells / -falling.min()
