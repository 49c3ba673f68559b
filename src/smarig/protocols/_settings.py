"""From ``key=value`` to a protocol: settings are checked against the protocol function's own signature.

Knows types and names; refuses to know values' meaning (the protocol checks that itself).
"""

import inspect
from collections.abc import Mapping
from typing import Any, get_type_hints

from pydantic import TypeAdapter, ValidationError

from smarig.catalogue import find, suggestion
from smarig.command import Protocol
from smarig.errors import UsageError
from smarig.protocols._setup import Setup

PACKAGE = "smarig.protocols"


def build(name: str, setup: Setup, settings: Mapping[str, Any] | None = None) -> Protocol:
    """A protocol by name with settings (strings as typed by a user, or values); dots reach into groups.

    >>> setup = Setup.of("one_wire_twin")
    >>> protocol = build("validation", setup, {"points": "5", "settle.window_s": "10"})
    >>> next(protocol).data["points"]
    5
    """
    function = find(PACKAGE, name)
    hints = get_type_hints(function)
    known = [p.name for p in inspect.signature(function).parameters.values() if p.kind is p.KEYWORD_ONLY]
    given = {}
    for key, value in _grouped(settings or {}).items():
        if key not in known:
            raise UsageError(f"Protocol '{name}' has no setting '{key}'{suggestion(key, known)}.")
        given[key] = _typed(name, key, value, hints[key])
    return function(setup, **given)


def described(name: str) -> list[tuple[str, str]]:
    """(setting, default) of a protocol, for listings."""
    signature = inspect.signature(find(PACKAGE, name))
    return [(p.name, repr(p.default)) for p in signature.parameters.values() if p.kind is p.KEYWORD_ONLY]


def parse_pairs(pairs: tuple[str, ...]) -> dict[str, str]:
    """``("points=5",)`` → {"points": "5"}; UsageError for anything without '='."""
    settings = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or not key.strip():
            raise UsageError(f"'{pair}' is not of the form key=value.")
        settings[key.strip()] = value.strip()
    return settings


def _grouped(settings: Mapping[str, Any]) -> dict[str, Any]:
    grouped: dict[str, Any] = {}
    for key, value in settings.items():
        group, dot, inner = key.partition(".")
        if dot:
            grouped.setdefault(group, {})[inner] = value
        else:
            grouped[key] = value
    return grouped


def _typed(name: str, key: str, value: Any, hint: Any) -> Any:
    if isinstance(value, str) and "tuple" in str(hint):
        value = [part for part in value.replace(";", ",").split(",") if part.strip()]
    if isinstance(value, dict):
        _check_group(name, key, value, hint)
    try:
        return TypeAdapter(hint).validate_python(value)
    except ValidationError as error:
        first = error.errors()[0]
        raise UsageError(
            f"Protocol '{name}', setting {key}: {first['msg'].lower()} (given: {first['input']!r})."
        ) from None


def _check_group(name: str, key: str, value: dict, hint: Any) -> None:
    fields = next(
        (t.__dataclass_fields__ for t in getattr(hint, "__args__", ()) if hasattr(t, "__dataclass_fields__")),
        {},
    )
    for inner in value:
        if inner not in fields:
            raise UsageError(
                f"Protocol '{name}' has no setting '{key}.{inner}'{suggestion(inner, list(fields))}."
            )
