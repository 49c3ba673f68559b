"""The given model with the measure of a fit to measured records, and with what was found or learned."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.identification import MeasuredFit
from smarig.measurement import MeasurementPart
from smarig.preisach import FodTable
from smarig.record import Run
from smarig.replay import Model, provenance


def hysteresis_of_first_run(fit: MeasuredFit) -> FodTable:
    """The hysteresis of a fit with the zero of its first run."""
    return replace(fit.table, values=fit.table.values + float(fit.zeros[0]))


def extended_measured_model(
    model: Model, hysteresis: FodTable, part: MeasurementPart, name: str, warning: str, train: Sequence[Run]
) -> Model:
    """The model ``name`` added to ``model``, with another hysteresis."""
    return replace(
        model,
        name=f"{model.name} + {name}",
        hysteresis=hysteresis,
        mirrored=False,
        effects=(),
        measurement=part.to_json(),
        parameters=(),
        covariance=np.empty((0, 0)),
        intervals={},
        provenance=tuple(provenance(run) for run in train),
        warnings=(*model.warnings, warning),
    )
