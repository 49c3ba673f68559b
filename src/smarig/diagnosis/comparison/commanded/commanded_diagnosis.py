"""The diagnosis of runs with settled steps, as a value: verdict, causes, extended model, errors and noise."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from smarig.core import NotebookDisplay, root_mean_square
from smarig.diagnosis.comparison.commanded.commanded_json import commanded_json
from smarig.diagnosis.comparison.commanded.commanded_law import CommandedLaw
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem, FittedPlant
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.commanded_text import commanded_lines
from smarig.diagnosis.comparison.commanded.extension import Extension
from smarig.diagnosis.comparison.commanded.kernel_shapes import PLAIN, WALK
from smarig.diagnosis.comparison.compared_hypothesis import ComparedHypothesis, Part
from smarig.diagnosis.comparison.finding import Finding
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge
from smarig.diagnosis.comparison.probabilities import Probabilities, probabilities
from smarig.diagnosis.comparison.verdict_rules import RULES, SENTENCES, Verdict, VerdictEvidence
from smarig.diagnosis.comparison.weights import Weights
from smarig.diagnosis.diagnosed_model import diagnosed_model
from smarig.diagnosis.diagnosis_text import FAR_OFF_RATIO
from smarig.diagnosis.effects_to_try import effects_to_try
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.refit.joint_density import settled_rms
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.diagnosis.refit.zero_of_output import with_zero_of_runs
from smarig.plant import Effect, EffectType
from smarig.record import Run
from smarig.replay import Model, PlantModel, Timeline, numerics

Interval = tuple[float, float]


@dataclass(frozen=True)
class ErrorSummary:
    """Rms errors of the training runs' settled points: given, base and extended model, and the noise of one."""

    unit: str
    noise_floor: float
    original: float
    base: float
    extended: float


@dataclass(frozen=True, eq=False)
class CommandedDiagnosis(NotebookDisplay):
    """The verdict on a model and runs with settled steps, with the weighted hypotheses that it follows from.

    ``extension`` is the base model with effects, or with a law if the cause is unknown: of those that do not predict
    held-out runs worse, the one that predicts blocks left out best. ``extended``: whether there is one. ``gain`` are
    the errors on held-out runs, None if there are none. ``missing``: what the runs do not determine and the held-out
    runs need. ``train`` are the runs, ``original`` the given model.
    ``separating_run`` is the proposal of ``smarig.app.proposal``, if it was requested.
    """

    subject: CommandedProblem
    found: SearchedHypotheses
    weights: Weights
    evidence: VerdictEvidence
    verdict: Verdict
    extension: Extension
    extended: bool
    gain: HeldOutGain | None
    missing: MissingKnowledge | None
    original: Model
    train: tuple[Run, ...]
    seconds: float
    separating_run: dict[str, Any] | None = None

    @property
    def probabilities(self) -> Probabilities:
        """The probabilities that the verdict states."""
        return probabilities(self.verdict, self.evidence)

    @property
    def causes(self) -> Mapping[Part, float]:
        """The probability of each cause, likeliest first."""
        return self.probabilities.causes

    @property
    def reason(self) -> str:
        """Why the verdict is as it is, one sentence."""
        return SENTENCES[self.verdict.reason]

    @property
    def timeline(self) -> Timeline:
        """The training runs on one clock."""
        return self.subject.timeline

    @property
    def base(self) -> PlantModel:
        """The given model with the density identified from the runs."""
        return self.extension.base

    @property
    def extended_plant(self) -> PlantModel:
        """The model with effects or a law, or the base model if none is offered."""
        return self.extension.extended if self.extended else self.extension.base

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the extension's effects by "effect.parameter"."""
        return dict(self.extension.parameters)

    @property
    def intervals90(self) -> dict[str, Interval]:
        """The 90 % intervals of the parameters, by the choice of blocks."""
        return self.extension.intervals(0.90)

    @property
    def likely_effects(self) -> tuple[Effect, ...]:
        """The effects of the verdict with the values of the extension; a strength with a phase is positive.

        An effect that the extension has not has those of its heaviest hypothesis.
        """
        if self.verdict.word not in ("named", "ambiguous"):
            return ()
        fitted = {e.kind.name: e for e in self.extension.extended.catalogue_effects}
        kinds = {k.name: k for k in self.subject.catalogue}
        named = self.verdict.names if self.verdict.word == "named" else self.verdict.names[:1]
        effects = [fitted.get(n) or _of_hypothesis(kinds[n], self._heaviest_with(n)) for n in named]
        return tuple(e.with_positive_strength for e in effects)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """The effects of the verdict, the best only if it is ambiguous; none if it is unknown."""
        intervals = self.extension.intervals(0.95)
        return tuple(
            Finding(
                e.kind.name,
                self.causes.get(Part("effect", e.kind.name), 0.0),
                dict(_parameters(e, intervals, self.parameters)),
            )
            for e in self.likely_effects
        )

    def effects(self) -> list[dict[str, Any]]:
        """The findings as plain values: name, probability, parameters with 95 % intervals."""
        return [f.to_json() for f in self.findings]

    @cached_property
    def learned(self) -> CommandedLaw | None:
        """The law that the extended model has instead of effects."""
        law = next((e for e in self.extended_plant.catalogue_effects if e.kind.shape), None)
        if law is None:
            return None
        possible = effects_to_try(self.subject.given, self.timeline.runs[0])
        return CommandedLaw.of(law, self.found.hypotheses, self.extension.parts, possible)

    @property
    def not_identifiable(self) -> tuple[str, ...]:
        """The effects that these runs could not show at any strength."""
        shown = {s.part.name for s in self.found.screened if s.detectable}
        return tuple(k.name for k in self.subject.catalogue if k.name not in shown)

    @property
    def noise(self) -> NoiseEstimate:
        """What the readings scatter beside the extended model, or beside the base model if none is offered."""
        return self.fitted.refitted.noise

    @cached_property
    def scatter(self) -> float:
        """What noise gives to a settled position, with plausible fluctuations of the room: a standard deviation."""
        return self.subject.scatter(self.fitted)

    @cached_property
    def error(self) -> ErrorSummary:
        """The rms errors of the runs' settled points by the given, the base and the extended model."""
        timeline = self.timeline
        floor = root_mean_square(self.noise.white[: len(timeline.settled)])
        models = (self.subject.given, self.base, self.extended_plant)
        return ErrorSummary(timeline.unit, floor, *(settled_rms(timeline, m) for m in models))

    @property
    def given_is_far(self) -> bool:
        """Whether the given model is of another wire or state, by its error over that of a model fitted to the runs."""
        e = self.error
        return e.original > FAR_OFF_RATIO * max(min(e.base, e.extended), e.noise_floor)

    @property
    def too_short_to_name(self) -> bool:
        """Whether the runs have too few excursions for the name of a cause, and none was held out in their place."""
        return self.gain is None and self.evidence.blocks < RULES["least_blocks"].value

    @property
    def times_noise(self) -> float:
        """The base model's error at settled points, in units of all noise."""
        return self.error.base / self.scatter

    @cached_property
    def model(self) -> Model:
        """The extended model as a model file has it, or the given model if none is offered."""
        if not self.extended:
            return self.original
        zeroed = with_zero_of_runs(self.timeline, self.extended_plant)
        return diagnosed_model(self.original, zeroed, self.train, self.verdict.word)

    @cached_property
    def numerics(self) -> float:
        """The error of the time steps at settled points."""
        return numerics(self.timeline, self.base)

    def lines(self) -> list[str]:
        """The findings, one or two sentences each; the verdict first."""
        return list(commanded_lines(self))

    def text(self) -> str:
        """The findings as text."""
        return "\n".join(self.lines())

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return commanded_json(self)

    @property
    def not_preisach(self) -> bool:
        """Whether the errors depend on the history beyond what any density describes: minor loops do not return."""
        return self.verdict.word == "unknown" and self.verdict.depends_on == PLAIN[WALK]

    @property
    def fitted(self) -> FittedPlant:
        """The fit of the extended model, or of the base model if none is offered."""
        return self.extension.fitted if self.extended else self.subject.base

    def _heaviest_with(self, name: str) -> ComparedHypothesis:
        return self.weights.best_with(Part("effect", name))

    def __repr__(self) -> str:
        effects = " + ".join(str(e) for e in self.likely_effects)
        finding = effects or self.verdict.depends_on or ""
        return f"CommandedDiagnosis({self.verdict.word}{': ' if finding else ''}{finding})"


def _of_hypothesis(kind: EffectType, hypothesis: ComparedHypothesis) -> Effect:
    values = hypothesis.best.parameters
    return kind(**{p.name: values[f"{kind.name}.{p.name}"] for p in kind.parameters})


def _parameters(
    effect: Effect, intervals: Mapping[str, Interval], fitted: Mapping[str, float]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Value, 95 % interval within the bounds, and unit of each parameter; no interval of what was not fitted."""
    for p in effect.kind.parameters:
        key, value = f"{effect.kind.name}.{p.name}", effect.values[p.name]
        ends = intervals.get(key)
        if ends is not None and fitted[key] == -value:  # a strength made positive
            ends = (-ends[1], -ends[0])
        elif ends is not None and fitted[key] != value:  # its phase
            ends = (ends[0] + value - fitted[key], ends[1] + value - fitted[key])
        known = ends is not None and ends[0] < ends[1]
        bounded = (
            [max(min(ends[0], value), p.lower), min(max(ends[1], value), p.upper)] if known and ends else None
        )
        yield p.name, {"value": value, "ci95": bounded, "unit": p.unit}
