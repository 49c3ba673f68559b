"""The choice of the surface: held-out curves are not used for fitting, and intervals and negative mass are
correct."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from identification.made_runs import fod_inputs, fod_run, made_run
from smarig.core.errors import DataError
from smarig.identification.fod_data import FodData, fod_data
from smarig.identification.positive import Observations, fit_positive
from smarig.identification.surface.choose_surface import (
    SIMPLER_TOLERANCE,
    choose_surface,
    negative_share,
    rms_interval,
    thinning_mask,
)
from smarig.identification.surface.surface_kinds import kinds_by_freedom, surface_kinds
from smarig.preisach.hysteresis.fod_surface import FodSurface
from smarig.preisach.hysteresis.fod_table import FodTable
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.operator import Preisach

TABLE_5_2 = {name: name.endswith("_c") for name in THESIS_SURFACES}  # in M_P


def of_masses(masses, nodes):
    """A table from the masses of its cells, diagonal ones included."""
    n = len(nodes)
    y = np.zeros((n, n))
    y[1:, 1:] = np.cumsum(np.cumsum(np.tril(masses), axis=0), axis=1)
    return FodTable.from_arrays(nodes, nodes, np.where(np.tri(n, dtype=bool), y, np.nan))


def two_hills(n=61):
    """A measure without negative mass that no form of (5.5) describes: two hills apart."""
    u = np.linspace(0.0, 100.0, n)
    m = (u[1:] + u[:-1]) / 2
    a, b = m[:, None], m
    hills = np.exp(-((a - 40) ** 2 + (b - 15) ** 2) / 150) + 1.5 * np.exp(
        -((a - 80) ** 2 + (b - 55) ** 2) / 200
    )
    return of_masses(hills + 0.02, u)


@pytest.fixture(scope="module")
def compared():
    """One choice for each surface of Table 5.1, on exact curves."""
    return {name: choose_surface(fod_data(fod_run(name))) for name in THESIS_SURFACES}


# --- the comparison ---------------------------------------------------------------------------------------


@pytest.mark.long("takes five seconds")
def test_every_kind_has_an_error_an_interval_and_a_share(compared):
    for choice in compared.values():
        assert (
            tuple(choice.held_out_rms)
            == tuple(choice.held_out_interval)
            == tuple(choice.negative_share)
            == surface_kinds()
        )
        for kind, rms in choice.held_out_rms.items():
            low, high = choice.held_out_interval[kind]
            assert 0 <= low <= rms <= high


@pytest.mark.long("takes four seconds")
def test_the_same_data_gives_the_same_choice(compared):
    again = choose_surface(fod_data(fod_run("two_p")))
    assert again == compared["two_p"]


def test_the_positive_measure_beats_every_other_kind_without_negative_mass_and_the_table(compared):
    """The thesis's trade-off: a constant surface in M_P, or a good fit (Tables 5.1, 5.2)."""
    for name, in_M_P in TABLE_5_2.items():
        rms = compared[name].held_out_rms
        assert rms["positive"] < rms["table"]
        if not in_M_P:
            assert rms["positive"] < rms["constant"]


@pytest.mark.long("takes a second")
def test_a_shape_of_no_form_is_best_met_by_the_positive_measure():
    levels = np.linspace(0.0, 100.0, 15)
    y = Preisach.from_surface(two_hills()).simulate(fod_inputs(levels))
    noise = np.random.default_rng(5).normal(0, 2e-3 * np.ptp(y), y.size)
    choice = choose_surface(fod_data(made_run(fod_inputs(levels), y + noise)))
    assert choice.kind == "positive"
    assert choice.held_out_rms["positive"] < 0.7 * min(
        v for k, v in choice.held_out_rms.items() if k != "positive"
    )


def test_a_simpler_kind_is_chosen_unless_a_freer_one_predicts_a_tenth_better(compared):
    levels = {kind: k for k, level in enumerate(kinds_by_freedom()) for kind in level}
    assert (
        levels["constant"]
        < levels["parabolic"]
        == levels["exponential"]
        < levels["positive"]
        < levels["table"]
    )
    for name, choice in compared.items():
        enough = SIMPLER_TOLERANCE * min(choice.held_out_rms.values())
        assert choice.held_out_rms[choice.kind] <= enough
        simpler = [k for k in surface_kinds() if levels[k] < levels[choice.kind]]
        assert all(choice.held_out_rms[k] > enough for k in simpler), name


# --- held out is held out ---------------------------------------------------------------------------------


def test_the_table_misses_curves_it_would_meet_exactly():
    assert choose_surface(fod_data(fod_run("two_c"))).held_out_rms["table"] > 0.1


@pytest.mark.long("takes a second")
def test_the_positive_errors_are_those_of_fits_without_the_curves():
    data = fod_data(fod_run("two_p", seed=2))
    whole = fit_positive(Observations.of_fod(data))
    held = np.unique(data.alpha)[1:-1]
    squares = []
    for group in range(5):
        out = np.isin(data.alpha, held[group::5])
        train = Observations.of_fod(data.where(~out))
        fit = fit_positive(train, smoothing=whole.smoothing, nodes=whole.triangle.nodes)
        for alpha in held[group::5]:
            mine = data.alpha == alpha
            squares.append(np.mean((fit.y(data.alpha[mine], data.beta[mine]) - data.y[mine]) ** 2))
    assert choose_surface(data).held_out_rms["positive"] == pytest.approx(np.sqrt(np.mean(squares)), rel=0.01)


def test_a_wrong_curve_shows_in_the_held_out_error():
    data = fod_data(fod_run("one_c", seed=1))
    alpha = np.unique(data.alpha)[5]
    spoilt = data.y + 2.0 * ((data.alpha == alpha) & (data.beta < alpha) & (data.beta > data.lower))
    rms = choose_surface(replace(data, y=spoilt)).held_out_rms
    for kind in surface_kinds():
        assert rms[kind] > 1.5 * np.sqrt(0.75 / 8)  # one curve of eight, most of its points 2 mm off


def test_too_few_curves_are_refused_with_what_to_do():
    with pytest.raises(DataError, match=r"at least 4; there are 3\. Name a surface"):
        choose_surface(fod_data(fod_run("one_e", partition=[0.0, 60.0, 120.0, 174.1])))


# --- intervals --------------------------------------------------------------------------------------------


@given(st.lists(st.floats(1e-6, 1e3), min_size=2, max_size=12), st.floats(0.1, 10.0))
def test_an_interval_holds_the_rms_lies_among_the_curves_and_scales(squares, factor):
    squares = np.array(squares)
    low, high = rms_interval(squares)
    assert np.sqrt(squares.min()) * (1 - 1e-12) <= low <= high <= np.sqrt(squares.max()) * (1 + 1e-12)
    scaled = rms_interval(squares * factor**2)
    np.testing.assert_allclose(scaled, [factor * low, factor * high], rtol=1e-9)


def test_a_ninety_percent_interval_holds_the_true_rms_nine_times_in_ten():
    rng = np.random.default_rng(7)
    draws = rng.chisquare(4, size=(300, 40)) / 4  # mean square errors whose mean is 1
    inside = [low <= 1 <= high for low, high in map(rms_interval, draws)]
    assert 0.83 <= np.mean(inside) <= 0.96


# --- negative mass ----------------------------------------------------------------------------------------


def test_the_share_of_injected_masses_is_met_exactly():
    masses = np.zeros((4, 4))
    masses[2, 0], masses[3, 1], masses[3, 0], masses[1, 0] = 3.0, 2.0, -1.0, -0.5
    masses[2, 2] = 40.0  # reversible, on the diagonal: no part of μ
    assert negative_share(of_masses(masses, np.array([0.0, 1.0, 2.5, 3.0, 7.0]))) == pytest.approx(1.5 / 6.5)
    assert negative_share(of_masses(np.zeros((4, 4)), np.arange(5.0))) == 0.0


@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_the_share_of_a_surface_is_that_of_its_density(name):
    s = thesis_surface(name)
    rng = np.random.default_rng(9)
    alpha, beta = np.sort(rng.uniform(s.lower, s.upper, (2, 400_000)), axis=0)[::-1]
    mu = s.density(alpha, beta)
    share = np.sum(np.maximum(-mu, 0)) / np.sum(np.abs(mu))
    assert negative_share(s) == pytest.approx(share, abs=0.001)
    assert (negative_share(s) == 0) == TABLE_5_2[name]


def test_positive_has_no_negative_mass_and_what_crosses_has(compared):
    for name, choice in compared.items():
        assert choice.negative_share["positive"] == 0.0
        form = {"c": "constant", "p": "parabolic", "e": "exponential"}[name[-1]]
        assert choice.negative_share[form] == pytest.approx(negative_share(thesis_surface(name)), abs=1e-3)


# --- thinning ---------------------------------------------------------------------------------------------


@given(st.lists(st.integers(1, 40), min_size=1, max_size=30), st.integers(5, 200))
def test_thinning_keeps_about_the_requested_number_evenly_and_the_ends_of_long_curves(lengths, most):
    curve = np.repeat(np.arange(len(lengths)), lengths)
    kept = np.flatnonzero(thinning_mask(curve, most))
    stride = max(1, -(-curve.size // most))
    assert np.all(np.diff(kept) <= stride)
    assert kept.size <= min(curve.size, most + 2 * sum(n > stride for n in lengths) + 1)
    first = np.cumsum([0, *lengths[:-1]])
    for begin, n in zip(first, lengths):
        if n > stride:
            assert {begin, begin + n - 1} <= set(kept.tolist())
    if stride == 1:
        assert kept.size == curve.size


def test_curves_of_one_point_in_thousands_do_not_decide_anything():
    """Thinning may remove a very short curve from the fit; it is still evaluated, and no score is empty."""
    u = np.linspace(0.0, 1.0, 60)
    rows = [(k, u[k], u[j]) for k in range(2, 60) for j in range(k + 1)] + [
        (60, 0.011, 0.011),
        (61, 0.012, 0.012),
    ]
    curve, alpha, beta = (np.array(column) for column in zip(*rows))
    surface = FodSurface("constant", (8.0, -0.4, 12.0, -0.3), 0.0, 1.0, 0.0, 1.0)
    y = surface.y(alpha, beta)
    n = np.arange(y.size)
    data = FodData(alpha, beta, y, curve.astype(np.int64), alpha == beta, 0 * n, n, "mm", 0.0, 1.0, False)
    choice = choose_surface(data)
    assert np.isfinite(list(choice.held_out_rms.values())).all()
    assert choice.kind in ("constant", "exponential")
