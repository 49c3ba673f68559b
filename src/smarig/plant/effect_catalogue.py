"""Effects by name: from a command line, a model file or a seed."""

import random
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from smarig.core import (
    DataError,
    UnknownEntry,
    UsageError,
    catalogue_entry,
    catalogue_names,
    own_entries,
    passed,
    resolve_name,
    stored_number,
)
from smarig.plant.effect import Effect, EffectType
from smarig.plant.learned_effect import (
    INPUT_BOUND,
    LEARNED,
    OUTPUT_BOUND,
    LearnedShape,
    learned_effect_type,
)

EFFECTS = "smarig.plant.effects"
NO_EFFECT_SHARE = 0.15  # share of the mystery rigs without an effect


def effect_types(arrangement: str = "") -> tuple[EffectType, ...]:
    """All effect types by name, or those that exist on rigs of one arrangement."""
    every = (catalogue_entry(EFFECTS, name) for name in catalogue_names(EFFECTS))
    return tuple(k for k in every if not arrangement or k.arrangement in ("", arrangement))


def effect_types_only_on(arrangement: str) -> tuple[EffectType, ...]:
    """The effect types that exist on one arrangement only, by name."""
    return tuple(k for k in effect_types() if k.arrangement == arrangement)


def effects_from_pairs(pairs: Iterable[str]) -> tuple[Effect, ...]:
    """Effects from texts of the form ``name``, ``name=strength`` or ``name.parameter=value``.

    >>> effects_from_pairs(["settling=3", "settling.time_constant_s=900", "creep"])
    (settling(share_percent=3, time_constant_s=900), creep(percent_per_decade=1))
    """
    values: dict[str, dict[str, float]] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        name, dot, parameter = key.strip().partition(".")
        kind: EffectType = catalogue_entry(EFFECTS, name)
        parameters_of_effect = values.setdefault(name, {})
        if not equals and not dot:
            continue
        try:
            number = float(text)
        except ValueError:
            raise UsageError(f"'{pair}' is not NAME=NUMBER or NAME.PARAMETER=NUMBER.") from None
        parameter = parameter if dot else kind.primary.name
        if parameter in parameters_of_effect:
            raise UsageError(f"'{pair}' repeats {name}.{parameter}. Give each parameter once.")
        parameters_of_effect[parameter] = number
    return tuple(
        catalogue_entry(EFFECTS, name)(**parameters_of_effect)
        for name, parameters_of_effect in values.items()
    )


def effects_from_arguments(words: Iterable[str]) -> tuple[Effect, ...]:
    """Effects as on the command line: the forms of ``effects_from_pairs``, also of plug-ins and of own files
    (``./mine.py=3``).

    Own files and plug-ins are executed. Pass texts stored in a run or a model to ``effects_from_pairs`` instead.
    """
    return effects_from_pairs([_registered_name(word) for word in words])


def _registered_name(word: str) -> str:
    word = passed(word)
    path = re.fullmatch(r"(.+\.py)((?:\..*)?(?:=.*)?)", word)
    if path:
        return f"{resolve_name(EFFECTS, path[1])}{path[2]}"
    resolve_name(EFFECTS, re.split("[.=]", word, maxsplit=1)[0].strip())
    return word


def effects_to_arguments(effects: Iterable[Effect]) -> list[str]:
    """The texts from which ``effects_from_arguments`` reads the same effects, in any folder."""
    paths = {name: file.reference for name, file in own_entries(EFFECTS).items()}
    pairs = (pair.partition(".") for pair in effects_to_pairs(effects))
    return [f"{paths.get(name, name)}{dot}{rest}" for name, dot, rest in pairs]


def effects_to_pairs(effects: Iterable[Effect]) -> list[str]:
    """The texts from which ``effects_from_pairs`` reads the same effects.

    >>> effects_to_pairs(effects_from_pairs(["settling=3"]))
    ['settling.share_percent=3.0', 'settling.time_constant_s=600.0']
    """
    return [f"{e.kind.name}.{name}={value!r}" for e in effects for name, value in e.values.items()]


def effects_from_json(records: Iterable[Mapping[str, Any]]) -> tuple[Effect, ...]:
    """Effects of a model file, each {"name", "parameters"}; a learned one has {"shape"} too.

    Raises DataError for anything else.
    """
    try:
        found_effects = tuple(_effect_from_record(**r) for r in records)
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise DataError(f"an effect is not of the form {{name, parameters}}: {error}") from None
    except UsageError as error:
        hint = " (give your own effect again with --effect ./FILE.py)"
        unknown = isinstance(error, UnknownEntry)
        raise DataError(f"{str(error).rstrip('.')}{hint * unknown}") from None
    repeated = next((name for name, n in Counter(p.kind.name for p in found_effects).items() if n > 1), None)
    if repeated:
        raise DataError(f"effect {repeated} occurs twice")
    return found_effects


def _effect_from_record(
    name: str, parameters: Mapping[str, float], shape: Mapping[str, Any] | None = None
) -> Effect:
    if shape is None and name != LEARNED:
        return catalogue_entry(EFFECTS, str(name))(**dict(parameters))
    if name != LEARNED:
        raise UsageError(f"a shape belongs to the effect '{LEARNED}', not to '{name}'")
    if not isinstance(shape, Mapping):
        raise UsageError("a learned law has an object 'shape' with variable, enters, knots and unit")
    found = LearnedShape.from_json(shape)
    names = [f"value_{k}" for k in range(1, len(found.knots))]
    if not isinstance(parameters, Mapping) or sorted(parameters) != sorted(names):
        raise UsageError(
            f"a learned law with {len(found.knots)} knots has the parameters {names[0]} to {names[-1]}"
        )
    values = {name: stored_number(parameters[name], f"{name} of a learned law") for name in names}
    bound = max(abs(value) for value in values.values()) or 1.0  # was checked when it was learned
    return learned_effect_type(found, bound / OUTPUT_BOUND + bound / INPUT_BOUND)(**values)


def mystery_effects(seed: int, arrangement: str) -> tuple[Effect, ...]:
    """The hidden effect of a seed: one of the catalogue at 0.6 to 1.8 times its typical strength, or none."""
    # Python's own generator draws the same in every version of every library
    draw = random.Random(f"mystery {arrangement} {seed}")
    if draw.random() < NO_EFFECT_SHARE:
        return ()
    kind = draw.choice([k for k in effect_types(arrangement) if k.name not in own_entries(EFFECTS)])
    strength = kind.primary.typical * draw.uniform(0.6, 1.8)
    if kind.primary.lower < 0 and draw.random() < 0.5:
        strength = -strength
    return (kind(min(max(strength, kind.primary.lower), kind.primary.upper)),)
