"""Everything a characterisation found, in one value: what its page is made of. Computes nothing."""

from collections.abc import Mapping
from dataclasses import dataclass

from smarig.diagnosis import Diagnosis
from smarig.identification import Calibration, Identification, Representation, SurfaceChoice, Verification
from smarig.record import Run


@dataclass(frozen=True)
class Evidence:
    """Runs by name in the order they were made, and what was concluded from them.

    ``identifications`` and ``verifications`` (on held-out runs) are by surface name, ``chosen`` is the one
    the model file holds, ``choice`` how the kinds predict held-out curves (None: too few to hold any out).
    ``diagnosis`` judges the chosen model (None: there was nothing to judge). ``discoveries`` and ``warnings``
    are plain sentences; ``seconds`` is computing time.
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
    diagnosis: Diagnosis | None = None

    @property
    def best(self) -> Identification | None:
        """The identification the model file holds; None when nothing could be identified."""
        return self.identifications.get(self.chosen)

    def of(self, *protocols: str) -> tuple[Run, ...]:
        """The runs of some protocols, in order."""
        return tuple(run for run in self.runs.values() if run.info.protocol in protocols)
