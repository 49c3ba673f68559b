"""Builds a protocol from ``key=value`` settings, which are checked against the protocol function's signature.

Names and types are checked here. The protocol itself checks the values.
"""

import inspect
from collections.abc import Generator, Mapping
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from pydantic import TypeAdapter, ValidationError

from smarig.config import CampaignFile
from smarig.core import (
    Protocol,
    UsageError,
    catalogue_entry,
    catalogue_names,
    passed,
    problem_text,
    resolve_name,
    suggestion,
)
from smarig.protocols._setup import Setup
from smarig.protocols._through_cold import through_cold
from smarig.protocols.adaptive_fod import Chooser

PROTOCOLS = "smarig.protocols"
_NAMES_A_FILE = "names a file"
InputFile = Annotated[str, _NAMES_A_FILE]  # a setting that names a file to be read
_LOOPS = ("regulate", "track")  # these need a model and have commands of their own


def build_protocol(
    name: str, setup: Setup, settings: Mapping[str, Any] | None = None, chooser: Chooser | None = None
) -> Protocol:
    """A protocol by name with settings (strings typed by a user, or values). Dots address settings in groups.

    ``chooser`` is passed to protocols that take one.

    >>> setup = Setup.of("one_wire_twin")
    >>> protocol = build_protocol("validation", setup, {"points": "5", "settle.window_s": "10"})
    >>> next(protocol).data["points"]
    5
    """
    refuse_closed_loops(name)
    function = catalogue_entry(PROTOCOLS, name)
    hints = get_type_hints(function)
    parameters = inspect.signature(function).parameters
    known = [p.name for p in parameters.values() if p.kind is p.KEYWORD_ONLY]
    arguments: dict[str, Any] = {"chooser": chooser} if "chooser" in parameters else {}
    for key, value in _grouped(settings or {}).items():
        if key not in known:
            raise UsageError(f"Protocol '{name}' has no setting '{key}'{suggestion(key, known)}.")
        arguments[key] = _converted(name, key, value, hints[key])
    generator = function(setup, **arguments)
    if not isinstance(generator, Generator):
        raise UsageError(f"Protocol '{name}' yields nothing. It must be a generator of commands.")
    return through_cold(generator, setup) if setup.limits.stress_max_MPa is not None else generator


def refuse_closed_loops(name: str) -> None:
    """Raise UsageError if a closed loop is requested as a protocol; the message names the right command."""
    if name in _LOOPS and name not in catalogue_names(PROTOCOLS):
        raise UsageError(
            f"'{name}' is not a protocol for 'smarig run'. Use 'smarig {name} MODEL …' (see 'smarig {name} --help'), "
            f"or smarig.{name}(model, …) in Python."
        )


def file_settings(name: str) -> list[str]:
    """The settings of a protocol that name files.

    >>> file_settings("step_currents"), file_settings("validation")
    (['file'], [])
    """
    hints = get_type_hints(catalogue_entry(PROTOCOLS, name), include_extras=True)
    return [key for key, hint in hints.items() if _NAMES_A_FILE in getattr(hint, "__metadata__", ())]


def with_loaded_protocols(plan: CampaignFile) -> CampaignFile:
    """A campaign whose steps give their protocols by name. Own files are added to the catalogue."""
    steps = (s.model_copy(update={"protocol": resolve_name(PROTOCOLS, s.protocol)}) for s in plan.step)
    return plan.model_copy(update={"step": tuple(steps)})


def setting_texts(name: str) -> list[tuple[str, str]]:
    """(setting, default and choices) of a protocol, for listings. Dots mark settings in groups.

    >>> dict(setting_texts("initialise"))["method"]
    "'planned' (planned | thesis)"
    """
    function = catalogue_entry(PROTOCOLS, name)
    hints, found = get_type_hints(function), []
    for p in inspect.signature(function).parameters.values():
        if p.kind is not p.KEYWORD_ONLY:
            continue
        group = next((t for t in get_args(hints[p.name]) if is_dataclass(t) and isinstance(t, type)), None)
        if group is not None:
            found += [(f"{p.name}.{f.name}", repr(f.default)) for f in fields(group)]
        elif get_origin(hints[p.name]) is Literal:
            found.append((p.name, f"{p.default!r} ({' | '.join(get_args(hints[p.name]))})"))
        else:
            found.append((p.name, repr(p.default)))
    return found


def parse_pairs(pairs: tuple[str, ...]) -> dict[str, str]:
    """``("points=5",)`` → {"points": "5"}. UsageError for a text without '='."""
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
        if dot and not isinstance(grouped.setdefault(group, {}), dict):
            raise UsageError(f"'{group}' is set as a whole and also by '{key}'. Use one of them.")
        if dot:
            grouped[group][inner] = value
        elif key in grouped:
            raise UsageError(f"'{key}' is set as a whole and also by its parts. Use one of them.")
        else:
            grouped[key] = value
    return grouped


def _converted(name: str, key: str, value: Any, hint: Any) -> Any:
    if isinstance(value, str):
        value = passed(value)
    if isinstance(value, str) and "tuple" in str(hint):
        if ";" in value and "," in value:  # 2,5; 60: a decimal comma, or a list of four?
            raise UsageError(
                f"Protocol '{name}', setting {key}: '{value}' has commas and semicolons. Write decimals with a point, "
                "and one sign between the values."
            )
        value = [part for part in value.replace(";", ",").split(",") if part.strip()]
    if isinstance(value, dict):
        _check_group(name, key, value, hint)
    try:
        return TypeAdapter(hint).validate_python(value)
    except ValidationError as error:
        first = error.errors()[0]
        raise UsageError(
            f"Protocol '{name}', setting {key}: {problem_text(first).lower()} (given: {first['input']!r})."
        ) from None


def _check_group(name: str, key: str, value: dict, hint: Any) -> None:
    group = next((t for t in get_args(hint) if is_dataclass(t)), None)
    known = [f.name for f in fields(group)] if group else []
    for inner in value:
        if inner not in known:
            raise UsageError(f"Protocol '{name}' has no setting '{key}.{inner}'{suggestion(inner, known)}.")
