"""Series of Prometheus, each with its labels and its pairs of time and value, as one table on a common clock."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from smarig.exchange.layouts.joined_clocks import joined_clocks
from smarig.exchange.layouts.json_lines import cell_text
from smarig.exchange.text.cell_values import is_number

_NAME = "__name__"
_TIME = "time"
_UNITS = {  # with which the name of a metric ends
    "celsius": "degC",
    "fahrenheit": "degF",
    "kelvin": "K",
    "seconds": "s",
    "meters": "m",
    "metres": "m",
    "millimeters": "mm",
    "micrometers": "um",
    "ratio": "1",
    "percent": "%",
    "volts": "V",
    "amperes": "A",
    "ohms": "ohm",
    "watts": "W",
    "joules": "J",
    "newtons": "N",
    "pascals": "Pa",
    "grams": "g",
    "hertz": "Hz",
}


@dataclass(frozen=True)
class MetricSeries:
    """Names and rows of cells, the units by name, the labels that all series have, and how the rows came about."""

    names: list[str]
    rows: list[list[str]]
    units: dict[str, str]
    labels: dict[str, str]
    note: str


def metric_series(value: Sequence[Any]) -> MetricSeries | None:
    """The table of an array of series; None for another array."""
    if not value or not all(map(_is_series, value)):
        return None
    labels = [{key: cell_text(part) for key, part in item["metric"].items()} for item in value]
    names = _names(labels)
    joined = joined_clocks([np.array([float(t) for t, _ in item["values"]]) for item in value])
    rows = [[cell_text(t), *["nan"] * len(value)] for t, _ in value[joined.base]["values"]]
    for column, (item, where) in enumerate(zip(value, joined.rows), 1):
        for row, (_, reading) in zip(where.tolist(), item["values"]):
            if row >= 0:
                rows[row][column] = cell_text(reading)
    shared = {key: text for key, text in labels[0].items() if all(each.get(key) == text for each in labels)}
    units = {name: unit for name, each in zip(names, labels) if (unit := _unit(each.get(_NAME, "")))}
    return MetricSeries(
        [_TIME, *names],
        rows,
        {_TIME: "s"} | units,
        {key: text for key, text in shared.items() if key != _NAME},
        joined.sentence(names[joined.base]),
    )


def _is_series(item: Any) -> bool:
    pairs = item.get("values") if isinstance(item, dict) and isinstance(item.get("metric"), dict) else None
    return isinstance(pairs, list) and bool(pairs) and all(map(_is_pair, pairs))


def _is_pair(pair: Any) -> bool:
    return isinstance(pair, list) and len(pair) == 2 and is_number(cell_text(pair[0]), ".")


def _names(labels: Sequence[Mapping[str, str]]) -> list[str]:
    """The names of series, with the labels that differ where names are equal.

    >>> _names([{"__name__": "T", "at": "a"}, {"__name__": "T", "at": "b"}, {"__name__": "x", "at": "a"}])
    ['T at=a', 'T at=b', 'x']
    """
    named = [each.get(_NAME, "value") for each in labels]
    found = []
    for name, each in zip(named, labels):
        equally_named = [other for other, its in zip(labels, named) if its == name]
        differ = [key for key in each if len({other.get(key) for other in equally_named}) > 1]
        found.append(" ".join([name, *(f"{key}={each[key]}" for key in differ)]))
    return found


def _unit(name: str) -> str:
    return _UNITS.get(name.removesuffix("_total").rpartition("_")[2].lower(), "")
