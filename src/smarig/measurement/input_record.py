"""Runs with a measured input as plain arrays: input, output, clock, cycles and conditions of each row."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smarig.core import Array
from smarig.preisach import turning_points
from smarig.record import Run, continues_run

Integers = NDArray[np.int64]
CONTINUES_AT = "continues_at"  # of a part of an imported run: when that began, and its cycles so far
PART_OF = "part_of"  # of an imported run: the name of the record that was cut
ONE_RATE = 1.5  # ratio of two rates: less is one rate
REVERSAL_MARGIN = 1.2  # times the range that noise of this size has over all rows
DROPOUT_STEPS = 3.0  # times the usual step from row to row
DROPOUT_SHARE = 0.005  # of the input's range: a smaller jump is none that a memory would keep
REVERSAL_SHARE = 0.01  # of the input's range: a smaller reversal is noise, too


class Travel(NamedTuple):
    """The travel of an input so far, in ``full_cycles``, and its ``widest`` branch."""

    full_cycles: float
    widest: float


NO_TRAVEL = Travel(0.0, 0.0)


@dataclass(frozen=True, eq=False)
class InputRecord:
    """The rows (n,) of one run in which input ``u`` and output ``y`` are known, in the run's units.

    ``t`` is the time in s, or the row number without a clock. ``cycle`` is the number of cycles of the input before
    each row, continued over the runs of one list; ``travel`` is that of the input before this record. ``conditions``
    are the mean values recorded with the run, by name. ``began`` is the time at which the record began, or the one that
    it continues; ``whole`` is the name of that one. ``row`` are the rows of the run. ``dropouts`` rows were left out
    because the input reads exactly 0 there, far from the rows around them. ``continues``: the record starts in the
    final state of the one before it in its list. ``noise`` is the standard deviation of the input's noise, None if it
    must be estimated; ``rounding`` is that of the output's rounding. ``readings`` are the rows whose outputs are
    readings, None if all are. ``histories`` (n,) are conditions that change over the record.
    """

    name: str
    u: Array
    y: Array
    t: Array
    clock: bool
    cycle: Array
    conditions: Mapping[str, float]
    row: Integers
    initial: str | None = None
    dropouts: int = 0
    input_unit: str = ""
    continues: bool = False
    noise: float | None = None
    rounding: float = 0.0
    readings: Integers | None = None
    began: float | None = None
    whole: str = ""
    histories: Mapping[str, Array] = field(default_factory=dict)
    travel: Travel = NO_TRAVEL

    @cached_property
    def full_cycles(self) -> Array:
        """Full cycles (n,) by the travel of the input before each row (``full_cycles_before``)."""
        return full_cycles_before(self.u, self.travel)[0]

    def condition(self, name: str) -> Array:
        """The value of a condition at every row (n,). Raises KeyError if the record does not state it."""
        found = self.histories.get(name)
        return np.full(self.u.size, self.conditions[name]) if found is None else found

    def __len__(self) -> int:
        return self.u.size

    @property
    def elapsed(self) -> Array:
        """Time (n,) in s since the record began, or the one that it continues; rows without a clock."""
        return self.t - (self.t[0] if self.began is None else self.began)


def input_records(runs: Sequence[Run]) -> list[InputRecord]:
    """The records of runs in the given order; runs without a row are left out."""
    found: list[InputRecord] = []
    cycles, travelled = 0.0, NO_TRAVEL
    before: Run | None = None
    for run in runs:
        u, y = run["input"], run["position"]
        row = np.flatnonzero(np.isfinite(u) & np.isfinite(y))
        lost = dropouts(u[row])
        row = row[~lost]
        if row.size < 3:
            continue
        clock = run.has("t_s") and bool(np.all(np.isfinite(run["t_s"][row])))
        continues = before is not None and continues_run(before, run)
        began, earlier = _earlier(run, found[-1] if continues and found else None, clock=clock)
        cycle = (cycles or earlier) + cycles_before(u[row])
        cycles = float(cycle[-1])
        before_it = travelled if travelled != NO_TRAVEL else _travel_before(run)
        travelled = full_cycles_before(u[row], before_it)[1]
        found.append(
            InputRecord(
                name=run.name,
                u=u[row],
                y=y[row],
                t=run["t_s"][row] if clock else row.astype(float),
                clock=clock,
                cycle=cycle,
                conditions=recorded_means(run),
                row=row,
                initial=run.info.initial,
                dropouts=int(lost.sum()),
                input_unit=run.input_unit,
                continues=continues,
                began=began,
                whole=found[-1].whole if continues and found else _whole(run),
                rounding=rounding_sd(run),
                travel=before_it,
            )
        )
        before = run
    return found


def _whole(run: Run) -> str:
    """The name of the record of which a run is a part; its own if it is none."""
    stated = (run.meta.get("imported") or {}).get(PART_OF)
    return stated if isinstance(stated, str) else run.name


def _earlier(run: Run, before: InputRecord | None, *, clock: bool) -> tuple[float | None, float]:
    """When the record of a run began, and how many cycles were before it: a part of a run goes on from the rest."""
    if before is not None:
        return (before.began if before.began is not None else float(before.t[0])) if clock else None, 0.0
    stated = (run.meta.get("imported") or {}).get(CONTINUES_AT)
    if not isinstance(stated, Mapping):
        return None, 0.0
    began, cycles = (
        float(value) if isinstance(value, int | float) and np.isfinite(value) else None
        for value in (stated.get("began_s"), stated.get("cycles"))
    )
    known = clock and began is not None and began <= run["t_s"][0]
    return began if known else None, max(cycles or 0.0, 0.0)


def _travel_before(run: Run) -> Travel:
    """The travel before a part of a run, as the run states it."""
    stated = (run.meta.get("imported") or {}).get(CONTINUES_AT)
    values = [stated.get(name) for name in Travel._fields] if isinstance(stated, Mapping) else []
    known = [float(v) for v in values if isinstance(v, int | float) and np.isfinite(v) and v >= 0]
    return Travel(*known) if len(known) == len(Travel._fields) else NO_TRAVEL


def rounding_sd(run: Run) -> float:
    """The least standard deviation of a reading of a run: that of its rounding to the resolution, Δ/√12.

    0 without a resolution, and for means over the samples of a hold, which lie between its steps.
    """
    averaged = any(step.n > 1 for step in run.settled)
    return 0.0 if averaged else run.info.output.resolution / float(np.sqrt(12))


def dropouts(u: Array, code: float = 0.0) -> NDArray[np.bool_]:
    """The rows (n,) of an input that read exactly ``code`` while their neighbours do not come near it: an instrument
    that failed to answer.

    >>> dropouts(np.array([20.0, 21.0, 0.0, 0.0, 23.0, 24.0])).tolist()
    [False, False, True, True, False, False]
    """
    coded = u == code
    others = u[~coded]
    if not coded.any() or others.size < 3:
        return np.zeros(u.size, dtype=bool)
    typical = float(np.quantile(np.abs(np.diff(others)), 0.99))
    expected = np.interp(np.arange(u.size), np.flatnonzero(~coded), others)
    far = np.abs(expected - code) > max(DROPOUT_STEPS * typical, DROPOUT_SHARE * float(np.ptp(others)))
    return coded & far


def recorded_means(run: Run) -> dict[str, float]:
    """The means of the conditions that a run records, by name."""
    values = {k: v.get("mean") for k, v in run.info.conditions.items() if isinstance(v, Mapping)}
    return {k: float(v) for k, v in values.items() if isinstance(v, int | float) and np.isfinite(v)}


def input_noise_sd(u: Array) -> float:
    """Standard deviation of an input's noise from second differences, of the noisiest tenth (noise is intermittent).

    At least 1e-9 of the range.

    >>> float(round(input_noise_sd(np.linspace(0, 1, 50)), 12))
    1e-09
    """
    second_differences = np.abs(u[:-2] - 2 * u[1:-1] + u[2:])
    return float(np.quantile(second_differences, 0.9)) / 1.645 / np.sqrt(6.0) + 1e-9 * float(np.ptp(u))


def output_noise_sd(u: Array, y: Array) -> float:
    """Standard deviation of the noise of outputs y (n,) as ``input_noise_sd``, where the input u (n,) takes no step: of
    a staircase, or of weights that are put on, the second differences of y are those of its steps.

    >>> stairs = np.repeat([0.0, 50, 100, 50], 6)
    >>> bool(output_noise_sd(stairs, 20 * stairs) < 1e-5 < input_noise_sd(20 * stairs))
    True
    """
    bends, of_output = (np.abs(x[:-2] - 2 * x[1:-1] + x[2:]) for x in (u, y))
    usual = float(np.median(bends)) / 0.6745  # the few steps hardly move the median
    smooth = bends <= noise_range(u, usual) / 2 + 1e-9 * float(np.ptp(u))
    return float(np.quantile(of_output[smooth], 0.9)) / 1.645 / np.sqrt(6.0) + 1e-9 * float(np.ptp(y))


def noise_range(u: Array, noise: float | None = None) -> float:
    """The range that the noise of an input (n,), a standard deviation, has over all its rows."""
    return 2 * float(np.sqrt(2 * np.log(u.size))) * (input_noise_sd(u) if noise is None else noise)


def reversals(u: Array, noise: float | None = None) -> list[int]:
    """The rows at which the input turns, with both ends; reversals within its noise (a standard deviation) do not
    count.
    """
    if u.size < 3 or np.ptp(u) == 0:
        return [0, u.size - 1]
    threshold = max(REVERSAL_MARGIN * noise_range(u, noise), REVERSAL_SHARE * float(np.ptp(u)))
    turns = turning_points(u, min(threshold, 0.3 * float(np.ptp(u))))
    return sorted({0, *turns, u.size - 1})


def hours_of_cycles(records: Sequence["InputRecord"], fewest: float) -> float | None:
    """Hours of the longest record if all have a clock and one has at least ``fewest`` cycles, else None."""
    if not all(r.clock for r in records) or max(float(r.cycle[-1] - r.cycle[0]) for r in records) < fewest:
        return None
    return max(float(np.ptp(r.t)) for r in records) / 3600


def monotone_branches(u: Array, turns: Sequence[int]) -> Array:
    """The input, monotone between its reversals by isotonic least squares: a hysteresis takes noise for reversals."""
    from scipy.optimize import isotonic_regression  # imported here: takes half a second

    found = u.copy()
    for a, b in pairwise(turns):
        found[a : b + 1] = isotonic_regression(u[a : b + 1], increasing=bool(u[b] > u[a])).x
    return found


def full_cycles_before(u: Array, before: Travel = NO_TRAVEL) -> tuple[Array, Travel]:
    """The travel of the input before each row (n,), over twice its widest branch so far; and that at the end.

    A minor loop counts by its size, as what a wire keeps of it.

    >>> full_cycles_before(np.array([0.0, 2.0, 1.0, 2.0, 0.0]))[0].tolist()
    [0.0, 0.5, 0.75, 1.0, 1.5]
    """
    count, (at, widest) = np.full(u.size, before.full_cycles), before
    for a, b in pairwise(reversals(u)):
        widest = max(widest, abs(float(u[b] - u[a])))
        count[a : b + 1] = at + np.abs(u[a : b + 1] - u[a]) / (2 * widest or 1.0)
        at = float(count[b])
    return count, Travel(at, widest)


def cycles_before(u: Array) -> Array:
    """Number of cycles before each row (n,): half of the branches so far, and the share of the present one.

    >>> cycles_before(np.array([0.0, 1.0, 2.0, 1.0, 0.0])).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    turns = reversals(u)
    count = np.zeros(u.size)
    for number, (a, b) in enumerate(pairwise(turns)):
        moved = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(u[a : b + 1])))])
        count[a : b + 1] = (number + moved / (moved[-1] or 1.0)) / 2
    return count
