"""Tunes controllers with one optimiser and one budget, so that comparisons do not depend on tuning effort.

The method is the Nelder-Mead simplex on the logarithms of the numbers in a controller's ``RANGES``, within these
ranges.
"""

import importlib
import math
from collections.abc import Callable, Mapping

import numpy as np
from scipy.optimize import minimize

from smarig.control.controller_settings import TRACKING_CONTROLLERS, default_numbers
from smarig.control.tracking.controller_model import ControllerFactory
from smarig.core import catalogue_entry

FIRST_STEP = 0.7  # in the logarithm: a factor of two


def ranges(name: str) -> Mapping[str, tuple[float, float]]:
    """The tunable numbers of a controller, with smallest and largest values."""
    return importlib.import_module(f"{TRACKING_CONTROLLERS}.{name}").RANGES


def default_settings(name: str) -> dict[str, float]:
    """The default values of the tunable numbers."""
    all_numbers = default_numbers(TRACKING_CONTROLLERS, name)
    return {key: all_numbers[key] for key in ranges(name)}


def controller_factory(name: str, values: Mapping[str, float]) -> ControllerFactory:
    """A factory of a controller with its numbers."""
    found = catalogue_entry(TRACKING_CONTROLLERS, name)
    return lambda controller_model, reference: found(controller_model, reference, **values)


def tuned_numbers(
    name: str,
    cost: Callable[[Mapping[str, float]], float],
    budget: int,
    extra_ranges: Mapping[str, tuple[float, float]] | None = None,
) -> dict[str, float]:
    """The numbers of lowest cost found in ``budget`` evaluations, starting from the defaults.

    ``extra_ranges``: further numbers with their ranges, starting in the middle.
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
