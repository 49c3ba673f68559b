"""The explanation of a timeline with a positive density, or with one that is negative somewhere (Prop. 4.6).

The density of a wire should be positive, so effects are first searched for with a positive density. A signed
density is used if it is likelier than all effects with a positive one.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from smarig.diagnosis.critique.critique import Critique
from smarig.diagnosis.explain.joint_density import joint_density_from_best_start
from smarig.diagnosis.explain.search import (
    MIN_GAIN_NATS,
    MIN_GAIN_SILENT_NATS,
    SINGLE_TRIED_IF_SILENT,
    BelowRivalEvidence,
    SearchLevel,
    SearchResult,
    search_explanations,
)
from smarig.diagnosis.refit.refit import Refit
from smarig.preisach import Everett
from smarig.replay import PlantModel, Timeline

CritiqueFunction = Callable[..., Critique]
ProgressFunction = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class DensitySearchResult:
    """A base model without effects, its readings refitted, its critique, and what the search for explanations found."""

    base: PlantModel
    plain: Refit
    first: Critique
    found: SearchResult = field(default_factory=lambda: SearchResult([]))

    @property
    def levels(self) -> list[SearchLevel]:
        """Levels of explanations."""
        return self.found.levels

    @property
    def evidence(self) -> float:
        """The log likelihood that a signed density must exceed."""
        return (
            self.levels[-1].explanations[0].evidence
            if self.levels
            else self.plain.log_evidence + MIN_GAIN_NATS
        )


def find_explanations(
    timeline: Timeline,
    plant_model: PlantModel,
    criticise: CritiqueFunction,
    report_progress: ProgressFunction,
) -> DensitySearchResult:
    """The explanation of a timeline by a plant model, with the more plausible kind of density."""
    original = plant_model.hysteresis
    base, plain = joint_density_from_best_start(timeline, plant_model, original)
    positive_result = DensitySearchResult(base, plain, criticise(base))
    if positive_result.first.silent:
        positive_result = _with_levels(positive_result, original, criticise, report_progress)
        if positive_result.first.silent:
            return positive_result
    signed = joint_density_from_best_start(timeline, replace(plant_model, signed=True), original)
    return _choose_density(positive_result, signed, original, criticise, report_progress)


def _choose_density(
    positive_result: DensitySearchResult,
    signed: tuple[PlantModel, Refit],
    original: Everett,
    criticise: CritiqueFunction,
    report_progress: ProgressFunction,
) -> DensitySearchResult:
    """The positive density with its explanations, unless the signed density is likelier.

    If no single effect comes near the signed density, the search uses the signed density first. If it finds
    nothing, the search with the positive density stops too.
    """
    signed_result: DensitySearchResult | None = None

    def search_with_signed() -> DensitySearchResult:
        report_progress("Comparing with densities that may be negative")
        return _with_levels(
            DensitySearchResult(*signed, criticise(signed[0])), original, criticise, report_progress
        )

    try:
        if not positive_result.levels:
            positive_result = _with_levels(
                positive_result, original, criticise, report_progress, signed[1].log_evidence
            )
    except BelowRivalEvidence:
        signed_result = search_with_signed()
        if not signed_result.levels:
            return signed_result
        positive_result = _with_levels(positive_result, original, criticise, report_progress)
    if signed[1].log_evidence <= positive_result.evidence:
        return positive_result
    return signed_result or search_with_signed()


def _with_levels(
    base: DensitySearchResult,
    original: Everett,
    criticise: CritiqueFunction,
    report_progress: ProgressFunction,
    rival: float = float("-inf"),
) -> DensitySearchResult:
    """The search result with levels of explanations for a base; ``rival`` as in ``search_explanations``.

    If nothing stands out, a large effect may have been taken for noise. Then the search runs with the least noise
    and accepts only an explanation with a large gain. If there is one, the noise is estimated with its effects.
    """
    first, evidence = base.first, base.plain.log_evidence

    def criticise_like_first(plant_model: PlantModel) -> Critique:
        report_progress("with " + " and ".join(e.kind.name for e in plant_model.catalogue_effects))
        return criticise(plant_model, warm_start=first)

    if not first.silent:
        return replace(
            base, found=search_explanations(first, original, criticise_like_first, evidence, rival=rival)
        )
    found = search_explanations(
        criticise(base.base, all_nuisances=True),
        original,
        criticise_like_first,
        evidence,
        MIN_GAIN_SILENT_NATS,
        SINGLE_TRIED_IF_SILENT,
    )
    repeated = criticise(base.base, noise_of=found.levels[0].critique) if found.levels else first
    return base if repeated.silent else replace(base, first=repeated, found=found)
