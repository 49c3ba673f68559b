"""Controllers tuned by one optimiser and one budget, so that a comparison compares controllers and not patience.

Nelder and Mead's simplex on the logarithms of the numbers that a controller lists in ``RANGES``, within these ranges.
"""

import importlib
import math
from collections.abc import Callable, Mapping

import numpy as np
from scipy.optimize import minimize

from smarig.control.controller_settings import TRACKING_CONTROLLERS, default_numbers
from smarig.control.tracking.controller_model import ControllerFactory
from smarig.core import catalogue_entry

FIRST_STEP = 0.7  # of a logarithm: a factor of two


def ranges(name: str) -> Mapping[str, tuple[float, float]]:
    """What may be tuned of a controller, with least and largest values."""
    return importlib.import_module(f"{TRACKING_CONTROLLERS}.{name}").RANGES


def default_settings(name: str) -> dict[str, float]:
    """Its numbers as they are without tuning."""
    all_numbers = default_numbers(TRACKING_CONTROLLERS, name)
    return {key: all_numbers[key] for key in ranges(name)}


def controller_factory(name: str, values: Mapping[str, float]) -> ControllerFactory:
    """A controller with its numbers, ready for a loop."""
    found = catalogue_entry(TRACKING_CONTROLLERS, name)
    return lambda controller_model, reference: found(controller_model, reference, **values)


def tuned_numbers(
    name: str,
    cost: Callable[[Mapping[str, float]], float],
    budget: int,
    extra_ranges: Mapping[str, tuple[float, float]] | None = None,
) -> dict[str, float]:
    """The numbers of least cost found in ``budget`` evaluations, begun at the defaults.

    ``extra_ranges``: further numbers with their ranges, begun in the middle of these.
    """
    search_ranges = {**ranges(name), **(extra_ranges or {})}
    start = {key: math.sqrt(low * high) for key, (low, high) in search_ranges.items()} | default_settings(
        name
    )
    keys = list(search_ranges)
    low, high = (np.log([search_ranges[key][k] for key in keys]) for k in (0, 1))
    centre = np.log([start[key] for key in keys])

    def at(logs: np.ndarray) -> dict[str, float]:
        return dict(zip(keys, np.exp(np.clip(logs, low, high)).tolist()))

    def costs(logs: np.ndarray) -> float:
        found = cost(at(logs))
        outside = float(np.sum(np.maximum(low - logs, 0) + np.maximum(logs - high, 0)))
        return (found if math.isfinite(found) else 1e9) * (1 + outside)

    simplex = np.vstack([centre, centre + FIRST_STEP * np.eye(len(keys))])
    best = minimize(
        costs, centre, method="Nelder-Mead", options={"maxfev": budget, "initial_simplex": simplex}
    )
    return at(best.x)
