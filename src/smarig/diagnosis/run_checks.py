"""Checks that runs can be compared with a model: one wire, one unit, a valid clock and plausible readings."""

from collections.abc import Iterable, Sequence

import numpy as np

from smarig.core import DataError, UsageError
from smarig.record import Run, Step, check_no_copies, same_readings
from smarig.replay import Model, check_output, file_hash

MAX_DURATION_S = 3.2e8  # ten years
MAX_READING = 1e9  # a position in any unit, a current, a target
LEAST_ALPHA = 0.005  # null data say nothing of rarer alarms
MAX_NULL_DATA_SETS = 100_000  # a larger number is a typing error
ROOM_DEGC = (-273.15, 1000.0)  # absolute zero, and what no rig survives
COLUMNS = ("current_command_A", "current_A", "voltage_V", "position", "input")


def check_comparable(model: Model, runs: Sequence[Run]) -> None:
    """Raise DataError if the runs cannot be compared with the model."""
    for run in runs:
        check_output(model, run)
        _readings(run)
        if run.has("t_s"):
            _clock(run)
            _steps(run)
    wires = {run.info.wire: run for run in runs if run.info.wire}
    if len(wires) > 1:
        listing = ", ".join(f"{run.path.name} of '{wire}'" for wire, run in wires.items())
        raise DataError(f"A diagnosis needs runs of one wire, but these are of several: {listing}.")


def check_held_out(train: Sequence[Run], held_out: Sequence[Run]) -> None:
    """Raise UsageError without training runs, or if one is given twice, or is held out, and not only a part of it."""
    if not train:
        raise UsageError("A diagnosis needs at least one training run.")
    check_no_copies(train)
    for a in train:
        for b in held_out:
            copied = file_hash(a) == file_hash(b) != "" and np.array_equal(a["tick"], b["tick"])
            if copied or same_readings(a, b):
                raise UsageError(
                    "A held-out run is a copy of a training run. Hold out a run that is not used for training."
                )


def check_left_out(without: Sequence[str], known: Iterable[str]) -> None:
    """Raise UsageError for a name that is not an effect of the catalogue."""
    for name in without:
        if name not in known:
            raise UsageError(f"Effect '{name}' cannot be left out: the catalogue has no such effect.")


def check_settings(alpha: float, nulls: int, seed: int) -> None:
    """Raise UsageError for a false alarm probability, a number of null data sets or a seed that cannot be used."""
    if not LEAST_ALPHA <= alpha < 0.5:
        raise UsageError(
            f"The false alarm probability must lie between {LEAST_ALPHA:g} and 0.5, but is {alpha:g}."
        )
    if seed < 0:
        raise UsageError(f"Seed {seed} is negative. Give a whole number ≥ 0.")
    if nulls > MAX_NULL_DATA_SETS:
        raise UsageError(f"{nulls} null data sets are too many. Use at most {MAX_NULL_DATA_SETS}.")
    if nulls < 1 / alpha:
        raise UsageError(
            f"{nulls} null data sets cannot resolve a probability of {alpha:g}. Use at least {int(1 / alpha) + 1}."
        )


def _readings(run: Run) -> None:
    for name in COLUMNS:
        x = run[name]
        absurd = int(np.sum(np.abs(x[~np.isnan(x)]) > MAX_READING))
        if absurd:
            raise DataError(f"{run.path}: {absurd} values of {name} are larger than any rig can measure.")
    room = run["ambient_degC"]
    absurd = int(np.sum((room < ROOM_DEGC[0]) | (room > ROOM_DEGC[1])))
    if absurd:
        raise DataError(
            f"{run.path}: {absurd} values of ambient_degC are no room temperatures. Check the unit."
        )


def _clock(run: Run) -> None:
    t = run["t_s"]
    if not np.all(np.isfinite(t)) or np.any(np.diff(t) < 0) or (t.size > 1 and t[-1] <= t[0]):
        raise DataError(f"{run.path}: the clock t_s is not increasing.")
    if t[-1] - t[0] > MAX_DURATION_S:
        raise DataError(
            f"{run.path} lasts {(t[-1] - t[0]) / 3.156e7:.3g} years according to its clock t_s (in seconds). Check "
            "the unit."
        )


def _steps(run: Run) -> None:
    first, last = float(run["t_s"][0]), float(run["t_s"][-1])
    for step in run.settled:
        if not _within(step, first, last) or not 1 <= step.n <= MAX_READING:
            raise DataError(
                f"{run.path}: step {step.index} lies outside the times of the samples or has {step.n} samples."
            )
        if any(x is not None and not abs(x) <= MAX_READING for x in (step.position, step.target)):
            raise DataError(f"{run.path}: step {step.index} has an implausible target or position.")


def _within(step: Step, first: float, last: float) -> bool:
    """Whether a step lies within the run; its start may precede the first sample by one tick."""
    end = last if step.t_end_s is None else step.t_end_s
    before = 0.01 * (last - first) + 10.0
    return first - before <= step.t_start_s < end <= last + before
