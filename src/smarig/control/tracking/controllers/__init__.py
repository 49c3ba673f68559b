"""Controllers of position, one file each, found by file name: generators that yield currents and are sent samples.

``NAME(known, wanted, *, …)``; ``RANGES`` in the same file gives, for every number that may be tuned, the least and the
largest. An indented line of the docstring for each number, ``name (unit): meaning``, is what listings show; "unit" is
the rig's, mm or deg. What a rig's limits forbid is clipped by the loop, and shows as ``current_command_A`` of the
sample.
"""

import inspect
import math
from typing import Any


def misfit(name: str, found: Any) -> str:
    """What keeps something from being a controller, ``NAME(known, wanted, *, number=0.5, …)``; "" if nothing.

    >>> misfit("push", lambda wanted: None)
    'push must be a function push(known, wanted, *, number=0.5, …); it takes no known and wanted'
    """
    reason = _signature_fault(found)
    shape = f"{name} must be a function {name}(known, wanted, *, number=0.5, …)"
    return f"{shape}; {reason}" if reason else ""


def _signature_fault(found: Any) -> str:
    if not inspect.isfunction(found):
        return f"it is of type {type(found).__name__}"
    parameters = list(inspect.signature(found).parameters.values())
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    if len(parameters) < 2 or any(p.kind not in positional for p in parameters[:2]):
        return "it takes no known and wanted"
    return next((reason for p in parameters[2:] if (reason := _parameter_fault(p))), "")


def _parameter_fault(p: inspect.Parameter) -> str:
    if p.kind is not p.KEYWORD_ONLY:
        return f"'{p.name}' stands before the *"
    if p.default is p.empty:
        return f"its number '{p.name}' has no default"
    if type(p.default) is int:
        return f"its number '{p.name}' has a whole default: write {p.default}.0"
    if type(p.default) is not float or not (math.isfinite(p.default) and p.default >= 0):
        return f"its number '{p.name}' has the default {p.default!r}: numbers are positive, or 0 and more"
    return ""
