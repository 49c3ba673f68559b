"""Rig time saved by choosing the points: ``adaptive_fod`` against the thesis's fixed partition, on the twin.

The ten random truths lie outside every surface family (``random_truths``). The encoder has the noise of the
rig's file, and holds settle by the same rule. Both runs are fitted by ``positive``. The error is the rms of
y(α, β) over a dense triangle against the truth. The time is that of the twin's clock.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.random_truths import random_truth
from smarig.identification import Observations, fit_positive, informed_choice
from smarig.preisach import FodTable
from smarig.protocols import Chooser, halving
from smarig.record import Run, load_run
from smarig.rig import TwinSettings
from smarig.runner import Preview, Session

RIG = "one_wire_twin"
TRUTHS = 10
TARGET_SHARE = 0.60
_GRID = 61  # inputs of the grid for the error
_EVERY = 2  # holds between two evaluations of the adaptive run
_FIRST = 16  # holds before the first evaluation


@dataclass(frozen=True)
class ErrorTrace:
    """Validation error (k,) in the rig's unit at k evaluations of a run, and the twin's time (k,) at each."""

    hours: tuple[float, ...]
    rms: tuple[float, ...]

    def first_h(self, rms: float) -> float | None:
        """Time at which the error is first at or below ``rms``; None if it never is."""
        return next((hours for hours, error in zip(self.hours, self.rms) if error <= rms), None)

    def stays_h(self, rms: float) -> float | None:
        """Time from which the error stays at or below ``rms``, the stricter measure; None if it does not."""
        above = [k for k, error in enumerate(self.rms) if error > rms]
        first = above[-1] + 1 if above else 0
        return self.hours[first] if first < len(self.hours) else None


def run(quick: bool = False) -> dict[str, Any]:
    """Share of the fixed partition's rig time after which the adaptive error is at or below the fixed one's.

    ``{"rig", "truths", "wanted", "median_share", "median_first_share", "median_uninformed_share", "reached",
    "results": [{"truth", "fixed_h", "fixed_rms", "share", "first_share", "uninformed_share",
    "rms_at_wanted", "predicted_over_true", "unit"}]}``. ``share``: the error stays below from there on;
    ``first_share``: it is below once. None if that is not reached within the fixed run's time; medians count
    this as more than 1 (and are None if the median itself is not reached). ``quick`` takes two truths.
    """
    seeds = range(2 if quick else TRUTHS)
    with TemporaryDirectory() as folder:
        results = [_compared(seed, Path(folder)) for seed in seeds]
    return {
        "rig": RIG,
        "truths": len(results),
        "wanted": TARGET_SHARE,
        "median_share": _median(results, "share"),
        "median_first_share": _median(results, "first_share"),
        "median_uninformed_share": _median(results, "uninformed_share"),
        "reached": sum(r["share"] is not None for r in results),
        "results": results,
    }


def _median(results: list[dict[str, Any]], key: str) -> float | None:
    middle = float(np.median([np.inf if r[key] is None else r[key] for r in results]))
    return middle if np.isfinite(middle) else None


def _compared(seed: int, folder: Path) -> dict[str, Any]:
    truth = random_truth(seed, RIG)
    fixed = _measured(truth, seed, folder / f"fixed_{seed}.run.sqlite", "first_order_descending", {})
    fixed_h, fixed_rms = _hours(fixed, len(fixed.steps)), _error(fixed, len(fixed.steps), truth)
    adaptive = _adaptive(truth, seed, folder / f"adaptive_{seed}.run.sqlite", informed_choice, fixed_h)
    uninformed = _adaptive(truth, seed, folder / f"uninformed_{seed}.run.sqlite", halving, fixed_h)
    trace = _trace(adaptive, truth)
    other = _trace(uninformed, truth)
    return {
        "truth": seed,
        "fixed_h": fixed_h,
        "fixed_rms": fixed_rms,
        "share": _share(trace.stays_h(fixed_rms), fixed_h),
        "first_share": _share(trace.first_h(fixed_rms), fixed_h),
        "uninformed_share": _share(other.stays_h(fixed_rms), fixed_h),
        "rms_at_wanted": float(np.interp(TARGET_SHARE * fixed_h, trace.hours, trace.rms)),
        "predicted_over_true": _predicted_over_true(adaptive, truth),
        "unit": fixed.unit,
    }


def _share(hours: float | None, of_h: float) -> float | None:
    return None if hours is None else hours / of_h


def _measured(
    truth: FodTable,
    seed: int,
    out: Path,
    protocol: str,
    settings: dict[str, Any],
    chooser: Chooser | None = None,
) -> Run:
    twin = TwinSettings(seed=seed, hysteresis=truth)
    no_preview = Preview(
        protocol=protocol,
        duration_s=0.0,
        steps=0,
        peak_current_A=0.0,
        peak_temperature_K=0.0,
        timed_out=0,
        bytes=0,
    )  # a twin needs no preview
    with Session(RIG, twin=twin, wire=f"{out.stem} of the benchmark") as session:
        return load_run(session.run(protocol, settings, out, expected=no_preview, chooser=chooser))


def _adaptive(truth: FodTable, seed: int, out: Path, chooser: Chooser, longest_h: float) -> Run:
    settings = {"target_share": 1e-9, "longest_h": longest_h}
    return _measured(truth, seed, out, "adaptive_fod", settings, chooser)


def _hours(run: Run, holds: int) -> float:
    """Rig time from the start of a run to the end of its first ``holds`` holds."""
    end = run.steps[holds - 1].t_end_s
    return (end or float("nan")) / 3600


def _error(run: Run, holds: int, truth: FodTable) -> float:
    """rms error over the triangle of the fit of ``positive`` to the first ``holds`` holds."""
    first_holds = replace(run, steps=run.steps[:holds])
    fit = fit_positive(Observations.of_runs([first_holds]))
    u = np.linspace(truth.lower, truth.upper, _GRID)
    high, low = np.tril_indices(_GRID)
    return float(np.sqrt(np.mean((fit.y(u[high], u[low]) - truth.y(u[high], u[low])) ** 2)))


def _trace(run: Run, truth: FodTable) -> ErrorTrace:
    looks = range(_FIRST, len(run.steps) + 1, _EVERY)
    return ErrorTrace(
        tuple(_hours(run, holds) for holds in looks), tuple(_error(run, holds, truth) for holds in looks)
    )


def _predicted_over_true(run: Run, truth: FodTable) -> float:
    """The error that the chooser predicted at its last choice, divided by the true error there."""
    predictions = [e.data for e in run.events if "predicted_share" in e.data]
    span = truth.everett(truth.upper, truth.lower)
    return span * predictions[-1]["predicted_share"] / _error(run, predictions[-1]["holds"], truth)
