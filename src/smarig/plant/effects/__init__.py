"""The catalogue of physical mechanisms: one file each, found by its name, without effect at zero strength."""

from typing import Any

from smarig.plant.effect import EffectType


def misfit(name: str, found: Any) -> str:
    """The reason why an object is not an effect of that name; "" if it is one.

    >>> misfit("stretch", 3)
    'stretch must be an EffectType (smarig.plant.effect); it is of type int'
    """
    if not isinstance(found, EffectType):
        return f"{name} must be an EffectType (smarig.plant.effect); it is of type {type(found).__name__}"
    if found.name != name:
        return f'its EffectType has name="{found.name}", but must have name="{name}"'
    if not found.parameters or not found.primary.lower <= 0 <= found.primary.upper:
        return "its first parameter is the strength, so its bounds must include 0"
    return ""
