"""``smarig benchmark inverse``: speed and accuracy of the inverse, compared with an external root finder.

The targets are the outputs of another random walk (``forward.random_walk``), so each is reachable. Each is
inverted from the state that the previous one left. The baseline applies scipy's brentq to ``peek``, the best
method without access to the stack. Errors are relative to the output range, after the found inputs are
applied.
"""

import time
from typing import Any

import numpy as np
from scipy.optimize import brentq

from benchmarks.forward import Array, example_hystereses, random_walk, relays
from smarig.preisach import Everett, Preisach


def run(quick: bool = False) -> dict[str, Any]:
    """Figures for the measure, a table and two surfaces; ``quick`` takes a tenth of the targets."""
    n = 300 if quick else 3000
    return {"targets": n, **{name: _measured(h, n) for name, h in example_hystereses(relays()).items()}}


def _measured(h: Everett, n: int) -> dict[str, float]:
    targets = Preisach(h).simulate(random_walk(n, seed=7) * h.upper)
    operator = Preisach(h)
    operator.inverse(targets[0].item())  # the monotonicity check runs once per operator
    begin = time.process_time()
    u = operator.inverse_trajectory(targets)
    smarig_s = time.process_time() - begin
    begin = time.process_time()
    by_peek = _by_peek(h, targets)
    reference_s = time.process_time() - begin
    error, error_by_peek = (
        float(np.max(np.abs(Preisach(h).simulate(v) - targets)) / np.ptp(targets)) for v in (u, by_peek)
    )
    return {
        "per_s": n / smarig_s,
        "ratio_to_brentq_on_peek": reference_s / smarig_s,
        "round_trip_error_of_range": error,
        "round_trip_error_of_brentq_on_peek": error_by_peek,
    }


def _by_peek(h: Everett, targets: Array) -> Array:
    operator = Preisach(h)
    found = []
    for target in targets.tolist():
        up = target > operator.y
        u = operator.u
        if target != operator.y:
            end = h.upper if up else h.lower
            width = 1e-14 * h.upper
            root: Any = brentq(lambda v, y=target: operator.peek(v) - y, operator.u, end, xtol=width)
            u = float(root)
        operator.step(u)
        found.append(u)
    return np.array(found)
