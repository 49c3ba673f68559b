"""Random non-negative measures, as relays and as tables, and random loop signals."""

import numpy as np
from hypothesis import strategies as st

from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.controllers.lead_lag import lead_lag
from smarig.control.velocity.controllers.leaky_pi import leaky_pi
from smarig.control.velocity.controllers.saturating_gain import saturating_gain
from smarig.control.velocity.controllers.scheduled_gain import scheduled_gain
from smarig.preisach.hysteresis.fod_table import FodTable

NODES = np.array([-3.0, -1.5, -0.5, 0.0, 1.0, 2.0, 3.0])
DT_S = 0.1


def table(seed: int) -> FodTable:
    """ν ≥ 0 on NODES: exponential masses on cells, some empty, the diagonal ones (g) among them."""
    rng = np.random.default_rng(seed)
    n = NODES.size - 1
    mass = np.tril(rng.exponential(1.0, (n, n)) * (rng.random((n, n)) < 0.7))
    mass[0, 0] += 0.1
    grown = np.zeros((n + 1, n + 1))
    grown[1:, 1:] = np.cumsum(np.cumsum(mass, axis=0), axis=1)
    return FodTable.from_arrays(NODES, NODES, np.where(np.tri(n + 1, dtype=bool), grown - 2.0, np.nan))


tables = st.integers(0, 10**6).map(table)


def _size(low: float = 0.05, high: float = 20.0):
    return st.floats(low, high, allow_subnormal=False)


@st.composite
def controllers(draw):
    """One of every kind, with constants over more than two decades."""
    k = draw(_size())
    more = k * draw(st.floats(1.0, 10.0))
    gains = draw(st.lists(st.floats(k, more), min_size=1, max_size=5))
    made = (
        lambda: constant_gain(k),
        lambda: lead_lag(k, draw(_size()), draw(_size())),
        lambda: leaky_pi(k, draw(_size()), draw(_size())),
        lambda: saturating_gain(k, more, draw(_size())),
        lambda: scheduled_gain(k, more, lambda sample: gains[sample % len(gains)]),
    )
    return draw(st.sampled_from(made))()


@st.composite
def signals(draw, rows: int = 1, most: int = 60):
    """Rough and smooth signals of one length, (rows, n)."""
    n, rng = draw(st.integers(5, most)), np.random.default_rng(draw(st.integers(0, 10**6)))
    t = np.arange(n)
    kinds = (
        lambda: rng.normal(0, 3, n),
        lambda: np.cumsum(rng.normal(0, 1, n)),
        lambda: 5 * np.sin(t * rng.uniform(0.05, 1.0)),
        lambda: 8.0 * (rng.random(n) < 0.1),
        lambda: np.zeros(n),
    )
    return np.array([draw(st.sampled_from(kinds))() for _ in range(rows)])
