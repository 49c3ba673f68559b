"""The fields of structs in a MATLAB 5 file by names such as data/time, those of an array of structs by what they hold.

An element of an array that has a text field Name or label, as signals of ControlDesk and of a scope of Simulink have,
gives its name to its values: X/Y/Stroke. Others are numbered: X/Y/2/Data. A single struct does so by its Name alone.
"""

import math
import struct
from collections.abc import Iterator

from smarig.exchange.binary.mat_elements import MATRIX, NUMERIC, Variable, element, text_of, variable_of

_DEEPEST = 8  # structs within each other
_MOST_ELEMENTS = 10_000  # of an array of structs
_NAMES = ("Name", "name", "Label", "label", "blockName")
_VALUES = ("Data", "data", "Values", "values")
_UNITS = ("Unit", "unit", "Units", "units")


def struct_fields(name: str, variable: Variable, depth: int = 0) -> dict[str, Variable]:
    """The fields of a struct and of structs in it, by names such as data/time."""
    number = math.prod(variable.shape)
    if variable.kind != "struct" or not 0 < number <= _MOST_ELEMENTS or depth == _DEEPEST:
        return {}
    found: dict[str, Variable] = {}
    for k, fields in enumerate(_elements(variable, number), 1):
        own = name if number == 1 else f"{name}/{k}"
        signal = _signal(name, _NAMES if number > 1 else _NAMES[:1], fields, found)
        for field, value in fields.items():
            key = signal if signal and field in _VALUES else f"{own}/{field}"
            found[key] = value
            found |= struct_fields(key, value, depth + 1)
    return found


def _elements(variable: Variable, number: int) -> Iterator[dict[str, Variable]]:
    """The fields of each element of an array of structs."""
    order = variable.order
    _, size, rest = element(variable.elements, order)
    (length,) = struct.unpack(f"{order}i", size)
    _, names, rest = element(rest, order)
    fields = [
        bytes(names[k : k + length]).split(b"\0")[0].decode("ascii")
        for k in range(0, len(names), max(length, 1))
    ]
    for _ in range(number):
        found: dict[str, Variable] = {}
        for field in fields:
            kind, payload, rest = element(rest, order)
            if kind != MATRIX:
                raise ValueError("not a variable")
            if payload:
                found[field] = variable_of(payload, order)[1]
        yield found


def _signal(
    name: str, names: tuple[str, ...], fields: dict[str, Variable], known: dict[str, Variable]
) -> str:
    """The name of the values of a signal that states its own, "" for other structs and for a name that is taken."""
    values = [field for field in _VALUES if field in fields and fields[field].kind in NUMERIC.values()]
    text, unit = _first_text(fields, names), _first_text(fields, _UNITS)
    key = f"{name}/{text} [{unit}]" if unit else f"{name}/{text}"
    return key if text and len(values) == 1 and key not in known else ""


def _first_text(fields: dict[str, Variable], names: tuple[str, ...]) -> str:
    texts = [text_of(fields[name]) for name in names if name in fields]
    return next(filter(None, texts), "")
