"""Suspects: what the import of runs found, with the effect that would leave such a trace."""

from collections.abc import Sequence
from dataclasses import dataclass

from smarig.exchange import finding_kind
from smarig.record import Run

MATCHES = {
    "output leads its input": "input_lag",
    "loop does not close": "ratchet_strain",
    "condition not constant": "stress_shift",
}


@dataclass(frozen=True)
class Suspect:
    """A finding of the import of a run, and the ``effect`` that it would match (None: a fault of the record)."""

    run: str
    finding: str
    effect: str | None

    def to_json(self) -> dict[str, str | None]:
        """Plain values."""
        return {"run": self.run, "finding": self.finding, "effect": self.effect}

    @property
    def text(self) -> str:
        """One line."""
        effect = f" It would match {self.effect}." if self.effect else ""
        return f"The import of {self.run} found: {self.finding}{effect}"


def suspects(runs: Sequence[Run]) -> list[Suspect]:
    """The suspicious findings that runs keep from their import, except those that were repaired."""
    return [
        Suspect(run.name, sentence, MATCHES.get(kind))
        for run in runs
        for sentence in run.info.warnings
        if (kind := finding_kind(sentence)) and not any(r.startswith(kind) for r in run.info.repairs)
    ]
