"""A_s, A_f, M_s, M_f of the runs of a study and their dependence on stress, or the reason why there are none."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import UsageError
from smarig.diagnosis import Finding
from smarig.record import Run
from smarig.study.input_correction import corrected_run, correction_sentence
from smarig.transformation import (
    TEMPERATURES,
    LoadSlope,
    RunFigures,
    TransformationResult,
    transformation_temperatures,
    value_text,
)

_MOST = 8  # runs in a text


@dataclass(frozen=True, eq=False)
class Transformation:
    """The transformation temperatures of the runs that have a full loop; ``left_out`` has the reasons of the others.

    ``result`` is None if no run has a full loop. ``corrected_for`` is the lag or the drift of the thermometer for which
    the temperatures are corrected, None if none was named.
    """

    result: TransformationResult | None
    left_out: dict[str, str]
    corrected_for: Finding | None = None

    @property
    def correction(self) -> str:
        """What the temperatures are corrected for, a sentence; "" if they are those of the record."""
        return correction_sentence(self.corrected_for) if self.corrected_for and self.result else ""

    @property
    def slopes(self) -> list[tuple[str, float, tuple[float | None, float | None]]]:
        """Temperature, MPa per K and its interval, where the runs determine it."""
        found = self.result.stress if self.result else ()
        return [
            (s.temperature, s.C_MPa_per_K, s.C_ci95_MPa_per_K) for s in found if s.C_MPa_per_K is not None
        ]

    @property
    def load_slopes(self) -> list[LoadSlope]:
        """The slopes over the load where no stress is known and the runs determine them."""
        return [s for s in self.result.load if s.is_determined] if self.result else []

    @property
    def runs(self) -> Sequence[RunFigures]:
        """The figures of all runs that have a full loop."""
        return self.result.runs if self.result else ()

    def of(self, run: Run | None) -> RunFigures | None:
        """The figures of a run, None if it has no full loop."""
        return next((f for f in self.runs if run is not None and f.run.path == run.path), None)

    def lines(self) -> list[str]:
        """The temperatures of each run and their dependence on stress as text, or why there are none."""
        runs = self.runs
        found = [
            f"{run.name}: {', '.join(f'{n} {value_text(run, n)}' for n in TEMPERATURES if n in run.means)}."
            for run in runs[:_MOST]
        ]
        found += [f"{len(runs) - _MOST} more runs are on the page."] if len(runs) > _MOST else []
        found += [f"{run.name}: {note}" for run in runs[:_MOST] for note in run.notes]
        found += [self.correction] if self.correction else []
        found += [
            f"{name} rises by 1 K per {value:.3g} MPa ({low:.3g} to {high:.3g})."
            for name, value, (low, high) in self.slopes
            if low is not None and high is not None
        ]
        found += [
            f"{s.temperature} rises by {s.K_per_unit:.3g} K per {s.unit} of load ({low:.3g} to {high:.3g})."
            for s in self.load_slopes
            for low, high in (s.ci95,)
        ]
        return found or [f"No transformation temperatures: {next(iter(self.left_out.values()))}"]

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {
            "temperatures": self.result and self.result.to_json(),
            "left_out": self.left_out,
            "corrected_for": self.corrected_for and self.corrected_for.to_json(),
        }


def transformation_of(runs: Sequence[Run], found: Finding | None = None) -> Transformation | None:
    """The transformation temperatures of runs, corrected for what was ``found`` of their thermometer.

    None if their input is no temperature, or if they have no output.
    """
    hot = [run for run in runs if run.input_unit in ("K", "degC") and run.has("position")]
    if not hot:
        return None
    hot = [corrected_run(run, found) for run in hot] if found else hot
    left_out: dict[str, str] = {}
    usable = []
    for run in hot:
        try:
            transformation_temperatures(run)
            usable.append(run)
        except UsageError as error:
            left_out[run.name] = f"{error} {correction_sentence(found)}" if found else str(error)
    return Transformation(transformation_temperatures(usable) if usable else None, left_out, found)
