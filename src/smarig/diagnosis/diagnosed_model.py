"""The model file that a diagnosis of commanded runs writes: the given model, extended by effects or a learned law."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.record import Run
from smarig.replay import Model, PlantModel, provenance


def diagnosed_model(original: Model, plant_model: PlantModel, train: Sequence[Run], word: str) -> Model:
    """The given model with its density identified jointly with the effects, and with these effects.

    ``train`` are the runs that it was identified from, ``word`` is the verdict's.
    """
    return replace(
        original,
        name=f"{original.name} + {' + '.join(e.kind.name for e in plant_model.catalogue_effects)}",
        hysteresis=plant_model.hysteresis,
        effects=tuple(e.with_positive_strength.to_json() for e in plant_model.catalogue_effects),
        parameters=(),
        covariance=np.empty((0, 0)),
        intervals={},
        provenance=tuple(provenance(run) for run in train),
        warnings=(
            *original.warnings,
            "Term learned from the errors of a plain model; its cause is unknown."
            if any(e.kind.shape for e in plant_model.catalogue_effects)
            else f"Effects by diagnosis ({word}); density identified jointly.",
        ),
    )
