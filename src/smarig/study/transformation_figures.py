"""A_s, A_f, M_s, M_f of the runs of a study and their dependence on stress, or the reason why there are none."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from smarig.core import UsageError
from smarig.record import Run
from smarig.transformation import RunFigures, TransformationResult, transformation_temperatures


@dataclass(frozen=True, eq=False)
class Transformation:
    """The transformation temperatures of the runs that have a full loop; ``left_out`` has the reasons of the others.

    ``result`` is None if no run has a full loop.
    """

    result: TransformationResult | None
    left_out: dict[str, str]

    @property
    def slopes(self) -> list[tuple[str, float, tuple[float | None, float | None]]]:
        """Temperature, MPa per K and its interval, where the runs determine it."""
        found = self.result.stress if self.result else ()
        return [
            (s.temperature, s.C_MPa_per_K, s.C_ci95_MPa_per_K) for s in found if s.C_MPa_per_K is not None
        ]

    def of(self, run: Run | None) -> RunFigures | None:
        """The figures of a run, None if it has no full loop."""
        own = self.result.runs if self.result else ()
        return next((f for f in own if run is not None and f.run.path == run.path), None)

    def to_json(self) -> dict[str, Any]:
        """As a JSON object."""
        return {"temperatures": self.result and self.result.to_json(), "left_out": self.left_out}


def transformation_of(runs: Sequence[Run]) -> Transformation | None:
    """The transformation temperatures of runs; None if their input is no temperature, or if they have no output."""
    hot = [run for run in runs if run.input_unit in ("K", "degC") and run.has("position")]
    if not hot:
        return None
    left_out: dict[str, str] = {}
    usable = []
    for run in hot:
        try:
            transformation_temperatures(run)
            usable.append(run)
        except UsageError as error:
            left_out[run.name] = str(error)
    return Transformation(transformation_temperatures(usable) if usable else None, left_out)
