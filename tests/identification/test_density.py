"""Table 5.2 from Table 5.1: density, classes, reversible part."""

import numpy as np
import pytest

from smarig.identification.density_report import density_report
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, THESIS_SURFACES, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored

MU_MIN = {"one_p": -6.9e-4, "one_e": -1.9e-3, "two_p": -2.5e-4, "two_e": -1.2e-4}  # theory.md §4
REVERSIBLE = {
    "one_c": 28.8,
    "one_p": 33.7,
    "one_e": 8.2,
    "two_c": 26.2,
    "two_p": 13.1,
    "two_e": 12.6,
}  # §1, %


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_table_5_2(name):
    report = density_report(thesis_surface(name))
    assert report.M_PC
    assert name.endswith("_c") == report.M_P


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_extremes_of_the_density(name):
    s, report = thesis_surface(name), density_report(thesis_surface(name))
    if name in MU_MIN:
        assert report.mu_min == pytest.approx(
            MU_MIN[name], abs=0.05 * 10 ** np.floor(np.log10(-MU_MIN[name])) * 1.2
        )
    else:
        assert report.mu_min > 0
    rng = np.random.default_rng(4)  # no point of P_r lies beyond them
    alpha = rng.uniform(s.lower, s.upper, 200_000)
    beta = s.lower + rng.uniform(0, 1, alpha.size) * (alpha - s.lower)
    mu = s.density(alpha, beta)
    assert report.mu_min <= mu.min()
    assert report.mu_max >= mu.max()
    for value, at in ((report.mu_min, report.mu_min_at), (report.mu_max, report.mu_max_at)):
        assert float(s.density(*at)) == pytest.approx(value, rel=1e-9)
        assert s.lower <= at[1] <= at[0] <= s.upper


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_reversible_share(name):
    report = density_report(thesis_surface(name))
    assert 100 * report.reversible_share == pytest.approx(REVERSIBLE[name], abs=0.06)
    assert report.g_min >= 0


def test_tables_are_evaluated_by_their_cells():
    nodes = np.array(THESIS_PARTITIONS["two_wire"])
    a, b = np.meshgrid(nodes, nodes, indexing="ij")
    for name in ("two_c", "two_p"):
        y = np.where(b <= a, thesis_surface(name).y(a, b), np.nan)
        report = density_report(FodTable.from_arrays(nodes, nodes, y))
        assert report.M_PC
        assert (name == "two_c") == report.M_P
        # the mean of μ over a cell lies between its extremes
        analytic = density_report(thesis_surface(name))
        assert analytic.mu_min - 1e-12 <= report.mu_min <= report.mu_max <= analytic.mu_max
        assert report.cells == 55
    flat = FodTable.from_arrays([0.0, 1.0], [0.0, 1.0], [[0.0, np.nan], [0.0, 1.0]])
    assert density_report(flat).cells == 0


def test_the_mirror_has_the_same_density_elsewhere():
    s = thesis_surface("one_e")
    report, turned = density_report(s), density_report(Mirrored(s))
    assert (turned.mu_min, turned.M_P) == (report.mu_min, report.M_P)
    assert turned.mu_min_at == (-report.mu_min_at[1], -report.mu_min_at[0])
