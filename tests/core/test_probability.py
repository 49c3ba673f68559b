"""Tail probabilities and quantiles equal those of scipy.stats, also at the ends, without importing it."""

import subprocess
import sys
from operator import attrgetter

import numpy as np
import pytest

from smarig.core import (
    beta_quantile,
    chi2_quantile,
    chi2_tail,
    f_quantile,
    f_tail,
    normal_quantile,
    t_quantile,
    t_tail,
)

PAIRS = {
    "χ² tail": (chi2_tail, "chi2.sf", 1),
    "χ² quantile": (chi2_quantile, "chi2.ppf", 1),
    "F tail": (f_tail, "f.sf", 2),
    "F quantile": (f_quantile, "f.ppf", 2),
    "β quantile": (beta_quantile, "beta.ppf", 2),
    "t tail": (t_tail, "t.sf", 1),
    "t quantile": (t_quantile, "t.ppf", 1),
    "normal quantile": (normal_quantile, "norm.ppf", 0),
}
ENDS = (-1.0, 0.0, 1e-300, float("inf"), float("nan"))


@pytest.mark.parametrize("name", PAIRS)
def test_it_is_that_of_scipy_stats(name):
    from scipy import stats

    own, of_scipy, parameters = PAIRS[name]
    reference = attrgetter(of_scipy)(stats)
    rng = np.random.default_rng(3)
    values = rng.uniform(0.001, 0.999, 40) if "quantile" in name else [*ENDS, *rng.exponential(4.0, 40)]
    for x in values:
        freedom = [float(n) for n in rng.integers(1, 300, parameters)]
        np.testing.assert_equal(own(float(x), *freedom), float(reference(x, *freedom)))


@pytest.mark.parametrize(("own", "freedom"), [(chi2_tail, [0.0]), (f_tail, [0.0, 3.0]), (f_tail, [2.0, 0.0])])
def test_without_degrees_of_freedom_there_is_no_probability(own, freedom):
    assert np.isnan(own(1.0, *freedom))


def test_a_characterisation_loads_neither_scipy_stats_nor_scipy_signal():
    """All modules of it, in a process of its own: each of the two takes as long as a whole identification."""
    program = """
import sys
import smarig.app.characterise, smarig.diagnosis.diagnose, smarig.diagnosis.comparison.measured.measured_diagnosis
import smarig.certificate.robust_certificate, smarig.identification.extended.choose_extension, smarig.report.drawing
print([name for name in ("scipy.stats", "scipy.signal", "matplotlib.backends.backend_pdf") if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
