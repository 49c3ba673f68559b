"""Reads and checks the description in a run file: JSON values of the expected types.

Everything that shows, exports or continues a run relies on these types, so they are checked here once. Unknown keys
are accepted: a newer smarig or another program may have written them.
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

MAX_NAME_LENGTH = 2000  # of a value that may be a path
MAX_TEXT_LENGTH = 1_000_000  # of any other text
MAX_LINE_LENGTH = 10_000  # of a text that is shown in one line, such as a cause
MAX_DEPTH = 40  # nested tables and lists; smarig writes four levels
MAX_VALUES = 4_000_000  # in one table; a reference of a day, the largest that is recorded, has 2 million
MAX_ENTRIES = 10_000  # of a table or list that is shown entry by entry
_TIMESTAMP_RANGE_S = (-62_135_596_800.0, 253_402_300_799.0)  # the years 1 to 9999, as seconds since 1970


def decode_json(text: Any) -> Any:
    """The value of a JSON cell. Raises ValueError or TypeError if it is invalid or cannot be written again.

    >>> decode_json('{"unit": "mm"}')
    {'unit': 'mm'}
    >>> decode_json("[" * 100 + "]" * 100)
    Traceback (most recent call last):
    ValueError: it is nested deeper than 40 levels
    """
    check_amount([text])
    try:
        value = json.loads(text)
    except RecursionError:
        raise ValueError(f"it is nested deeper than {MAX_DEPTH} levels") from None
    _check_writable(value, 0)
    return value


def check_amount(cells: Sequence[Any]) -> None:
    """Raise ValueError if JSON cells together have too many values for the memory."""
    if sum(t.count(",") + t.count("[") + t.count("{") for t in cells if isinstance(t, str)) > MAX_VALUES:
        raise ValueError(f"its texts in JSON have more than {MAX_VALUES} values")


def _check_writable(value: Any, depth: int) -> None:
    if depth > MAX_DEPTH:
        raise ValueError(f"it is nested deeper than {MAX_DEPTH} levels")
    if isinstance(value, str) and not value.isascii():
        try:
            value.encode("utf-8")
        except UnicodeEncodeError:
            raise ValueError("it contains half a character (a lone surrogate)") from None
    if isinstance(value, dict | list):
        for inner in (*value, *value.values()) if isinstance(value, dict) else value:
            if isinstance(inner, str | dict | list):  # a call for each number would take seconds
                _check_writable(inner, depth + 1)


# --- types: each function checks whether a value is of one type ----------------------------------------------


def is_text(value: Any) -> bool:
    """Whether a value is a text of plausible length."""
    return isinstance(value, str) and len(value) <= MAX_TEXT_LENGTH


def is_line(value: Any) -> bool:
    """Whether a value is a text that can be shown in a line."""
    return isinstance(value, str) and len(value) <= MAX_LINE_LENGTH


def _name(value: Any) -> bool:
    return (
        isinstance(value, str)
        and len(value) <= MAX_NAME_LENGTH
        and all(len(p.encode("utf-8", "surrogatepass")) <= 255 for p in value.split("/"))
    )


def is_table(value: Any) -> bool:
    """Whether a value is a table."""
    return isinstance(value, dict) and len(value) <= MAX_ENTRIES


def _list(value: Any) -> bool:
    return isinstance(value, list) and len(value) <= MAX_ENTRIES


def is_integer(value: Any) -> bool:
    """Whether a value is an integer that the file can store."""
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**63


def _number(value: Any) -> bool:
    return is_integer(value) or (isinstance(value, float) and math.isfinite(value))


def _duration(value: Any) -> bool:
    return _number(value) and (value == 0 or 1e-6 <= value <= 3600)  # a rig has at most 60 s


def is_timestamp(value: Any) -> bool:
    """Whether a value is a date: seconds since 1970, within the years 1 to 9999."""
    return _number(value) and _TIMESTAMP_RANGE_S[0] <= value <= _TIMESTAMP_RANGE_S[1]


_TYPE_TEXTS: dict[Callable[[Any], bool], str] = {
    is_text: f"a string of at most {MAX_TEXT_LENGTH} characters",
    is_line: f"a string of at most {MAX_LINE_LENGTH} characters",
    _name: "a valid name or path",
    is_table: f"a table of at most {MAX_ENTRIES} entries",
    _list: f"a list of at most {MAX_ENTRIES} entries",
    is_integer: "a whole number",
    _number: "a finite number",
    _duration: "a time in seconds, 1e-6 to 3600",
    is_timestamp: "a date (seconds since 1970)",
}
_LINES = (
    "protocol",
    "rig",
    "wire",
    "source",
    "initial",
    "encoder_zero",
    "device",
    "wire_history",
    "ambient_from",
    "model",
    "along",
)
KEY_TYPES = {
    **dict.fromkeys(("notes", "config", "actuator_text"), is_text),
    **dict.fromkeys(_LINES, is_line),
    **dict.fromkeys(
        ("input", "output", "end", "settings", "versions", "imported", "conditions", "repairs"), is_table
    ),
    **dict.fromkeys(("begun_with", "shift", "hashes", "salvaged", "load"), is_table),
    **dict.fromkeys(("rig_values", "actuator_values", "rig_sha256"), is_table),
    **dict.fromkeys(("effects", "warnings", "findings", "own_files", "instruments"), _list),
    **dict.fromkeys(("seed", "history_until_tick"), is_integer),
    "actuator": _name,
    "period_s": _duration,
    "t0_s": _number,
    "start_epoch": is_timestamp,
}
QUANTITY_KEYS = {"quantity": is_line, "unit": is_line, "from": is_line, "per_count": _number}
_INNER_KEY_TYPES = {
    "input": QUANTITY_KEYS,
    "output": QUANTITY_KEYS,
    "end": {"cause": is_line, "epoch": is_timestamp},
    "imported": {"file": is_line},
    "shift": {"ticks": is_integer},
}


_NOT_NULL = (
    "input",
    "output",
    "end",
    "unit",
    "cause",
)  # if present; other keys may be null, which means "not known"


def check_metadata(meta: Mapping[str, Any]) -> None:
    """Raise TypeError if a key of a run's description has a wrong type."""
    for key, kind in KEY_TYPES.items():
        _check_key(meta, key, kind, "")
    for key, inner in _INNER_KEY_TYPES.items():
        for name, kind in inner.items():
            _check_key(meta.get(key) or {}, name, kind, f" in '{key}'")
    for key in ("effects", "warnings"):
        if not all(map(is_line, meta.get(key) or ())):
            raise TypeError(f"its key '{key}' contains a value that is not a string")
    if not all(is_table(f) and is_line(f.get("text", "")) for f in meta.get("findings") or ()):
        raise TypeError("its key 'findings' contains a value that is not a table with a text")


def _check_key(table: Mapping[str, Any], key: str, kind: Callable[[Any], bool], where: str) -> None:
    value = table.get(key)
    if value is None and (key not in table or key not in _NOT_NULL):
        return
    if not kind(value):
        raise TypeError(f"its key '{key}'{where} is not {_TYPE_TEXTS[kind]}")
