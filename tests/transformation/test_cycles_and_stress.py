"""Drift over cycles, dependence on stress, trend over the runs of a wire, and which branches are used."""

import numpy as np
import pytest

from smarig.transformation import run_figures, transformation_temperatures
from transformation.known_loops import run_of

U = np.linspace(0.0, 100.0, 121)


def cycle(shift=0.0, level=0.0, noise=0.0, seed=0, stroke=-1.0, ratchet=0.0):
    """Heating with A_s, A_f = 50, 60 + shift, then cooling with M_s, M_f = 50, 40 + shift; opened by ``ratchet``."""
    dice = np.random.default_rng(seed)
    up = np.clip((U - 55 - shift) / 10 + 0.5, 0, 1)
    down = np.clip((U - 45 - shift) / 10 + 0.5, 0, 1)[::-1]
    y = np.concatenate([up, down])[np.r_[: 2 * U.size]] * stroke + level
    y[U.size :] += ratchet * (1 - down)
    return np.concatenate([U, U[::-1]]), y + noise * dice.standard_normal(y.size)


def cycles(count, per_cycle, **more):
    parts = [cycle(shift=per_cycle * k, seed=k, **more) for k in range(count)]
    return tuple(np.concatenate(columns) for columns in zip(*parts))


@pytest.mark.long("takes three seconds")
def test_a_drift_is_found_with_its_interval():
    """Over 30 noisy cycles that fall by 0.2 K each."""
    covered = 0
    for first in range(6):
        parts = [cycle(shift=-0.2 * k, noise=0.01, seed=100 * first + k) for k in range(12)]
        found = run_figures(run_of(*(np.concatenate(c) for c in zip(*parts))))
        assert len(found.cycles) == 12
        for name in ("A_s", "A_f", "M_s", "M_f"):
            e = found.drift[name]
            assert e.value == pytest.approx(-0.2, abs=0.08)
            assert e.unit == "K/cycle"
            covered += e.ci95[0] <= -0.2 <= e.ci95[1]
    assert covered >= 20, "of 24"


def test_two_cycles_have_no_drift():
    assert run_figures(run_of(*cycles(2, 0.0))).drift == {}


def test_the_residual_is_the_unclosed_part_of_the_cycle_with_its_sign():
    for ratchet in (0.03, -0.02):
        found = run_figures(run_of(*cycle(ratchet=ratchet)))
        assert found.means["residual"].value == pytest.approx(ratchet, abs=1e-3)


def test_a_run_that_starts_with_cooling_closes_at_the_hot_end():
    u, y = cycle()
    hot_first = np.concatenate([u[U.size :], u[: U.size]]), np.concatenate([y[U.size :], y[: U.size] + 0.01])
    found = run_figures(run_of(*hot_first))
    assert len(found.cycles) == 1
    assert found.means["residual"].value == pytest.approx(0.01, abs=1e-3)


def test_minor_loops_and_partial_branches_are_named_and_not_used():
    u, y = cycle()
    minor = np.concatenate([U[:57], U[56:24:-1], U[24:57], U[56::-1]])
    found = run_figures(run_of(np.concatenate([u, minor]), np.concatenate([y, np.full(minor.size, y[-1])])))
    assert len(found.cycles) == 1
    assert [b.direction for b in found.unused] == ["heating", "cooling", "heating", "cooling"]
    assert all("not a full one" in b.reason for b in found.unused)
    assert found.means["A_s"].value == pytest.approx(50, abs=0.1)


def stressed(slope, stresses, *, unit="MPa", noise=0.002, first=0):
    found = []
    for k, s in enumerate(stresses):
        u, y = cycle(shift=slope * abs(s), noise=noise, seed=first + k)
        conditions = {"stress": {"mean": float(s), "min": float(s), "max": float(s), "unit": unit}}
        found.append(run_of(u, y, name=f"at_{s}", conditions=conditions))
    return transformation_temperatures(found)


def test_the_clausius_clapeyron_coefficient_and_its_interval():
    found = stressed(1 / 8, (0, 50, 100, 150)).stress
    assert [s.temperature for s in found] == ["A_s", "A_f", "M_s", "M_f"]
    for s in found:
        low, high = s.C_ci95_MPa_per_K
        assert low <= 8.0 <= high
        assert 7.8 < s.C_MPa_per_K < 8.2
        assert s.n == 4
    assert found[0].at_zero == pytest.approx(50, abs=0.2)


def test_compression_is_fitted_by_itself_and_shifts_with_the_size_of_the_load():
    found = stressed(1 / 10, (-100, -50, 50, 100)).stress
    assert [s.load for s in found] == ["tension"] * 4 + ["compression"] * 4
    assert all(s.C_MPa_per_K == pytest.approx(10, abs=0.3) for s in found)


def test_no_shift_determines_no_coefficient():
    found = [
        s for first in range(0, 50, 10) for s in stressed(0.0, (0, 50, 100), noise=0.01, first=first).stress
    ]
    none = [s for s in found if s.C_MPa_per_K is None]
    assert len(none) >= 17, "of 20, at 95 %"
    assert all(s.C_ci95_MPa_per_K == (None, None) for s in none)


@pytest.mark.parametrize(("stresses", "unit"), [((100, 101), "MPa"), ((50, 100), "N")])
def test_one_stress_or_another_unit_gives_no_coefficient(stresses, unit):
    assert stressed(1 / 8, stresses, unit=unit).stress == ()


def test_the_trend_of_a_wire_follows_the_start_of_its_runs():
    runs = [
        run_of(
            *cycle(shift=-0.5 * k, noise=0.002, seed=k), name=f"day{k}", wire="w", start_epoch=1e9 + 86400 * k
        )
        for k in (2, 0, 1, 3)
    ]
    found = transformation_temperatures(runs)
    assert [r.name for r in found.runs] == ["day0", "day1", "day2", "day3"]
    assert found.history["A_s"].value == pytest.approx(-0.5, abs=0.1)
    others = [runs[0], run_of(*cycle(), name="b", wire="another", start_epoch=2e9)]
    assert transformation_temperatures(others).history == {}


def loaded(loads, *, unit="N", stress=None):
    runs = []
    for k, load in enumerate(loads):
        conditions = {"load": {"mean": load, "min": load, "max": load, "unit": unit}}
        if stress is not None:
            conditions |= {"stress": {"mean": stress * load, "unit": "MPa"}}
        u, y = cycle(shift=1.6 * load, noise=0.002, seed=k)
        runs.append(run_of(u, y, name=f"at_{load}", conditions=conditions))
    return transformation_temperatures(runs)


def test_without_a_stress_the_temperatures_are_a_line_over_the_load():
    found = loaded((0.5, 5.0, 10.0))
    assert found.stress == ()
    assert [s.temperature for s in found.load] == ["A_s", "A_f", "M_s", "M_f"]
    for slope in found.load:
        assert slope.K_per_unit == pytest.approx(1.6, abs=0.05)
        assert slope.ci95[0] < 1.6 < slope.ci95[1]
        assert (slope.unit, slope.load_range, slope.n) == ("N", (0.5, 10.0), 3)
        assert slope.is_determined
    assert "A_s: 1.6" in str(found)


@pytest.mark.parametrize(("loads", "stress"), [((5.0, 10.0), 20.0), ((5.0, 5.05), None)])
def test_a_stress_that_is_known_or_one_load_gives_no_line_over_the_load(loads, stress):
    assert loaded(loads, stress=stress).load == ()


@pytest.mark.parametrize(("loads", "drifts"), [((5.0, 5.1, 5.0), True), ((5.0, 10.0, 15.0), False)])
def test_runs_at_different_loads_have_no_common_drift(loads, drifts):
    """Of wires whose cross section is not known: a load moves the temperatures as a stress does."""
    runs = []
    for k, load in enumerate(loads):
        conditions = {"load": {"mean": load, "min": load, "max": load, "unit": "N"}}
        u, y = cycle(shift=8.0 * k, noise=0.002, seed=k)
        runs.append(run_of(u, y, name=f"at_{load}", conditions=conditions, wire="w", start_epoch=1000.0 * k))
    assert bool(transformation_temperatures(runs).history) is drifts


def test_temperatures_above_ambient_need_the_ambient_temperature_for_degC():
    warm = run_of(*cycle(), unit="K", quantity="wire temperature above ambient", ambient=22.0)
    bare = run_of(*cycle(), unit="K", quantity="wire temperature above ambient")
    absolute = run_of(cycle()[0] + 273.15, cycle()[1], unit="K", quantity="temperature", ambient=22.0)
    a, b, c = (
        transformation_temperatures(r).to_json()["runs"][0]["figures"]["A_s"] for r in (warm, bare, absolute)
    )
    assert a["degC"] == pytest.approx(72, abs=0.1)
    assert b["degC"] is None
    assert b["above_ambient_K"] == pytest.approx(50, abs=0.1)
    assert c["degC"] == pytest.approx(50, abs=0.1)
    assert c["above_ambient_K"] == pytest.approx(28, abs=0.1)
    assert "°C not known" in str(transformation_temperatures(bare))
