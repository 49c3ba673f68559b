"""The result of a diagnosis of runs with settled steps: its verdict and the evidence for it."""

from dataclasses import dataclass, replace
from typing import Any

from smarig.core import NotebookDisplay
from smarig.diagnosis.critique.critique import Critique
from smarig.diagnosis.critique.visibility import VisibilityTable
from smarig.diagnosis.diagnosis_json import diagnosis_json, effects_json
from smarig.diagnosis.diagnosis_text import text_lines
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict
from smarig.diagnosis.drive_statistics import MIN_COUNT_SD
from smarig.diagnosis.explain.discrepancy import Discrepancy
from smarig.diagnosis.explain.learned_term_fit import LearnedTermFit
from smarig.diagnosis.explain.parameter_fit import ParameterFit
from smarig.diagnosis.explain.search import NearestEffect, SearchLevel
from smarig.diagnosis.explain.separate_evidence import SeparateEvidence
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.noise_terms import POINT_NOISE
from smarig.replay import Model, PlantModel, Timeline


@dataclass(frozen=True, eq=False)
class ErrorSummary:
    """Rms errors of the training runs' settled points: given, base and extended model, and the noise of one."""

    unit: str
    noise_floor: float
    original: float
    base: float
    extended: float


@dataclass(frozen=True, eq=False)
class Diagnosis(NotebookDisplay):
    """The verdict of a diagnosis, with its evidence.

    ``base`` is the plant model without effects, with its density identified again; the gain is counted against it.
    ``reason`` says why an effect is not named. ``discrepancy`` is the flexible dependence that explains most without
    effects, ``remaining`` the same with the best effects.
    ``learned`` is a law in place of effects, if none is named; if there is none, ``learned_reason`` is a clause on
    why. ``nearest`` is the effect that nearly gains enough for a name, if there are no explanations.
    ``separate`` is the evidence of each effect of the best explanation, if the operator fails.
    ``model`` is the extended model if effects were found or a law was learned, else the given one. ``gain`` is
    None without held-out runs. ``numerics`` is the error of the diagnosis's own time steps at settled points.
    ``separating_run`` is the proposal of ``smarig.app.proposal``, if it was requested.
    """

    verdict: DiagnosisVerdict
    reason: str
    discrepancy: Discrepancy
    remaining: Discrepancy | None
    timeline: Timeline
    first: Critique
    levels: tuple[SearchLevel, ...]
    base: PlantModel
    visibility: VisibilityTable
    error: ErrorSummary
    gain: HeldOutGain | None
    model: Model
    numerics: float
    alpha: float
    nulls: int
    seconds: float
    separate: tuple[SeparateEvidence, ...] = ()
    learned: LearnedTermFit | None = None
    learned_reason: str = ""
    separating_run: dict[str, Any] | None = None
    nearest: NearestEffect | None = None

    @property
    def best(self) -> ParameterFit | None:
        """The best explanation, or None if the verdict has none; a strength with a phase is positive."""
        has_explanation = self.verdict.word in ("named", "ambiguous") or self.verdict.explanations
        if not (self.levels and has_explanation):
            return None
        found = self.levels[-1].best
        return replace(found, effects=tuple(e.with_positive_strength for e in found.effects))

    @property
    def noise_is_least_assumed(self) -> bool:
        """Whether the noise of a reading is the least that a fit assumes, so that it may be smaller."""
        last = self.levels[-1].critique if self.levels else self.first
        return last.refitted.noise.settled <= 1.001 * MIN_COUNT_SD * abs(self.base.per_count)

    @property
    def point_noise_text(self) -> str:
        """The noise of a settled point, in the unit of the errors: "at most" where it is the least that is assumed."""
        return (
            f"{POINT_NOISE} {'at most ' if self.noise_is_least_assumed else ''}{self.error.noise_floor:.2g}"
        )

    @property
    def refused(self) -> tuple[str, ...]:
        """The effects of the best explanation that only stand in for what the model lacks."""
        best, compatible = self.best, self.verdict.compatible
        if best is None or compatible is None:
            return ()
        return tuple(e.kind.name for e in best.effects if e.kind.name not in compatible)

    @property
    def left(self) -> str | None:
        """The variable or effect on which the remaining residuals depend; None if nothing stands out."""
        last = self.levels[-1].critique if self.levels and self.extended and not self.learned else None
        if last is None or last.silent:
            return None
        plain = last.best(1, generic=True)
        return plain[0].candidate.depends_on if plain else last.largest.candidate.name

    @property
    def extended(self) -> bool:
        """Whether ``model`` is an extended one."""
        return self.verdict.word in ("named", "ambiguous") or self.learned is not None

    def lines(self) -> list[str]:
        """The findings, one or two sentences each; the verdict first."""
        return list(text_lines(self))

    def text(self) -> str:
        """The findings as text."""
        return "\n".join(self.lines())

    def effects(self) -> list[dict[str, Any]]:
        """The effects of the best explanation: name, score, parameters with 95 % intervals."""
        return effects_json(self)

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return diagnosis_json(self)

    @property
    def times_noise(self) -> float:
        """The base model's error at settled points, in units of all noise that remains with the best discrepancy."""
        return self.error.base / self.discrepancy.noise

    def __repr__(self) -> str:
        finding = (
            " + ".join(str(p) for p in self.best.effects) if self.best else self.verdict.depends_on or ""
        )
        return f"Diagnosis({self.verdict.word}{': ' if finding else ''}{finding})"
