"""Drivers say to instruments what a bench wants: one file per instrument. They know registers, and no physics."""

import inspect
from typing import Any


def misfit(name: str, found: Any) -> str:
    """What keeps something from being a driver, ``NAME(where, rig)``; "" if nothing.

    >>> misfit("supply", lambda where: None)
    'supply must be a function supply(where, rig): a link of the rig file, and the rig file'
    """
    try:
        inspect.signature(found).bind("where", "rig")
    except (TypeError, ValueError):
        return f"{name} must be a function {name}(where, rig): a link of the rig file, and the rig file"
    return ""
