"""A hysteresis of every kind, and the operator on it after a history."""

import numpy as np
from hypothesis import strategies as st

from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach


def table() -> FodTable:
    nodes = np.linspace(-185.0, 185.0, 12)
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    return FodTable.from_arrays(nodes, nodes, np.where(b <= a, thesis_surface("two_p").y(a, b), np.nan))


def measure(low: int, high: int, seed: int) -> RelayMeasure:
    """Signed masses, some relays degenerate (α = β), thresholds on whole numbers so that inputs meet them."""
    rng = np.random.default_rng(seed)
    pair = np.sort(5.0 * rng.integers(low // 5, high // 5 + 1, (300, 2)), axis=1)
    pair[:20, 1] = pair[:20, 0]
    mass = rng.normal(0, 0.1, 300)
    return RelayMeasure.from_arrays([*pair[:, 1], high], [*pair[:, 0], low], [*mass, 1.0])


SYSTEMS: dict[str, Everett] = {
    "surface": thesis_surface("two_e"),
    "surface on one side": thesis_surface("one_p"),
    "table": table(),
    "measure": measure(-185, 185, 3),
    "measure on one side": measure(0, 170, 4),
    "measure, more below": measure(-185, 60, 5),
    "mirror": Mirrored(thesis_surface("one_e")),
}
inputs = st.one_of(st.integers(-38, 38).map(lambda k: 5.0 * k), st.floats(-190, 190, width=32))
histories = st.lists(inputs, max_size=10)
initials = st.one_of(st.sampled_from(["negative", "positive"]), st.integers(-34, 34).map(lambda k: 5.0 * k))


def operator_after(name: str, initial, moves) -> Preisach:
    op = Preisach(SYSTEMS[name])
    if isinstance(initial, str):
        op.reset(initial)
    else:
        op.go_to_diagonal(initial)
    for u in moves:
        op.step(u)
    return op
