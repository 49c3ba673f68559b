"""How the model of one characterisation predicts the run of another: whether what was learned one day still holds."""

from pathlib import Path

from smarig.core import SmarigError, spaced
from smarig.identification import verify
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
    errors = [_rms(model, each.run) for each in (other, first)]
    if None in errors:
        return ""
    there, here = (f"{number(rms)}{spaced(display_unit(first.run.unit))}" for rms in errors)
    return f"The model of {first.name} predicts {other.name} to {there} rms; on {first.name} its error is {here}."


def _rms(model: Path, run: Run) -> float | None:
    try:
        return verify(model, [run]).runs[0].settled.rms
    except SmarigError:
        return None
