"""Drivers of instruments, one file each."""

import inspect
from typing import Any


def misfit(name: str, found: Any) -> str:
    """Why an object cannot serve as a driver ``NAME(where, rig)``; "" if it can.

    >>> misfit("supply", lambda where: None)
    'supply must be a function supply(where, rig): a link of the rig file, and the rig file'
    """
    try:
        inspect.signature(found).bind("where", "rig")
    except (TypeError, ValueError):
        return f"{name} must be a function {name}(where, rig): a link of the rig file, and the rig file"
    return ""
