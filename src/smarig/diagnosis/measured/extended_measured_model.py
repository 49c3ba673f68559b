"""The given model with the measure of a fit to measured records, and with what was found or learned."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.identification import MeasuredFit
from smarig.measurement import MeasurementPart
from smarig.record import Run
from smarig.replay import Model, provenance


def extended_measured_model(
    model: Model, fit: MeasuredFit, part: MeasurementPart, name: str, warning: str, train: Sequence[Run]
) -> Model:
    """The model ``name`` added to ``model``. Without a table of a condition it has the zero of the first run."""
    zero = 0.0 if part.table else float(fit.zeros[0])
    return replace(
        model,
        name=f"{model.name} + {name}",
        hysteresis=replace(fit.table, values=fit.table.values + zero) if zero else fit.table,
        mirrored=False,
        effects=(),
        measurement=part.to_json(),
        parameters=(),
        covariance=np.empty((0, 0)),
        intervals={},
        provenance=tuple(provenance(run) for run in train),
        warnings=(*model.warnings, warning),
    )
