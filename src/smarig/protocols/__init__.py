"""Experiments as inert generators, one file each; the file name is the name on the command line."""

import inspect
from typing import Any, get_type_hints


def misfit(name: str, found: Any) -> str:
    """What keeps something from being a protocol, ``NAME(setup, *, setting: type = default, …)``; "" if nothing.

    >>> misfit("hold", lambda: None)
    'hold must be a function hold(setup, *, setting: type = default, …); it takes no setup'
    """
    reason = _misfit_reason(found)
    shape = f"{name} must be a function {name}(setup, *, setting: type = default, …)"
    return f"{shape}; {reason}" if reason else ""


def _misfit_reason(found: Any) -> str:
    if not inspect.isfunction(found):
        return f"it is of type {type(found).__name__}"
    parameters = [p for p in inspect.signature(found).parameters.values() if p.name != "chooser"]
    if not parameters or parameters[0].kind not in (
        inspect.Parameter.POSITIONAL_ONLY,
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
    ):
        return "it takes no setup"
    try:
        hints = get_type_hints(found)
    except Exception as error:
        return f"its types cannot be understood ({error})"
    for p in parameters[1:]:
        if p.kind is not p.KEYWORD_ONLY:
            return f"'{p.name}' stands before the *"
        if p.default is p.empty:
            return f"its setting '{p.name}' has no default"
        if p.name not in hints:
            return f"its setting '{p.name}' has no type"
    return ""
