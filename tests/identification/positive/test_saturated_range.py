"""How far an input was swept into saturation does not spoil the measure of what switches within.

One loop of normally distributed relays is fitted, and inner reversals, which it does not contain, are predicted.
"""

import numpy as np
import pytest

from identification.made_runs import made_run
from smarig.identification import Observations
from smarig.identification.positive import fit_positive
from smarig.preisach import Preisach

NOISE = 0.003  # of the range of the output


def relays(inputs, coercivity):
    rng = np.random.default_rng(7)
    up, down = (rng.normal(at, 0.4, 4000) for at in (coercivity, -coercivity))
    on, y = np.zeros(up.size, dtype=bool), []
    for u in inputs:
        on = np.where(u > up, True, np.where(u < np.minimum(up, down), False, on))
        y.append(on.mean())
    return np.array(y)


def rising(end):
    return np.concatenate(
        [np.linspace(-end, -3, 20, endpoint=False), np.linspace(-3, 3, 90), [3 + end / 2, end]]
    )


@pytest.mark.parametrize("coercivity", [0.7, 1.0])
@pytest.mark.parametrize("end", [6.0, 20.0, 60.0])
def test_a_loop_is_fitted_however_far_it_saturates(end, coercivity):
    loop = np.concatenate([rising(end), rising(end)[::-1]])
    read = relays(loop, coercivity) + NOISE * np.random.default_rng(1).standard_normal(loop.size)
    fit = fit_positive(Observations.of_runs([made_run(loop, read)]))
    assert fit.rms < 2 * NOISE
    turns = np.array([end, -coercivity, end, 0.3 - coercivity, coercivity, -coercivity])
    inner = np.concatenate([np.linspace(a, b, 60) for a, b in zip(turns, turns[1:])])
    path = np.concatenate([rising(end), inner])
    predicted = Preisach(fit.table).simulate(path, "negative")
    error = (predicted - relays(path, coercivity))[rising(end).size :]
    assert float(np.sqrt(np.mean(error**2))) < 0.03
