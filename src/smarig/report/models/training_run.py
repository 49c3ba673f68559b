"""The run that a characterisation's model was fitted to, and its stroke."""

import numpy as np

from smarig.record import Run
from smarig.report.models.evidence import Evidence


def training_run(e: Evidence) -> Run | None:
    """The run that contributed most to the chosen model."""
    if e.best is None:
        return None
    names = {p.run for p in e.best.model.provenance}
    made_from = [r for r in e.runs.values() if r.path.name in names or str(r.path) in names]
    return max(made_from or e.of("first_order_descending", "first_order_ascending"), key=len, default=None)


def stroke_run(e: Evidence) -> Run | None:
    """The run whose settled outputs show the stroke: that of the model, which begins saturated; else the widest.

    A run that begins elsewhere contains a play that is taken up once, and a part of a drift.
    """
    runs = [run for run in e.runs.values() if len(run.settled) >= 2]
    fitted = training_run(e)
    return next((run for run in runs if run is fitted), max(runs, key=settled_range, default=None))


def settled_range(run: Run) -> float:
    """The range of the settled outputs of a run."""
    return float(np.ptp(run.points()[1]))


def stroke_text(stroke: float) -> str:
    """Three digits, zeros too: a stroke of 12.0 is not one of 12.

    >>> stroke_text(12.04), stroke_text(300.0)
    ('12.0', '300')
    """
    return f"{stroke:#.3g}".rstrip(".")
