"""Everything a characterisation page is made of, in one frozen bundle. Knows no figure."""

from collections.abc import Mapping
from dataclasses import dataclass

from smarig.identification.calibrate import Calibration
from smarig.identification.identify import Identification
from smarig.identification.representation import Representation
from smarig.identification.verify import Verification
from smarig.record import Run


@dataclass(frozen=True)
class Evidence:
    """Runs by name in their order, and what was made of them; ``chosen`` names the surface that is used."""

    title: str
    runs: Mapping[str, Run]
    representation: tuple[Representation, ...]
    identifications: Mapping[str, Identification]
    chosen: str
    verifications: Mapping[str, Verification]
    calibration: Calibration | None
    discoveries: tuple[str, ...]
    warnings: tuple[str, ...]
    command: str
    seconds: float

    @property
    def best(self) -> Identification:
        """The identification that is used."""
        return self.identifications[self.chosen]

    @property
    def twin(self) -> bool:
        """Whether any of it is simulated."""
        return any(run.meta.get("source") != "bench" and not _imported(run) for run in self.runs.values())


def _imported(run: Run) -> bool:
    return run.meta.get("source") == "import"
