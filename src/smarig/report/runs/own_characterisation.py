"""What the characterisation that a run belongs to says of it: its diagnosis, and its model on another run."""

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from smarig.core import SmarigError, printable, root_mean_square, spaced
from smarig.diagnosis import DIAGNOSIS_JSON
from smarig.identification import RunVerification, verify
from smarig.plant import effect_types, parameter_words
from smarig.record import Run
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit
from smarig.report.runs.run_alignment import AlignedRun

_RUNS, _MODEL, _DIAGNOSIS = "runs", "model.json", "diagnosis"  # of a characterisation


def named_causes(runs: Sequence[Run]) -> list[str]:
    """The effects that the diagnoses beside runs named."""
    found = [one for run in runs if (one := _stored(run)) is not None and one["verdict"] == "named"]
    return list(dict.fromkeys(name for one in found for name in one["set"]))


def own_diagnoses(runs: Mapping[str, Run]) -> str:
    """What the diagnoses beside runs found, by name, and what helps against named causes; "" if not all have a
    diagnosis, or if none found anything.
    """
    found = {name: _stored(run) for name, run in runs.items()}
    if any(one is None for one in found.values()) or all(
        one is not None and one["verdict"] == "silent" for one in found.values()
    ):
        return ""
    parts = [f"{name}: {_clause(one)}" for name, one in found.items() if one is not None]
    named = [n for one in found.values() if one and one["verdict"] == "named" for n in one["set"]]
    remedies = [t.remedy_text for t in effect_types() if t.name in named and t.remedy_text]
    return " ".join([f"What their own diagnoses found: {'; '.join(parts)}.", *remedies])


def _stored(run: Run) -> dict[str, Any] | None:
    """The diagnosis.json of the characterisation that a run belongs to, None if there is none that can be read."""
    file = run.path.parent.parent / _DIAGNOSIS / DIAGNOSIS_JSON
    if run.path.parent.name != _RUNS or not file.is_file():
        return None
    try:
        about = json.loads(file.read_text(encoding="utf-8"), parse_int=float)
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(about, dict) or not isinstance(about.get("verdict"), str):
        return None
    return about | {"set": _names(about.get("set")), "effects": _list(about.get("effects"))}


def _list(stored: Any) -> list[Any]:
    return stored if isinstance(stored, list) else []


def _names(stored: Any) -> list[str]:
    return [printable(name) for name in _list(stored) if isinstance(name, str)]


def _clause(about: Mapping[str, Any]) -> str:
    named = [_effect(e) for e in about["effects"] if isinstance(e, dict)]
    match about["verdict"]:
        case "named" if named:
            return " and ".join(named)
        case "ambiguous" if about["set"]:
            return f"one of {', '.join(about['set'])}"
        case "silent":
            return "nothing"
        case _:
            depends = printable(str(about.get("depends_on") or ""))
            return f"errors without a known cause{f', which vary with {depends}' if depends else ''}"


def _effect(effect: Mapping[str, Any]) -> str:
    """The name of an effect with its values."""
    parameters = effect.get("parameters")
    parameters = parameters if isinstance(parameters, dict) else {}
    values = [_value(k, v) for k, v in parameters.items() if isinstance(v, dict)]
    size = f" ({', '.join(values)})" if values else ""
    return printable(f"{effect.get('name')}{size}")


def _value(name: str, stored: Mapping[str, Any]) -> str:
    unit, value = str(stored.get("unit") or ""), stored.get("value")
    size = number(value, 3) if isinstance(value, float) and isfinite(value) else "unknown"
    return f"{parameter_words(name, unit)} {size}{spaced(unit)}"


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
