"""The conditions that runs record (stress, load, room temperature, frequency, specimen), compared with each other."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from smarig.core import spaced
from smarig.record import Run
from smarig.replay.model_file import ConditionRecord, Model

Value = float | str
SAME_SHARE = 0.1  # of the largest value: a smaller difference is one condition
SAME_K = 3.0  # temperatures in °C or K that differ by less are one condition
SAME_CAUSE = {"load": "stress"}  # a condition that another one states already
MODELLED = {"stress": "stress"}  # conditions that a model can depend on, with the value of --load-from
PHRASES = {
    "stress": "under {}",
    "load": "under a load of {}",
    "room_temperature": "at a room temperature of {}",
    "chamber_temperature": "at a chamber temperature of {}",
    "temperature": "at {}",
    "magnetic_field": "in a magnetic field of {}",
    "frequency": "at {}",
    "specimen": "of specimen {}",
}


def recorded_conditions(run: Run) -> dict[str, ConditionRecord]:
    """The conditions of a run by name: a mean with its unit, or a text."""
    found: dict[str, ConditionRecord] = {}
    for name, stored in run.info.conditions.items():
        if not isinstance(stored, Mapping):
            continue
        mean, text = stored.get("mean"), stored.get("text")
        if isinstance(text, str) and text:
            found[name] = ConditionRecord(value=text, unit="")
        elif isinstance(mean, int | float) and not isinstance(mean, bool) and np.isfinite(mean):
            found[name] = ConditionRecord(value=float(mean), unit=str(stored.get("unit", "")))
    return found


def condition_text(condition: ConditionRecord) -> str:
    """The value of a condition, without its unit."""
    return condition.value if isinstance(condition.value, str) else f"{condition.value:.3g}"


def same_condition(a: Value, b: Value, unit: str) -> bool:
    """Whether two values count as one condition.

    >>> same_condition(50.0, 52.0, "MPa"), same_condition(50.0, 100.0, "MPa"), same_condition("A", "B", "")
    (True, False, False)
    """
    if isinstance(a, str) or isinstance(b, str):
        return a == b
    if unit in ("degC", "K"):
        return abs(a - b) <= SAME_K
    return abs(a - b) <= SAME_SHARE * max(abs(a), abs(b))


def pooled_conditions(runs: Sequence[Run], modelled: Collection[str] = ()) -> list[str]:
    """A sentence for each condition that differs between runs, except those that the model depends on."""
    records, found = [recorded_conditions(run) for run in runs], []
    for name in dict.fromkeys(n for r in records for n in r):
        values = _distinct([r[name] for r in records if name in r])
        if len(values) < 2 or name in modelled or SAME_CAUSE.get(name) in records[0]:
            continue
        advice = (
            f" To model the load, use smarig identify with --load-from {MODELLED[name]}."
            if name in MODELLED
            else ""
        )
        found.append(
            f"These runs were made {_phrase(name, values)}; the model pools them as one wire.{advice}"
        )
    return found


def foreign_conditions(model: Model, run: Run) -> list[str]:
    """A sentence for each condition of a run that differs from all under which the model was identified."""
    found = []
    known = [p.conditions for p in model.provenance]
    depends = (model.measurement.get("table") or {}).get("condition")
    conditions = recorded_conditions(run)
    for name, own in conditions.items():
        if SAME_CAUSE.get(name) in conditions:
            continue
        values = _distinct([c[name] for c in known if name in c])
        if not values or any(
            v.unit != own.unit or same_condition(own.value, v.value, v.unit) for v in values
        ):
            continue
        difference = f"The run was made {_phrase(name, [own])}, the model from runs {_phrase(name, values)}."
        if name != depends:
            found.append(difference)
        elif not _between(own, values):
            found.append(f"{difference} The model extrapolates.")
    return found


def _between(own: ConditionRecord, values: Sequence[ConditionRecord]) -> bool:
    numbers = [float(v.value) for v in values if not isinstance(v.value, str)]
    return not isinstance(own.value, str) and min(numbers) <= own.value <= max(numbers)


def _distinct(values: Sequence[ConditionRecord]) -> list[ConditionRecord]:
    """Values that count as different, in increasing order."""
    found: list[ConditionRecord] = []
    texts = [v for v in values if isinstance(v.value, str)]
    numbers = [v for v in values if not isinstance(v.value, str)]
    for group in (numbers, texts):
        for own in sorted(group, key=lambda v: v.value):
            if not any(own.unit == v.unit and same_condition(own.value, v.value, v.unit) for v in found):
                found.append(own)
    return found


def _phrase(name: str, values: Sequence[ConditionRecord]) -> str:
    """The conditions in words.

    >>> _phrase("stress", [ConditionRecord(value=v, unit="MPa") for v in (50.0, 99.9, 150.0)])
    'under 50, 99.9 and 150 MPa'
    """
    shown = [condition_text(v) for v in values]
    listed = " and ".join([", ".join(shown[:-1]), shown[-1]]) if len(shown) > 1 else shown[0]
    unit = values[0].unit.replace("degC", "°C")
    default = f"at {name.replace('_', ' ')} {{}}"
    return PHRASES.get(name, default).format(f"{listed}{spaced(unit)}".strip())
