"""Steady loops: every closing loop is found with its tips, branches and faults."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from identification.made_runs import driven_run, made_run
from smarig.exchange import import_file
from smarig.identification.steady_loops import steady_loops
from smarig.record import load_run


def swept(*turns, step=1.0):
    """Inputs that visit every multiple of ``step`` on the way from turn to turn."""
    path = [float(turns[0])]
    for target in turns[1:]:
        n = round(abs(target - path[-1]) / step)
        path += np.linspace(path[-1], target, n + 1)[1:].tolist()
    return np.array(path)


def rayleigh(amplitude, *, n=65, a=0.012, nu=2.4e-4):
    """A loop of Rayleigh's law, upper tip first: b = (a + ν h_m) h ± ν/2 (h_m² − h²); its own mirror image."""
    h = np.concatenate([np.linspace(amplitude, -amplitude, n), np.linspace(-amplitude, amplitude, n)[1:]])
    falling = np.arange(h.size) < n
    return h, (a + nu * amplitude) * h + np.where(falling, 0.5, -0.5) * nu * (amplitude**2 - h**2)


def numbered(*loops, numbers=range(9)):
    """A run of loops measured one by one: no steps, no time, the loop's number in column 'step'."""
    run = made_run(np.concatenate([u for u, _ in loops]), np.concatenate([y for _, y in loops]), initial="")
    step = np.concatenate([np.full(u.size, k, dtype=float) for k, (u, _) in zip(numbers, loops)])
    return replace(run, steps=(), columns=run.columns | {"step": step})


# --- what is found ------------------------------------------------------------------------------------------


def test_numbered_loops_keep_their_numbers_tips_and_branches():
    run = numbered(*(rayleigh(a) for a in (6.0, 10.0, 20.0)), numbers=(2, 3, 7))
    loops = steady_loops(run)
    assert [loop.number for loop in loops] == [2, 3, 7]
    for loop, amplitude in zip(loops, (6.0, 10.0, 20.0), strict=True):
        top = (0.012 + 2.4e-4 * amplitude) * amplitude
        assert loop.upper == pytest.approx((amplitude, top))
        assert loop.lower == pytest.approx((-amplitude, -top))
        assert loop.rising.shape == loop.falling.shape == (65, 2)
        assert (np.diff(loop.rising[:, 0]) > 0).all()
        assert (np.diff(loop.falling[:, 0]) < 0).all()
        assert loop.falling[32, 1] == pytest.approx(1.2e-4 * amplitude**2)  # remanence: the upper branch
        assert loop.output_range == pytest.approx(2 * top)
        assert loop.closure == 0


def test_a_nested_loop_is_taken_out_and_the_branch_goes_on_as_if_it_had_not_been():
    with_inner = driven_run("one_c", swept(0, 174, 60, 120, 0))
    without = driven_run("one_c", swept(0, 174, 0))
    inner, outer = steady_loops(with_inner)
    (plain,) = steady_loops(without)
    assert (inner.lower[0], inner.upper[0]) == (60, 120)
    assert (outer.lower[0], outer.upper[0]) == (0, 174)
    assert inner.closure == pytest.approx(0, abs=1e-12)  # wiping-out, §3.3.1
    np.testing.assert_allclose(np.unique(outer.falling, axis=0), np.unique(plain.falling, axis=0), atol=1e-12)
    np.testing.assert_array_equal(outer.rising, plain.rising)


def test_cycles_in_a_row_are_loops_each_of_its_own():
    run = driven_run("two_c", swept(-185, 100, -185, 100, -185, 100, -185))
    loops = steady_loops(run)
    assert [loop.number for loop in loops] == [0, 1, 2]
    for loop in loops:
        np.testing.assert_allclose(loop.falling, loops[0].falling, atol=1e-12)


def test_a_loop_begun_half_way_is_put_together():
    u, y = rayleigh(10.0)
    whole = steady_loops(numbered((u, y)))[0]
    turned = np.roll(u[:-1], 40), np.roll(y[:-1], 40)  # begins on the rising branch
    (half_way,) = steady_loops(numbered(tuple(np.append(x, x[0]) for x in turned)))
    assert (half_way.lower, half_way.upper) == (whole.lower, whole.upper)
    np.testing.assert_array_equal(np.unique(half_way.rising, axis=0), whole.rising)
    np.testing.assert_array_equal(half_way.falling, whole.falling)
    assert half_way.closure == 0


def test_small_reversals_are_noise_of_their_branch():
    u, y = rayleigh(10.0)
    noisy = u.copy()
    noisy[10:120:3] += 0.4  # more than a step: back and forth
    (loop,) = steady_loops(numbered((noisy, y)))
    assert len(loop.rising) + len(loop.falling) == u.size + 1
    assert len(steady_loops(numbered((noisy, y)), smallest=1e-3)) > 1


def test_a_tip_that_was_passed_between_two_readings_is_interpolated():
    u = np.array([0.0, 10, 20, 8, 15, 5, -5, 0])  # 8 → 15 → 5 passes 8 on the way
    (inner,) = [loop for loop in steady_loops(made_run(u, 2 * u), smallest=0.1) if loop.upper[0] == 15]
    assert inner.lower == (8.0, 16.0)
    assert inner.falling[-1].tolist() == [8.0, 16.0]
    assert inner.closure == 0


@pytest.mark.parametrize("turns", [(0, 174), (0, 174, 60), (0, 174, 40, 120, 80), (90, 100, 60, 150, 0)])
def test_what_never_comes_back_is_no_loop(turns):
    assert steady_loops(driven_run("one_c", swept(*turns))) == []


@pytest.mark.parametrize("n", [0, 1, 2])
def test_too_few_readings_are_no_loop(n):
    assert steady_loops(made_run([0.0, 1.0][:n], [0.0, 1.0][:n])) == []


@given(st.lists(st.integers(0, 17), min_size=3, max_size=12))
@example([17, 6, 12, 0])
def test_whatever_the_input_every_loop_of_a_preisach_hysteresis_closes(levels):
    turns = [10.0 * k for k in levels]  # no two of them are one within 5 % of any swing
    run = driven_run("one_c", swept(0, *turns, step=10.0))
    loops = steady_loops(run, smallest=1e-6)
    assert all(abs(loop.closure) < 1e-9 for loop in loops)
    assert all(loop.falling[-1].tolist() == pytest.approx(list(loop.lower), abs=1e-9) for loop in loops)
    assert max(turns) == 0 or turns[-1] > 0 or loops  # back at zero something has closed
    swings = sum(np.ptp(loop.rising[:, 0]) for loop in loops)
    assert 2 * swings <= np.abs(np.diff(run["input"])).sum() + 1e-9  # no branch is used twice


# --- what is wrong with a loop -------------------------------------------------------------------------------


def test_drift_opens_a_loop_by_as_much_as_it_drifted():
    u, y = rayleigh(10.0)
    half_way = tuple(np.append(np.roll(x[:-1], 40), np.roll(x[:-1], 40)[0]) for x in (u, y))
    for begun in ((u, y), (-u, -y), half_way):  # at the upper tip, at the lower one, half way
        (loop,) = steady_loops(numbered((begun[0], begun[1] + np.linspace(0, 0.03, u.size))))
        assert loop.closure == pytest.approx(0.03)


def test_what_is_even_in_the_input_is_the_symmetry_error():
    u, y = rayleigh(10.0, n=201)
    (loop,) = steady_loops(numbered((u, y + 0.01 * (1 - (u / 10) ** 2))))
    # y_falling(u) + y_rising(−u) = 2 · 0.01 (1 − x²), whose rms over −1…1 is 0.02 √(8/15)
    assert loop.symmetry_error() == pytest.approx(0.02 * np.sqrt(8 / 15), rel=0.01)
    assert steady_loops(numbered((u, y)))[0].symmetry_error() == pytest.approx(0, abs=1e-12)


@given(st.floats(-50, 50), st.floats(-5, 5), st.floats(0.1, 10))
def test_symmetry_is_evaluated_about_the_loops_own_centre_by_default(du, dy, scale):
    u, y = rayleigh(10.0)
    (loop,) = steady_loops(numbered((u + du, scale * (y + 1e-3 * np.cos(u)) + dy)))
    (plain,) = steady_loops(numbered((u, y + 1e-3 * np.cos(u))))
    assert plain.symmetry_error() > 1e-4
    assert loop.symmetry_error() == pytest.approx(scale * plain.symmetry_error(), rel=1e-6)
    assert loop.symmetry_error(loop.centre) == loop.symmetry_error()
    assert np.isnan(loop.symmetry_error((du + 30, 0.0)))


# --- measured ones ----------------------------------------------------------------------------------------------


@pytest.fixture
def real(shared_data, tmp_path):
    """A run from a file of others."""

    def do(name, mapping, format="csv"):
        report = import_file(
            shared_data / name, format=format, mapping=mapping, out=tmp_path / "x.run.sqlite"
        )
        return load_run(report.run)

    return do


def test_ferrite_loops_close_and_are_symmetric_about_zero(real):
    loops = steady_loops(real("ferrite_nested/B_MnZn_HP_ferrite.mat", "ferrite_nested", "mat"))
    assert [loop.number for loop in loops] == [0, 1, 2, 3]
    assert [loop.upper[0] for loop in loops] == pytest.approx([5.98, 9.5, 20.07, 79.95], rel=1e-3)
    for loop in loops:
        assert len(loop.rising) == len(loop.falling) == 65
        assert loop.closure == 0
        assert loop.upper[1] == -loop.lower[1]
        assert 1e-4 < loop.symmetry_error((0.0, 0.0)) < 0.0025 * loop.output_range


@pytest.mark.parametrize(("table", "share"), [(1, 0.054), (3, 0.034), (10, -0.009)])
def test_ferroelectric_loops_begin_half_way_and_are_open_as_the_import_reported(real, table, share):
    (loop,) = steady_loops(real("ferroelectric_loops/RMN_TRAP_SLOW.dat", f"ferroelectric_loops:{table}"))
    assert loop.closure / loop.output_range == pytest.approx(share, abs=0.002)
    assert loop.centre[0] == pytest.approx(72.5, abs=0.3)  # the amplifier's offset
    assert len(loop.rising) + len(loop.falling) == 403


@pytest.mark.parametrize("file", [1, 2, 3, 4, 5])
def test_nested_bumps_close_as_a_whole_but_not_inside(real, file):
    *inner, outer = steady_loops(real(f"sma_nested_bumps/ele_hys_{file}.txt", "sma_nested_bumps"))
    assert outer.lower[0] < 28
    assert abs(outer.closure) < 0.015 * outer.output_range
    assert (
        max(abs(loop.closure) for loop in inner) > 0.1 * outer.output_range
    )  # the thermocouple is not the wire
