"""The catalogue of physical mechanisms: one file each, found by its name, the identity at zero strength."""

from typing import Any

from smarig.plant.effect import EffectType


def misfit(name: str, found: Any) -> str:
    """What keeps something from being an effect of that name; "" if nothing.

    >>> misfit("stretch", 3)
    'stretch must be an EffectType (smarig.plant.effect); it is of type int'
    """
    if not isinstance(found, EffectType):
        return f"{name} must be an EffectType (smarig.plant.effect); it is of type {type(found).__name__}"
    if found.name != name:
        return f'its EffectType says name="{found.name}" and must say name="{name}"'
    if not found.parameters or not found.primary.lower <= 0 <= found.primary.upper:
        return "its first parameter is its strength, whose bounds must hold 0"
    return ""
