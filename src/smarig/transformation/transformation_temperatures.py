"""Transformation temperatures of runs by the tangent method, with their dependence on stress and their drift."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.core import NotebookDisplay, UsageError
from smarig.identification import Estimate
from smarig.record import Run, load_run
from smarig.transformation.cycle_drift import cycle_drift
from smarig.transformation.cycle_figures import DIFFERENCES, FIGURES, TEMPERATURES
from smarig.transformation.figures_json import run_json
from smarig.transformation.figures_text import result_text
from smarig.transformation.run_figures import RunFigures, run_figures
from smarig.transformation.stress_dependence import (
    LoadSlope,
    StressSlope,
    load_dependence,
    stress_dependence,
)
from smarig.transformation.tangent_ranges import stated_ranges

_SAME_STRESS = 0.1  # of the larger: runs within it were made at one stress


@dataclass(frozen=True, eq=False)
class TransformationResult(NotebookDisplay):
    """The result of ``transformation_temperatures``.

    ``runs`` in order of their start, where it is known. ``stress`` has a slope for each temperature if the runs were
    made at different stresses, ``load`` if at different loads and no stress is known. ``history`` is the drift per
    cycle over all cycles of several runs of one wire at one stress, by figure.
    """

    runs: tuple[RunFigures, ...]
    stress: tuple[StressSlope, ...]
    load: tuple[LoadSlope, ...]
    history: dict[str, Estimate]

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return {
            "runs": [run_json(r) for r in self.runs],
            "stress": [s.to_json() for s in self.stress],
            "load": [s.to_json() for s in self.load],
            "history": {name: e.to_json() for name, e in self.history.items()},
            "ranges": stated_ranges(),
        }

    def __str__(self) -> str:
        return result_text(self.runs, self.stress, self.load, self.history)


def transformation_temperatures(
    runs: Run | str | Path | Sequence[Run | str | Path],
) -> TransformationResult:
    """A_s, A_f, M_s, M_f, stroke, residual, span and width of runs (or paths) with a temperature as hysteresis input.

    Only full branches are used: from one end of the run's temperature range to the other (ASTM E3097; the tangents are
    those of F2082). Each figure has a 95 % interval that contains the noise and the choice of the tangents' readings.
    A temperature whose plateau was not measured is missing, with the reason. Raises UsageError for a run without a
    full loop, without a temperature, or with a flat curve.
    """
    given = [runs] if isinstance(runs, Run | str | Path) else list(runs)
    if not given:
        raise UsageError("transformation_temperatures needs at least one run.")
    found = [run_figures(r if isinstance(r, Run) else load_run(r)) for r in given]
    if all(r.start_epoch is not None for r in found):
        found.sort(key=lambda r: r.start_epoch or 0.0)
    return TransformationResult(
        tuple(found), stress_dependence(found), load_dependence(found), _history(found)
    )


def _history(runs: Sequence[RunFigures]) -> dict[str, Estimate]:
    """The drift over the cycles of all runs, if they are several of one wire at one stress, with known starts."""
    one_wire = len({r.wire for r in runs}) == 1 and runs[0].wire
    one_stress = _is_the_same("stress", runs) and _is_the_same("load", runs)
    if len(runs) < 2 or not one_wire or not one_stress or any(r.start_epoch is None for r in runs):
        return {}
    if len({(r.record.input_unit, r.record.unit) for r in runs}) > 1:
        return {}
    figures = [c.figures for r in runs for c in r.cycles]
    units = {n: "K" if n in (*TEMPERATURES, *DIFFERENCES) else runs[0].record.unit for n in FIGURES}
    return cycle_drift(range(1, len(figures) + 1), figures, units)[0]


def _is_the_same(condition: str, runs: Sequence[RunFigures]) -> bool:
    """Whether all runs state about the same value of a condition, or none of them states it."""
    means, units = zip(*(r.mean_of(condition) for r in runs))
    known = [m for m in means if m is not None]
    if len(known) < len(runs) or len(set(units)) > 1:
        return not known
    return max(known) - min(known) <= _SAME_STRESS * max(map(abs, known))
