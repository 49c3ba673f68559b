"""Properties of the curves themselves: single sigmoids, noise, merging, crossing, range."""

import re

import numpy as np
import pytest

from identification.made_runs import (
    NOISE_COUNTS,
    PARTITION,
    PER_COUNT,
    driven_run,
    fod_inputs,
    fod_run,
    made_run,
)
from smarig.identification.fod_data import DescendingCurve, fod_data
from smarig.identification.surface.curve_fit import fit_curves
from smarig.identification.surface.curve_report import _crossing_curves, curve_report, reading_noise
from smarig.preisach.hysteresis.gorbet_1997 import THESIS_SURFACES, thesis_surface
from smarig.preisach.operator import Preisach


def reading_sd(wire):
    return np.sqrt(NOISE_COUNTS**2 + 1 / 12) * PER_COUNT[wire]


def test_sigmoids_of_exact_curves_are_those_of_the_surface():
    """(5.5) at constant α is b₁σ(b₂(β + b₃)) + b₄ with b₂ = x₄ and b₃ = f(α)."""
    s = thesis_surface("two_p")
    alpha, b, _ = fit_curves(fod_data(fod_run("two_p"))).against_alpha()
    assert set(alpha) >= set(PARTITION["two"][6:])
    assert np.allclose(b[:, 1], s.x[2], rtol=1e-3)
    assert np.allclose(b[:, 2], s.shift(alpha)[0], atol=0.05)


def test_short_curves_are_named_and_nothing_fails():
    fits = fit_curves(fod_data(fod_run("one_e", seed=2)))
    assert {1.7, 7.0, 15.7} <= set(fits.too_short)
    assert {85.3, 111.4, 141.0, 174.1}.isdisjoint(fits.too_short)
    short = fits.curves[0]
    assert short.points == 2
    assert short.b is None
    assert "1.7" in repr(fits)


@pytest.mark.long("takes two seconds")
def test_standard_errors_of_a_long_curve_cover():
    truth = thesis_surface("two_c")
    inside = []
    for seed in range(30):
        alpha, b, error = fit_curves(fod_data(fod_run("two_c", seed=seed))).against_alpha()
        k = alpha.tolist().index(185.0)
        inside.append(abs(b[k, 2] - truth.x[3]) < 2 * error[k, 2])
    assert 0.85 <= np.mean(inside) <= 1.0


@pytest.mark.parametrize("name", ["one_e", "two_c"])
def test_noise_is_read_off_the_curves(name):
    noise = [reading_noise(fod_data(fod_run(name, seed=seed))) for seed in range(10)]
    assert np.sqrt(np.mean(np.square(noise))) == pytest.approx(reading_sd(name[:3]), rel=0.2)


def test_noise_of_dense_curves_is_read_off_third_differences():
    levels = np.linspace(-185, 185, 61)
    noise = reading_noise(fod_data(fod_run("two_e", seed=1, partition=levels)))
    assert noise == pytest.approx(reading_sd("two"), rel=0.1)


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("seed", [None, 0, 1, 2, 3])
@pytest.mark.parametrize("name", THESIS_SURFACES)
def test_a_fully_exercised_range_raises_no_warning_of_it(name, seed):
    report = curve_report(fod_data(fod_run(name, seed=seed)))
    assert report.exercised
    assert report.monotone
    assert not any("exercised" in w for w in report.warnings)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize(
    ("name", "levels", "end"),
    [
        ("two_e", PARTITION["two"][2:-2], "lower"),
        ("two_c", PARTITION["two"][2:], "lower"),
        ("two_e", PARTITION["two"][:-2], "top"),
        ("one_e", PARTITION["one"][:-3], "top"),
        ("one_c", PARTITION["one"][:-3], "top"),
    ],
)
def test_a_truncated_range_is_found(name, levels, end, seed):
    # Driven between limits that are no saturation: the wire's own memory reaches further than the partition.
    inputs = fod_inputs(levels)
    y = Preisach.from_surface(thesis_surface(name)).simulate([thesis_surface(name).lower, *inputs])[1:]
    rng = np.random.default_rng(seed)
    q = PER_COUNT[name[:3]]
    y = np.round(y / q + NOISE_COUNTS * rng.standard_normal(y.size)) * q
    report = curve_report(fod_data(made_run(inputs, y, initial=None)))
    assert not report.exercised
    word = {"lower": "do not merge", "top": "at an angle"}[end]
    assert any("not fully exercised" in w and word in w for w in report.warnings)


@pytest.mark.parametrize("name", ["one_p", "one_e"])
def test_crossing_proves_a_negative_density(name):
    report = curve_report(fod_data(fod_run(name, seed=1)))
    assert report.cross
    assert any("Prop. 4.6" in w for w in report.warnings)


@pytest.mark.parametrize(("inner_y", "crosses"), [(0.47, False), (0.05, True)])
def test_what_lies_between_coarse_points_is_no_crossing(inner_y, crosses):
    """A line between 0.08 and 4.70 passes above 0.47, the wire's steep curve need not; 0.05 is below every curve."""
    lower = DescendingCurve(0, 90.0, np.array([88.0, 64.0, 40.0]), np.array([4.70, 0.08, 0.0]))
    higher = DescendingCurve(1, 100.0, np.array([98.0, 70.5, 40.0]), np.array([6.0, inner_y, 0.0]))
    curves = [lower, higher]
    assert (_crossing_curves(curves, curves, 0.01) is not None) == crosses


@pytest.mark.long("takes a second", cases=("two_c",))
@pytest.mark.parametrize("name", ["one_c", "two_c"])
def test_noise_is_no_crossing(name):
    for seed in range(12):
        report = curve_report(fod_data(fod_run(name, seed=seed)))
        assert not report.cross
        assert report.warnings == ()


def test_a_curve_that_rises_while_the_input_falls_is_reported():
    inputs, y = fod_run("one_c", partition=np.linspace(0.0, 174.1, 51), seed=1).points()
    bump = 2.0 * np.exp(-(((inputs - 60.0) / 10.0) ** 2))
    assert curve_report(fod_data(made_run(inputs, y))).monotone
    report = curve_report(fod_data(made_run(inputs, y + bump)))
    assert not report.monotone
    (rise,) = [w for w in report.warnings if "Assumption 2.1" in w]
    assert rise.startswith("Curves rise while the input falls")

    falling = curve_report(fod_data(made_run(inputs, 12.0 - y)))
    assert falling.monotone, "an output that falls while the input rises, as strain does, breaks nothing"
    (fall,) = [w for w in curve_report(fod_data(made_run(inputs, 12.0 - y - bump))).warnings if "2.1" in w]
    assert fall == rise.replace("Curves rise", "Curves fall")


def test_mirrored_curves_are_named_by_the_inputs_that_were_recorded():
    inputs, y = fod_run("one_c", partition=np.linspace(0.0, 174.1, 51), seed=1).points()
    bump = 2.0 * np.exp(-(((inputs - 60.0) / 10.0) ** 2))
    plain = next(w for w in curve_report(fod_data(made_run(inputs, y + bump))).warnings if "2.1" in w)
    data = fod_data(made_run(-inputs, -y - bump, initial="positive"))
    assert data.mirrored
    mirrored = next(w for w in curve_report(data).warnings if "2.1" in w)
    assert mirrored.startswith("Curves fall while the input rises (α = -")
    numbers = [float(v) for v in re.findall(r"-?[\d.]+(?=[,)])", mirrored.split("(α = ")[1].split(":")[0])]
    assert numbers == [
        -float(v) for v in re.findall(r"-?[\d.]+(?=[,)])", plain.split("(α = ")[1].split(":")[0])
    ]


def test_two_points_are_enough_for_an_evaluation():
    report = curve_report(fod_data(driven_run("one_c", [0, 60, 0, 174.1, 0])))
    assert np.isnan(report.noise)
    assert report.monotone


def test_a_straight_curve_does_not_determine_a_sigmoid():
    inputs = np.array(fod_inputs(np.linspace(0.0, 100.0, 9)))
    y = 0.1 * inputs + np.random.default_rng(1).normal(0, 0.05, inputs.size)
    fits = fit_curves(fod_data(made_run(inputs, y)))
    assert len(fits.too_short) >= len(fits.curves) - 1  # noise may bend one
    assert all(np.isfinite(c.b).all() for c in fits.curves if c.b is not None)
    assert fits.sigma == pytest.approx(0.05, rel=0.4)
