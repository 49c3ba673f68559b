"""Numbers of a controller from ``key=value``, checked against the function that makes it.

The settings of a controller are the parameters of its function that have a number as default. Its other parameters
(model, reference, schedules) cannot be given on a command line.
"""

import inspect
import math
import re
from collections.abc import Mapping
from typing import Any

from smarig.core import UsageError, catalogue_entry, suggestion

SETPOINT_CONTROLLERS = "smarig.control.regulation.controllers"
TRACKING_CONTROLLERS = "smarig.control.tracking.controllers"
VELOCITY_CONTROLLERS = "smarig.control.velocity.controllers"
_LINE = re.compile(r"^\s+(\w+) \(([^()]*)\): (.+)$", flags=re.M)
# Range of a number other than zero: its squares and quotients do not overflow.
SMALLEST, LARGEST = 1e-100, 1e12


def default_numbers(package: str, name: str) -> dict[str, float]:
    """The numbers of a controller of a catalogue, with their defaults.

    >>> default_numbers(TRACKING_CONTROLLERS, "pi")["lead_s"]
    0.0
    """
    parameters = inspect.signature(catalogue_entry(package, name)).parameters.values()
    return {p.name: p.default for p in parameters if isinstance(p.default, float)}


def optional_numbers(package: str, name: str) -> dict[str, float | None]:
    """The keyword numbers of a controller whose defaults may be None, set by the model.

    >>> optional_numbers(SETPOINT_CONTROLLERS, "pi")
    {'gain': None, 'band': None}
    """
    parameters = inspect.signature(catalogue_entry(package, name)).parameters.values()
    return {p.name: p.default for p in parameters if p.kind is p.KEYWORD_ONLY}


def documented_numbers(documented: Any) -> dict[str, tuple[str, str]]:
    """(unit, meaning) of numbers, from the lines ``name (unit): meaning`` of a controller's docstring.

    >>> documented_numbers(catalogue_entry(TRACKING_CONTROLLERS, "pi"))["integral_s"]
    ('s', 'integral time T_i')
    """
    return {name: (unit, text) for name, unit, text in _LINE.findall(documented.__doc__ or "")}


def controller_numbers(package: str, name: str, pairs: Mapping[str, Any]) -> dict[str, float]:
    """All numbers of a controller: those given, and defaults for the others. Raises UsageError for a wrong one.

    >>> controller_numbers(TRACKING_CONTROLLERS, "pi", {"integral_s": "2"})["integral_s"]
    2.0
    """
    defaults = default_numbers(package, name)
    return defaults | {key: _checked(name, key, value, defaults) for key, value in pairs.items()}


def _checked(name: str, key: str, value: Any, defaults: Mapping[str, float]) -> float:
    if key not in defaults:
        raise UsageError(f"Controller '{name}' has no number '{key}'{suggestion(key, list(defaults))}.")
    found = finite_number(f"Controller '{name}', {key}", value)
    if found < 0 or (found == 0 and defaults[key] != 0):
        at_least = "must not be negative" if defaults[key] == 0 else "must be positive"
        raise UsageError(f"Controller '{name}': {key} {at_least} (given: {value}).")
    return found


def finite_number(what: str, value: Any) -> float:
    """A finite number from text. Raises UsageError if it is not a number or out of range."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{what} is not a number (given: {value}).") from None
    except OverflowError:
        found = LARGEST * 10
    if not math.isfinite(found):
        raise UsageError(f"{what} is not finite (given: {value}).")
    if found and not SMALLEST <= abs(found) <= LARGEST:
        raise UsageError(f"{what} is outside ±{SMALLEST:g} … ±{LARGEST:g} (given: {str(value)[:24]}).")
    return found
