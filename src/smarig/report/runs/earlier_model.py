"""How the model of one characterisation predicts the run of another: whether what was learned one day still holds."""

from pathlib import Path

from smarig.core import SmarigError, root_mean_square, spaced
from smarig.identification import RunVerification, verify
from smarig.record import Run
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit
from smarig.report.runs.run_alignment import AlignedRun

_RUNS, _MODEL = "runs", "model.json"  # of a characterisation


def earlier_model_sentence(first: AlignedRun, other: AlignedRun) -> str:
    """The rms errors of the first run's model on both runs, as a sentence; "" without a model that predicts them."""
    folder = first.run.path.parent
    model = folder.parent / _MODEL
    if folder.name != _RUNS or not model.is_file():
        return ""
    own, found = _verified(model, first.run), _verified(model, other.run)
    if own is None or found is None:
        return ""
    zero_fitted = other.offset_kind == "fitted"
    there = found.settled.rms if zero_fitted else _rms_with_zero_of(own, found)
    unit = spaced(display_unit(first.run.unit))
    return (
        f"The model of {first.name} predicts {other.name} to {number(there)}{unit} rms"
        f"{', with its zero fitted' if zero_fitted else ''}; on {first.name} its error is "
        f"{number(own.settled.rms)}{unit}."
    )


def _verified(model: Path, run: Run) -> RunVerification | None:
    try:
        return verify(model, [run]).runs[0]
    except SmarigError:
        return None


def _rms_with_zero_of(own: RunVerification, other: RunVerification) -> float:
    """The rms error of another run whose zero is that of the model's own run: its fitted offset would hide a change."""
    error = other.measured - other.predicted + other.offset - own.offset
    return root_mean_square(error[other.counted])
