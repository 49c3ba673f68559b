"""The record of evidence of a characterisation, from which its page is made."""

from collections.abc import Mapping
from dataclasses import dataclass

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
