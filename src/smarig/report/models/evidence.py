"""The record of evidence of a characterisation, from which its page is made, and the run of its model."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from smarig.diagnosis import CommandedDiagnosis
from smarig.identification import (
    Calibration,
    ExtensionChoice,
    Identification,
    Representation,
    SurfaceChoice,
    Verification,
)
from smarig.record import Run


@dataclass(frozen=True)
class ExtensionEvidence:
    """The extensions of §3.5 on all runs that are not held out, and the held-out errors without and with the best one.

    ``extended`` is None if none predicts runs left out better.
    """

    choice: ExtensionChoice
    classical: Verification
    extended: Verification | None


@dataclass(frozen=True)
class Evidence:
    """Runs by name in the order of execution, and the conclusions from them.

    ``identifications`` and ``verifications`` (on held-out runs) are keyed by surface name. ``chosen`` is the surface
    in the model file. ``choice`` holds the errors of all kinds on held-out curves (None: too few curves). ``diagnosis``
    is that of the chosen model (None: not made). ``extension`` is there only if a test of §5.3 or the diagnosis speaks
    against a Preisach operator. ``discoveries`` and ``warnings`` are sentences; ``seconds`` is
    computing time.
    """

    title: str
    runs: Mapping[str, Run]
    representation: tuple[Representation, ...]
    identifications: Mapping[str, Identification]
    chosen: str
    verifications: Mapping[str, Verification]
    discoveries: tuple[str, ...]
    warnings: tuple[str, ...]
    command: str
    seconds: float
    calibration: Calibration | None = None
    choice: SurfaceChoice | None = None
    diagnosis: CommandedDiagnosis | None = None
    extension: ExtensionEvidence | None = None

    @property
    def best(self) -> Identification | None:
        """The identification in the model file; None if no model was identified."""
        return self.identifications.get(self.chosen)

    def of(self, *protocols: str) -> tuple[Run, ...]:
        """The runs of the given protocols, in order."""
        return tuple(run for run in self.runs.values() if run.info.protocol in protocols)


def training_run(e: Evidence) -> Run | None:
    """The run that contributed most to the chosen model."""
    if e.best is None:
        return None
    names = {p.run for p in e.best.model.provenance}
    made_from = [r for r in e.runs.values() if r.path.name in names or str(r.path) in names]
    return max(made_from or e.of("first_order_descending", "first_order_ascending"), key=len, default=None)


def stroke_run(e: Evidence) -> Run | None:
    """The run whose settled outputs show the stroke: that of the model, which begins saturated; else the widest.

    A run that begins elsewhere contains a play that is taken up once, and a part of a drift.
    """
    runs = [run for run in e.runs.values() if len(run.settled) >= 2]
    fitted = training_run(e)
    return next((run for run in runs if run is fitted), max(runs, key=settled_range, default=None))


def settled_range(run: Run) -> float:
    """The range of the settled outputs of a run."""
    return float(np.ptp(run.points()[1]))


def stroke_text(stroke: float) -> str:
    """Three digits, zeros too: a stroke of 12.0 is not one of 12.

    >>> stroke_text(12.04), stroke_text(300.0)
    ('12.0', '300')
    """
    return f"{stroke:#.3g}".rstrip(".")
