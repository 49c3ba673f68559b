"""Position controllers, one file each, found by file name: generators that yield currents and receive samples.

Signature: ``NAME(known, wanted, *, …)``. ``RANGES`` in the same file gives the smallest and largest value of every
tunable number. An indented docstring line for each number, ``name (unit): meaning``, appears in listings; "unit" is
that of the rig, mm or deg. The loop clips a current beyond the rig's limits; ``current_command_A`` of the sample shows
the result.
"""

import inspect
import math
from typing import Any


def misfit(name: str, found: Any) -> str:
    """Why an object cannot serve as a controller ``NAME(known, wanted, *, number=0.5, …)``; "" if it can.

    >>> misfit("push", lambda wanted: None)
    'push must be a function push(known, wanted, *, number=0.5, …); it lacks the parameters known and wanted'
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
        return "it lacks the parameters known and wanted"
    return next((reason for p in parameters[2:] if (reason := _parameter_fault(p))), "")


def _parameter_fault(p: inspect.Parameter) -> str:
    if p.kind is not p.KEYWORD_ONLY:
        return f"'{p.name}' must come after the *"
    if p.default is p.empty:
        return f"its number '{p.name}' has no default"
    if type(p.default) is int:
        return f"the default of its number '{p.name}' is an integer: write {p.default}.0"
    if type(p.default) is not float or not (math.isfinite(p.default) and p.default >= 0):
        return f"the default of its number '{p.name}' is {p.default!r}; it must be a finite number ≥ 0"
    return ""
