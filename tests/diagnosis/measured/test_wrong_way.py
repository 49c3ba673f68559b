"""A rate-independent loop that runs the wrong way looks like a lag at one rate, until a model with the lag is asked."""

import numpy as np
import pytest

from diagnosis.measured.independent_wire import as_run
from smarig.diagnosis import diagnose
from smarig.identification import identify

pytestmark = pytest.mark.usefixtures("few_readings")


def ramps(points):
    """An input that moves by 1 in each row."""
    parts = [np.linspace(a, b, int(abs(b - a)) + 1)[1:] for a, b in zip(points[:-1], points[1:], strict=True)]
    return np.concatenate([[points[0]], *parts])


def ahead(u):
    """An output that leads by a Bouc–Wen variable of the wrong sign."""
    z = np.zeros(u.size)
    for k, step in enumerate(np.diff(u)):
        z[k + 1] = z[k] + step - 0.05 * abs(step) * z[k] - 0.02 * step * abs(z[k])
    return 0.05 * (u + 0.6 * z)


FIRST = ramps([0.0, *(x for peak in np.linspace(90, 9, 9) for x in (peak, 0.0))])
LATER = ramps([0.0, 90.0, 0.0, 30.0, 65.0, 30.0, 65.0, 30.0, 90.0, 0.0])[1:]


def diagnosed(read, y):
    """The diagnosis of a record whose later part is held out."""
    at = slice(FIRST.size), slice(FIRST.size, None)
    parts = [
        as_run(n, read[s], y[s], dt=0.1, noise=(0.01, 0.003), seed=k)
        for k, (n, s) in enumerate(zip("ab", at, strict=True))
    ]
    parts[1].columns["t_s"] += 0.1 * FIRST.size
    parts[1].meta["initial"] = "continued"
    parts[0].meta["imported"] = {"sha256": "a" * 64}
    parts[1].meta["imported"] = {"sha256": "b" * 64, "continues_sha256": "a" * 64}
    return diagnose(identify(parts[0], "positive").model, parts[:1], parts[1:])


def test_a_lag_whose_model_leaves_most_of_the_held_out_error_is_no_name():
    u = np.r_[FIRST, LATER]
    found = diagnosed(u, ahead(u))
    assert (found.verdict.word, found.verdict.reason) == ("unknown", "not_borne_out")
    assert not found.findings
