"""Loops that are one but for the zero of the output: no page of one file shows it, and no error contains it."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from smarig.core import Array, SmarigError, root_mean_square, spaced
from smarig.diagnosis import RULES
from smarig.identification import RunVerification, verify
from smarig.record import OWN_ZERO, Run, load_run
from smarig.replay import load_model
from smarig.report import display_unit, number
from smarig.study.candidate_models import WORSE, CandidateModel
from smarig.study.data_split import DataSplit
from smarig.study.input_turns import wide_turns
from smarig.study.runs_by_condition import differing

if TYPE_CHECKING:
    from smarig.study.each_file import FileOutcome

_ROLES = ("input", "output")


def other_zeros(outcomes: "Sequence[FileOutcome]") -> dict[str, str]:
    """A sentence by file whose output reads more or less throughout than that of the first file with the same columns.

    Equal conditions are required: a load moves the output, too. The model of one of both files must predict the other
    as well as both their own models do, once it is shifted, by far more than it then misses.
    """
    first: dict[tuple[Any, ...], FileOutcome] = {}
    found: dict[str, str] = {}
    for outcome in outcomes:
        if outcome.found is None or not outcome.found["model"] or len(outcome.found["runs"]) != 1:
            continue
        reference = first.setdefault(columns_of(outcome.found), outcome)
        if reference is not outcome and (text := _sentence(reference, outcome)):
            found[outcome.file] = text
    return found


def zeros_of_held_out(split: DataSplit, best: CandidateModel) -> list[str]:
    """A sentence on each held-out run whose output reads more or less throughout than the fitted runs of equal
    conditions; none on files whose zeros are arbitrary by their mapping.
    """
    runs = (*split.train, *split.held_out)
    if split.kind != "run" or differing(runs) or any(run.info.encoder_zero == OWN_ZERO for run in runs):
        return []
    return [
        f"The output of {run.name} reads {_shown(checked.offset, best.model.unit)} throughout than that of the fitted "
        "runs: another zero, which its errors do not contain."
        for run, checked in zip(split.held_out, best.held_out)
        if checked.offset_kind == "fitted" and _is_of_zero(checked.offset, best)
    ]


def _is_of_zero(shift: float, best: CandidateModel) -> bool:
    """Whether a shift is larger than the errors, and far more than their means over branches: what a lag leaves on one
    branch has the other sign on the next one, but a zero moves them all.
    """
    means = [_means_over_branches(run) for run in (*best.train, *best.held_out)]
    return abs(shift) > max(best.rms, best.train_rms) and _is_clear(
        shift, root_mean_square(np.concatenate(means))
    )


def _means_over_branches(run: RunVerification) -> Array:
    """The mean error of each branch of a run (k,), between turns of its input."""
    error, u = ((run.measured - run.predicted)[run.counted], run.input[run.counted])
    return np.array([error[a : b + 1].mean() for a, b in pairwise(wide_turns(u).tolist())])


def _is_clear(shift: float, left: float) -> bool:
    """Whether a shift is far more than the error that is left."""
    return abs(shift) > RULES["adequate"].value * left


def _shown(shift: float, unit: str) -> str:
    return f"{number(abs(shift))}{spaced(display_unit(unit))} {'more' if shift > 0 else 'less'}"


def columns_of(found: dict[str, Any]) -> tuple[Any, ...]:
    """The names and units of input and output; those of a mapping that was given are equal."""
    used = [
        (c["role"], name, c["unit"])
        for columns in found["columns"].values()
        for name, c in columns.items()
        if c["role"] in _ROLES
    ]
    return (found["unit"], *sorted(used))


def _sentence(reference: "FileOutcome", other: "FileOutcome") -> str:
    """What the zeros of two files differ by; "" if they do not, or the loops differ as well."""
    for known, new, sign in ((reference, other, 1), (other, reference, -1)):
        try:
            shift, left = _shift(known, new)
        except (SmarigError, OSError):
            continue
        own = max(o.found["held_out"]["rms"] for o in (known, new) if o.found)
        if left <= WORSE * own and _is_clear(shift, max(left, own)):
            unit = (new.found or {})["unit"] or ""
            return (
                f"{Path(other.file).name} holds the loop of {Path(reference.file).name} with another zero of the "
                f"output: it reads {_shown(sign * shift, unit)} throughout, and {number(left)}"
                f"{spaced(display_unit(unit))} rms are left after this shift."
            )
    return ""


def _shift(known: "FileOutcome", new: "FileOutcome") -> tuple[float, float]:
    """By how much the output of one file lies above the model of another, and the rms error after that; no shift if
    their conditions differ.
    """
    run, own = (_run(outcome) for outcome in (new, known))
    if differing([own, run]):
        return 0.0, 0.0
    checked = verify(load_model(Path(known.folder) / "model.json"), [run], offset="fitted").runs[0]
    return checked.offset, root_mean_square((checked.predicted - checked.measured)[checked.counted])


def _run(outcome: "FileOutcome") -> Run:
    """The run of a file, wherever its study was made."""
    (path,) = outcome.found["runs"] if outcome.found else ("",)
    return load_run(Path(outcome.folder) / "runs" / Path(path).name)
