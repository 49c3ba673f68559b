"""What a comparison of commanded runs says, in values: verdict, effects, extended model, errors, noise."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.diagnosis.comparison.commanded.commanded_search import SearchedHypotheses
from smarig.diagnosis.comparison.commanded.extension import Extension
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge
from smarig.diagnosis.comparison.rules import SENTENCES, Verdict, VerdictEvidence
from smarig.diagnosis.comparison.weights import Weights
from smarig.diagnosis.diagnosed_model import diagnosed_model
from smarig.diagnosis.diagnosis_result import ErrorSummary
from smarig.diagnosis.explain.joint_density import settled_rms
from smarig.diagnosis.explain.zero_of_output import with_zero_of_runs
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.plant import Effect
from smarig.record import Run
from smarig.replay import Model, PlantModel, Timeline, numerics

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class LikelyEffect:
    """An effect of the extended model, its probability, and the 95 % interval of each of its parameters by name."""

    effect: Effect
    probability: float
    intervals95: Mapping[str, Interval]


@dataclass(frozen=True, eq=False)
class CommandedComparison:
    """The hypotheses about a wire with their weights, the verdict, and the model that it extends.

    ``extension`` is the base model with effects, or with a law if the cause is unknown: of those that do not predict
    held-out runs worse, the one that predicts blocks left out best. ``offered``: whether there is one. ``gain`` are the
    errors on held-out runs, None if there are none. ``missing``: what the runs do not determine and the held-out runs
    need. ``train`` are the runs, ``original`` the given model.
    """

    subject: CommandedProblem
    found: SearchedHypotheses
    weights: Weights
    evidence: VerdictEvidence
    verdict: Verdict
    extension: Extension
    offered: bool
    gain: HeldOutGain | None
    missing: MissingKnowledge | None
    original: Model
    train: tuple[Run, ...]
    seconds: float

    @property
    def causes(self) -> dict[Part, float]:
        """The probability of each cause, likeliest first."""
        return self.weights.causes

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
    def extended(self) -> PlantModel:
        """The model with effects or a law, or the base model if none is offered."""
        return self.extension.extended if self.offered else self.extension.base

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the extension's effects by "effect.parameter"."""
        return dict(self.extension.parameters)

    @property
    def intervals95(self) -> dict[str, Interval]:
        """The 95 % intervals of the parameters, by the choice of blocks."""
        return self.extension.intervals(0.95)

    @property
    def intervals90(self) -> dict[str, Interval]:
        """The 90 % intervals of the parameters."""
        return self.extension.intervals(0.90)

    @property
    def effects(self) -> tuple[LikelyEffect, ...]:
        """The effects of the verdict that the extension has, each with its probability and intervals."""
        intervals, names = self.intervals95, self.verdict.names
        return tuple(
            LikelyEffect(
                e.with_positive_strength,
                self.causes.get(Part("effect", e.kind.name), 0.0),
                {n: intervals[key] for n in e.values if (key := f"{e.kind.name}.{n}") in intervals},
            )
            for e in self.extension.extended.catalogue_effects
            if e.kind.name in names
        )

    @property
    def learned(self) -> Effect | None:
        """The learned law of the extended model, if it has one; its ``kind.shape`` says where it enters."""
        return next((e for e in self.extended.catalogue_effects if e.kind.shape), None)

    @property
    def not_identifiable(self) -> tuple[str, ...]:
        """The effects that these runs could not show at any strength."""
        shown = {s.part.name for s in self.found.screened if s.detectable}
        return tuple(k.name for k in self.subject.catalogue if k.name not in shown)

    @property
    def noise(self) -> NoiseEstimate:
        """What the readings scatter beside the extended model, or beside the base model if none is offered."""
        fitted = self.extension.fitted if self.offered else self.subject.base
        return fitted.refitted.noise

    @cached_property
    def error(self) -> ErrorSummary:
        """The rms errors of the runs' settled points by the given, the base and the extended model."""
        timeline = self.timeline
        floor = float(np.sqrt(np.mean(self.noise.white[: len(timeline.settled)] ** 2)))
        models = (self.subject.given, self.base, self.extended)
        return ErrorSummary(timeline.unit, floor, *(settled_rms(timeline, m) for m in models))

    @cached_property
    def model(self) -> Model:
        """The extended model as a model file has it, or the given model if none is offered."""
        if not self.offered:
            return self.original
        zeroed = with_zero_of_runs(self.timeline, self.extended)
        return diagnosed_model(self.original, zeroed, self.train, self.verdict.word)

    @cached_property
    def numerics(self) -> float:
        """The error of the time steps at settled points."""
        return numerics(self.timeline, self.base)
