"""The forms of the analytic surface (5.5), one file each, found by its name."""

import inspect
from typing import Any

_ATTRIBUTES = ("powers", "colour", "place")


def misfit(name: str, found: Any) -> str:
    """The reason why an object is not a form of that name; "" if it is one.

    >>> misfit("linear", 3)
    'linear must be a SurfaceForm (smarig.preisach.hysteresis.surface_form); it is of type int'
    """
    from smarig.preisach.hysteresis.surface_form import SurfaceForm  # imports numpy; names are needed without

    if inspect.isclass(found) or not isinstance(found, SurfaceForm):
        kind = f"it is {'the class' if inspect.isclass(found) else 'of type'} "
        type_name = found.__name__ if inspect.isclass(found) else type(found).__name__
        return f"{name} must be a SurfaceForm (smarig.preisach.hysteresis.surface_form); {kind}{type_name}"
    missing = [attribute for attribute in _ATTRIBUTES if not hasattr(found, attribute)]
    return f"{name} has no {', '.join(missing)}" if missing else ""
