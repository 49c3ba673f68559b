"""Suspects: what the import of runs found, with the effect that would leave such a trace."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from smarig.record import FindingKind, Run

MATCHES: dict[FindingKind, str] = {
    "leading output": "input_lag",
    "open loop": "ratcheting",
    "varying condition": "stress_shift",
}
# A model takes noise for reversals, and the others were mended: no effect looks so.
NO_SUSPECTS: frozenset[FindingKind] = frozenset(
    {
        "noisy input",
        "impossible readings",
        "frozen readings",
        "clipped output",
        "disagreeing sensors",
        "restarted clock",
        "other starting state",
    }
)


@dataclass(frozen=True)
class Suspect:
    """A finding of the import of a run, and the ``effect`` that it would match (None: a fault of the record)."""

    run: str
    finding: str
    effect: str | None

    def to_json(self) -> dict[str, str | None]:
        """Plain values."""
        return {"run": self.run, "finding": self.finding, "effect": self.effect}

    def text(self, not_testable: Collection[str] = ()) -> str:
        """One line; ``not_testable`` are effects that the diagnosed data cannot show."""
        hidden = ", which these data cannot show" if self.effect in not_testable else ""
        effect = f" It would match {self.effect}{hidden}." if self.effect else ""
        return f"The import of {self.run} found: {self.finding}{effect}"


def suspect_lines(
    found: Sequence[Suspect], not_testable: Collection[str] = (), named: Collection[str] = ()
) -> list[str]:
    """One line for each finding that no ``named`` effect explains, with all runs in which it was found."""
    lines: dict[str, list[Suspect]] = {}
    for suspect in found:
        if suspect.effect not in named:
            lines.setdefault(suspect.finding, []).append(suspect)
    return [
        replace(same[0], run=" and ".join(dict.fromkeys(s.run for s in same))).text(not_testable)
        for same in lines.values()
    ]


def suspects(runs: Sequence[Run]) -> list[Suspect]:
    """The suspicious findings that runs keep from their import; what was repaired has lost its kind."""
    return [
        Suspect(run.name, f.text, MATCHES.get(f.kind))
        for run in runs
        for f in run.info.import_findings
        if f.kind and f.kind not in NO_SUSPECTS
    ]
