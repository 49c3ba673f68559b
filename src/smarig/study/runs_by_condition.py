"""The runs of a study by the conditions in which they differ: figures of a material belong to one condition."""

from collections.abc import Sequence
from dataclasses import dataclass

from smarig.core import spaced
from smarig.record import Run
from smarig.replay import recorded_conditions, same_condition
from smarig.report import display_unit, number

Condition = tuple[str, float, str]  # name, value, unit


@dataclass(frozen=True, eq=False)
class RunsOfCondition:
    """Runs under one condition; ``conditions`` are those by which they differ from the other runs."""

    runs: tuple[Run, ...]
    conditions: tuple[Condition, ...] = ()


def numeric_conditions(run: Run) -> dict[str, tuple[float, str]]:
    """The conditions of a run that are numbers, with their units, by name."""
    recorded = recorded_conditions(run).items()
    return {name: (float(c.value), c.unit) for name, c in recorded if not isinstance(c.value, str)}


def differing(runs: Sequence[Run]) -> list[str]:
    """The names of the conditions that all runs state and in which they differ."""
    each = [numeric_conditions(run) for run in runs]
    names = set.intersection(*map(set, each)) if each else set()
    return sorted(name for name in names if any(not _same(each[0][name], e[name]) for e in each))


def runs_by_condition(runs: Sequence[Run]) -> list[RunsOfCondition]:
    """The runs in groups of equal conditions, in the order of the runs; one group if none differs."""
    names = differing(runs)
    groups: list[tuple[dict[str, tuple[float, str]], list[Run]]] = []
    for run in runs:
        own = numeric_conditions(run)
        group = next((g for known, g in groups if all(_same(known[n], own[n]) for n in names)), None)
        if group is None:
            groups.append((own, group := []))
        group.append(run)
    return [RunsOfCondition(tuple(g), tuple((n, *known[n]) for n in names)) for known, g in groups]


def conditions_text(conditions: Sequence[Condition]) -> str:
    """Conditions in words; "" for none.

    >>> conditions_text([("temperature", 100.0, "K")])
    'temperature 100 K'
    """
    texts = (
        f"{name.replace('_', ' ')} {number(value)}{spaced(display_unit(unit))}"
        for name, value, unit in conditions
    )
    return ", ".join(texts)


def _same(a: tuple[float, str], b: tuple[float, str]) -> bool:
    return a[1] == b[1] and same_condition(a[0], b[0], a[1])
