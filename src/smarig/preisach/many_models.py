"""Outputs of many hystereses along one input: draws of a posterior, resampled fits, strengths of an effect."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from smarig.core import Array, UsageError
from smarig.preisach import compiled as fast
from smarig.preisach.checked_input import input_array
from smarig.preisach.compiled_loop import bucketed
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.operator import Initial, Preisach


def simulate_models(
    hystereses: Sequence[Everett],
    u: ArrayLike,
    initial: Initial = "negative",
    *,
    compiled: bool | None = None,
) -> Array:
    """Outputs (n_models, n_samples) of hystereses for inputs u (n_samples,), each from the initial state.

    The numbers are those of ``Preisach(h).simulate(u, initial)``. Tables on the same nodes, from saturation, run in one
    compiled loop, in threads where that takes less time; ``compiled`` as in ``Preisach``.

    >>> from smarig.preisach import thesis_surface
    >>> simulate_models([thesis_surface("one_c"), thesis_surface("one_e")], [80.0, 40.0, 60.0]).shape
    (2, 3)
    """
    inputs = input_array(u)
    tables = _tables(hystereses) if initial in ("negative", "positive") else ()
    samples = len(hystereses) * inputs.size
    if tables and inputs.size and fast.worth_compiling(tables[0].keyed, samples, compiled):
        return _along_tables(tables, inputs, positive=initial == "positive")
    y = np.empty((len(hystereses), inputs.size))
    for outputs, hysteresis in zip(y, hystereses):
        outputs[:] = Preisach(hysteresis, compiled=compiled, samples=samples).simulate(inputs, initial)
    return y


def _tables(hystereses: Sequence[Everett]) -> tuple[FodTable, ...]:
    """The hystereses, if all are tables on the same nodes; else ()."""
    if not hystereses:
        raise UsageError("simulate_models needs at least one hysteresis.")
    first = hystereses[0]
    tables = tuple(h for h in hystereses if type(h) is FodTable)
    if not isinstance(first, FodTable) or len(tables) < len(hystereses):
        return ()
    return tables if all(np.array_equal(h.nodes, first.nodes) for h in tables) else ()


def _along_tables(tables: Sequence[FodTable], inputs: Array, *, positive: bool) -> Array:
    first, y = tables[0], np.empty((len(tables), inputs.size))
    keyed = first.keyed
    assert keyed.compiled_keys is not None  # noqa: S101 - that of a table
    run = fast.compiled_tables(keyed.between, keyed.compiled_keys)
    nodes, inner, _, width = keyed.params
    params = np.array(nodes), bucketed(np.array(inner, float), "right"), width
    now, (key, _) = (first.upper if positive else first.lower), keyed.place(keyed.params, first.lower)
    base = np.array([h.y_lower for h in tables])
    out = np.array([Preisach(h, "positive").y for h in tables]) if positive else base

    def follow(models: slice) -> None:
        drops = np.stack([h.drops.ravel() for h in tables[models]])
        ends = first.lower, first.upper, float(key), base[models], now, out[models]
        run(params, drops, inputs, *ends, y[models])

    fast.in_threads(follow, len(tables), inputs.size)
    return y
