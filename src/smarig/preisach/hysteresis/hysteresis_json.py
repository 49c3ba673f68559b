"""A hysteresis as plain JSON values, and back.

Each kind is one function that dumps it and one line of ``_LOADERS``.
"""

from collections.abc import Callable
from functools import singledispatch
from typing import Any

import numpy as np

from smarig.core import DataError, UsageError
from smarig.preisach.everett import Everett
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.forc_table import ForcTable
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.surface_form import surface_form

LARGEST = 1e12  # its square does not overflow
MOST_NODES = 1000  # of a table: a million values


@singledispatch
def dump_hysteresis(hysteresis: Everett) -> dict[str, Any]:
    """Plain values with a ``kind``. Raises UsageError for a hysteresis without one."""
    raise UsageError(
        f"A {type(hysteresis).__name__} cannot be stored in a model file. Possible kinds: {', '.join(_LOADERS)}."
    )


def load_hysteresis(data: Any) -> Everett:
    """The hysteresis of ``dump_hysteresis``, bit for bit. Raises DataError for invalid values."""
    if not isinstance(data, dict) or data.get("kind") not in _LOADERS:
        kind_found = data.get("kind") if isinstance(data, dict) else data
        raise DataError(f"unknown kind of hysteresis '{kind_found}'; expected one of {', '.join(_LOADERS)}")
    _bounded(data)
    rest = {key: value for key, value in data.items() if key != "kind"}
    try:
        return _LOADERS[data["kind"]](rest)
    except UsageError as error:  # an impossible surface: the file is wrong
        raise DataError(str(error)) from None
    except KeyError as error:
        raise DataError(f"hysteresis key {error} is missing or unknown") from None
    except (TypeError, ValueError, IndexError) as error:
        raise DataError(f"the hysteresis is damaged: {error}") from None


@dump_hysteresis.register
def _dump_surface(hysteresis: FodSurface) -> dict[str, Any]:
    s = hysteresis
    ends = {"lower": s.lower, "upper": s.upper, "y_lower": s.y_lower, "y_upper": s.y_upper, "unit": s.unit}
    x = dict(zip(s.surface_form.parameters, s.x))
    return {"kind": "fod_surface", "form": s.form, "x": x, **ends}


def _load_surface(data: dict[str, Any]) -> FodSurface:
    names = surface_form(data["form"]).parameters
    x = data.pop("x")
    if set(x) != set(names):
        raise DataError(f"a surface of the form {data['form']} requires the parameters {', '.join(names)}")
    numbers: dict[str, Any] = {k: _finite(data.pop(k), k) for k in ("lower", "upper", "y_lower", "y_upper")}
    surface = FodSurface(x=tuple(_finite(x[n], n) for n in names), **numbers, **data)
    with np.errstate(all="ignore"):
        height = surface.shape(surface.upper, surface.upper)
        if height == 0 or not np.isfinite(surface.amplitude):
            raise DataError("the parameters of the surface give no output range")
    return surface


def _finite(value: Any, key: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise DataError(f"hysteresis key {key} is {value!r}, expected a number")
    return float(value)


def _bounded(data: dict[str, Any]) -> None:
    """Raise DataError for a number that is too large, at any depth: in parameters, nodes, rows and curves."""
    left = list(data.items())
    while left:
        key, value = left.pop()
        if isinstance(value, dict):
            left += value.items()
        elif isinstance(value, list):
            left += ((key, item) for item in value)
        elif isinstance(value, int | float) and abs(value) > LARGEST:
            shown = f"{value:g}" if isinstance(value, float) else "a number of many digits"
            raise DataError(f"hysteresis key {key} is {shown}; the largest number is {LARGEST:g}")


@dump_hysteresis.register
def _dump_table(hysteresis: FodTable) -> dict[str, Any]:
    t = hysteresis
    rows = [row[: k + 1].tolist() for k, row in enumerate(t.values)]
    return {"kind": "fod_table", "unit": t.unit, "nodes": t.nodes.tolist(), "rows": rows}


def _load_table(data: dict[str, Any]) -> FodTable:
    nodes, rows = np.array(data["nodes"], dtype=float), data["rows"]
    if nodes.size > MOST_NODES:
        raise DataError(f"a table has at most {MOST_NODES} nodes, this one {nodes.size}")
    values = np.full((nodes.size, nodes.size), np.nan)
    if len(rows) != nodes.size or any(len(row) != k + 1 for k, row in enumerate(rows)):
        raise DataError(f"a table of {nodes.size} nodes requires rows of 1 to {nodes.size} values")
    for k, row in enumerate(rows):
        values[k, : k + 1] = row
    return FodTable(nodes, values, str(data["unit"]))


@dump_hysteresis.register
def _dump_curves(hysteresis: ForcTable) -> dict[str, Any]:
    return {"kind": "forc_table", **hysteresis.to_json()}


@dump_hysteresis.register
def _dump_mirrored(hysteresis: Mirrored) -> dict[str, Any]:
    return {"kind": "mirrored", "image": dump_hysteresis(hysteresis.image)}


def _load_mirrored(data: dict[str, Any]) -> Mirrored:
    if isinstance(data["image"], dict) and data["image"].get("kind") == "mirrored":
        raise DataError("the image of a mirrored hysteresis is mirrored itself")
    return Mirrored(load_hysteresis(data["image"]))


_LOADERS: dict[str, Callable[[dict[str, Any]], Everett]] = {
    "fod_surface": _load_surface,
    "fod_table": _load_table,
    "forc_table": ForcTable.from_json,
    "mirrored": _load_mirrored,
}
