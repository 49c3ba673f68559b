"""ψ(ℓ) = r(B_ℓ) (Thm 8.5): continuous, onto, and the least ℓ, against columns of the printed surfaces."""

import numpy as np
import pytest

from preisach.relay_reference import TABLE_5_1, Printed, cells, lower_half
from smarig.control.regulation import Psi
from smarig.core.errors import UsageError
from smarig.identification.positive import Observations, fit_positive
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_PARTITIONS, thesis_surface
from smarig.preisach.hysteresis.mirrored import Mirrored
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach

NAMES = tuple(TABLE_5_1)


def by_columns(y, lower, upper, y_lower, ell, n=2000):
    """r(B_ℓ) column by column from outputs y(α, β) alone: a column of relays that is up to α holds y(α, ·)'s change."""
    beta = np.linspace(lower, ell, n + 1)
    alpha = np.clip(2 * ell - (beta[1:] + beta[:-1]) / 2, None, upper)
    return y_lower + float(np.sum(y(alpha, beta[1:]) - y(alpha, beta[:-1])))


@pytest.fixture(scope="module")
def positive():
    """A positive measure fitted to the noisy first-order curves of a surface that is negative somewhere."""
    truth, levels = thesis_surface("one_p"), np.array(THESIS_PARTITIONS["one_wire"])
    i, j = np.tril_indices(levels.size)
    y = truth.y(levels[i], levels[j]) + 0.02 * np.random.default_rng(3).standard_normal(i.size)
    observations = Observations.of_points(
        levels[i], levels[j], y, i.astype(np.int64), (levels[0], levels[-1]), "mm"
    )
    return fit_positive(observations, intervals=16, smoothing=1e-9).table


@pytest.mark.parametrize("name", NAMES)
def test_it_is_the_output_of_the_columns_below_the_diagonal(name):
    printed, psi = Printed(name), Psi(thesis_surface(name))
    for ell in np.linspace(printed.lower, printed.upper, 14):
        expected = by_columns(printed.y, printed.lower, printed.upper, printed.y_lower, ell)
        assert psi(ell) == pytest.approx(expected, abs=1e-5 * printed.range)


@pytest.mark.parametrize("name", ["one_p", "two_e"])
def test_it_is_the_output_of_the_relays_of_the_diagonal_state(name):
    printed, psi = Printed(name), Psi(thesis_surface(name))
    ell = printed.lower + 0.3 * (printed.upper - printed.lower)
    near = ell + np.linspace(printed.lower - ell, ell - printed.lower, 25)
    levels = np.append(near, np.linspace(near[-1], printed.upper, 8)[1:])
    relays = cells(levels, printed.y, ell, lower_half(printed.y_alpha_beta))
    assert psi(ell) == pytest.approx(printed.y_lower + relays.nu[relays.on].sum(), abs=1e-10)


def test_so_it_is_for_a_fitted_positive_measure(positive):
    psi = Psi(positive)
    for ell in np.linspace(psi.lower, psi.upper, 9):
        expected = by_columns(positive.y, psi.lower, psi.upper, psi.y_lower, ell, n=20_000)
        assert psi(ell) == pytest.approx(expected, abs=1e-5 * (psi.y_upper - psi.y_lower))
    assert psi.monotone, "no mass is negative, so ψ cannot fall"


def continuous_and_onto(psi):
    span = psi.y_upper - psi.y_lower
    steps = [np.max(np.abs(np.diff(psi(np.linspace(psi.lower, psi.upper, n + 1))))) for n in (100, 400)]
    assert steps[1] < 0.3 * steps[0], "a quarter of the step, a quarter of the change: no jumps"
    assert psi(psi.lower) == psi.y_lower
    assert psi(psi.upper) == pytest.approx(psi.y_upper, abs=1e-12 * span)
    wanted = np.linspace(psi.y_lower, psi.y_upper, 21)
    assert np.max(np.abs(psi(psi.right_inverse(wanted)) - wanted)) < 1e-11 * span


@pytest.mark.parametrize("name", NAMES)
def test_it_is_continuous_and_onto(name):
    continuous_and_onto(Psi(thesis_surface(name)))


def test_it_is_continuous_and_onto_for_a_fitted_positive_measure(positive):
    continuous_and_onto(Psi(positive))


@pytest.mark.parametrize("name", NAMES)
def test_no_smaller_ell_has_that_output(name):
    psi, printed = Psi(thesis_surface(name)), Printed(name)
    assert psi.monotone == (name != "one_p")
    for y in np.linspace(psi.y_lower, psi.y_upper, 7)[1:-1]:
        right_inverse = psi.right_inverse(y)
        for ell in np.linspace(printed.lower, right_inverse, 200)[:-1]:
            assert by_columns(printed.y, psi.lower, psi.upper, psi.y_lower, ell, n=200) < y + 1e-4


def test_where_one_wire_p_turns_back_the_first_of_three_is_taken():
    psi = Psi(thesis_surface("one_p"))
    ell = np.linspace(70.0, 100.0, 1001)
    values = psi(ell)
    top = int(np.argmax(values[:500]))
    bottom = top + int(np.argmin(values[top:]))
    assert values[top] - values[bottom] > 1e-3, "it does turn back"
    y = (values[top] + values[bottom]) / 2
    crossings = ell[:-1][np.diff(np.sign(values - y)) != 0]
    assert crossings.size == 3
    assert crossings[0] <= psi.right_inverse(y) <= crossings[0] + 0.03
    assert psi.right_inverse(values[top] + 1e-5) > ell[bottom], "just above the top it is past the fold"
    near = np.linspace(ell[top - 1], ell[top + 1], 301)
    highest = float(np.max(psi(near)))
    assert psi.right_inverse(highest - 1e-9) < near[-1], "just below it is not, however close"


def test_single_relays_jump_and_the_least_ell_brings_at_least_the_output():
    relays = RelayMeasure.from_arrays([3.0, 4.0, 6.0], [1.0, 4.0, 2.0], [1.0, 2.0, 4.0])
    psi = Psi(relays)
    assert not psi.continuous
    assert [psi(ell) for ell in (1.0, 2.0, 2.1, 3.9, 4.1, 6.0)] == [-7.0, -7.0, -5.0, -5.0, 7.0, 7.0]
    assert psi(4.0) == -1.0, "at its middle a wide relay is not up yet, a degenerate one is"
    for y, ell in ((-7.0, 1.0), (-6.0, 2.0), (-5.0, 2.0), (-4.0, 4.0), (0.0, 4.0), (7.0, 4.0)):
        assert psi.right_inverse(y) == pytest.approx(ell, abs=1e-12)
        assert psi(psi.right_inverse(y)) >= y
    mirror = Psi(Mirrored(relays))
    assert mirror(mirror.right_inverse(3.0)) >= 3.0


def test_it_equals_the_output_of_the_operator():
    psi, operator = Psi(thesis_surface("two_e")), Preisach(thesis_surface("two_e"))
    assert psi(np.array([[-40.0], [70.0]])).shape == (2, 1)
    assert psi(-40.0) == operator.go_to_diagonal(-40.0)


def test_set_points_and_centres_outside_are_refused_in_one_sentence():
    psi = Psi(thesis_surface("one_e"))
    with pytest.raises(UsageError, match=r"set-point 13 is outside .* \[0, 12.54\]. Give one inside\.$"):
        psi.right_inverse(13.0)
    for bad in (-0.1, float("nan")):
        with pytest.raises(UsageError, match="outside"):
            psi.right_inverse(bad)
    with pytest.raises(UsageError, match="no state B_ℓ for ℓ = 180"):
        psi([10.0, 180.0])


def test_what_is_no_hysteresis_is_refused():
    with pytest.raises(UsageError, match="ψ needs a hysteresis, such as a model's, not a str"):
        Psi("a")
