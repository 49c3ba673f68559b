"""The export formats: one file each, found by file name. Each is a function ``NAME(run, path)``."""

import inspect
from typing import Any


def misfit(name: str, found: Any) -> str:
    """Why an object cannot serve as an export format ``NAME(run, path)``; "" if it can.

    >>> misfit("matlab", lambda run: None)
    'matlab must be a function matlab(run, path), which writes a run to a new file'
    """
    try:
        inspect.signature(found).bind("run", "path")
    except (TypeError, ValueError):
        return f"{name} must be a function {name}(run, path), which writes a run to a new file"
    return ""
