"""The remembered extrema of each settled point, as indices of points of the record.

The output of a Preisach memory is a chain of moves u₋ → M₁ → m₁ → … → u. Each settled point gets the index of the
last remembered extremum before it (its origin), so that models can be linear in the data.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array, DataError
from smarig.record import Run
from smarig.replay import MemoryHistory, memory_histories

Places = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class ExtremumChains:
    """Inputs u (n,), outputs y (n,), origins (n,): index of the last remembered extremum, −1 for u₋.

    ``state`` (n,): points with the same number are repeats of one classical memory state. ``run`` (n,): index of
    the record.
    """

    u: Array
    y: Array
    origin: Places
    state: Places
    run: Places
    lower: float
    upper: float
    unit: str


def extremum_chains(runs: Sequence[Run]) -> ExtremumChains:
    """Settled points of runs that start in negative saturation; DataError with the run that does not."""
    lower, upper, records = memory_histories(runs)
    origins: list[int] = []
    names: list[int] = []
    which: list[int] = []
    seen: dict[tuple, int] = {}
    for number, (run, record) in enumerate(zip(runs, records, strict=True)):
        if any(s is None or s.diagonal or s.extrema[0] != lower for s in record.states):
            raise DataError(
                f"{run.path} has points whose memory does not go back to negative saturation. "
                "Start the run there, or choose points after its first saturation."
            )
        start = len(origins)
        origins += [k + start if k >= 0 else -1 for k in _origins(record)]
        names += [seen.setdefault((s.extrema, s.u), len(seen)) for s in record.states if s]
        which += [number] * len(record.states)
    return ExtremumChains(
        u=np.concatenate([r.inputs for r in records]),
        y=np.concatenate([r.outputs for r in records]),
        origin=np.array(origins, dtype=np.intp),
        state=np.array(names, dtype=np.intp),
        run=np.array(which, dtype=np.intp),
        lower=lower,
        upper=upper,
        unit=runs[0].unit,
    )


def _origins(record: MemoryHistory) -> list[int]:
    """Index of the point of the last remembered extremum, −1 for the start."""
    stack: list[int] = [-1]
    found = []
    depth = 1
    for k, state in enumerate(record.states):
        now = len(state.extrema) if state else 1
        if now > depth:  # a turning point: the previous point is the new extremum
            stack.append(k - 1)
        del stack[now:]
        depth = now
        found.append(stack[-1])
    return found


def first_order(record: ExtremumChains) -> NDArray[np.bool_]:
    """Points on the ascending branch or on a first-order descending curve."""
    return (record.origin < 0) | (np.append(record.origin, -1)[record.origin] < 0)


def excursions(record: ExtremumChains) -> NDArray[np.intp]:
    """The index of the segment between two visits of negative saturation, by point."""
    return np.cumsum((record.u <= record.lower) | (np.diff(record.run, prepend=-1) != 0))
