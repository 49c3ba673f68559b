"""Peaks of heat flow whose tangents, apex and area are known in closed form."""

import numpy as np
import pytest

from smarig.core import UsageError
from smarig.transformation import heat_flow_peak
from transformation.known_peaks import KnownPeak

RATE = 1 / 6  # K/s: 10 K/min
SHAPES = {
    "level": KnownPeak(),
    "sloped": KnownPeak(slope=-2e-3),
    "stepped": KnownPeak(step=0.03),
    "sloped and stepped": KnownPeak(slope=1e-3, step=-0.05, before=4.0, after=6.0),
    "narrow": KnownPeak(before=1.2, after=1.5),
    "near the cold end": KnownPeak(middle=15.0),
}


def found_of(peak, noise=0.0, seed=0, rows=700, rate=RATE):
    u = np.linspace(-20, 120, rows)
    y = peak.heat_flow(u) + noise * np.random.default_rng(seed).standard_normal(rows)
    return heat_flow_peak(u, y, rate_K_per_s=rate, seed=seed)


@pytest.mark.parametrize("name", SHAPES)
def test_without_noise_the_tangents_and_the_area_are_the_known_ones(name):
    peak = SHAPES[name]
    figures = found_of(peak).figures
    spacing = 140 / 699
    assert peak.feet == pytest.approx([figures["low"].value, figures["high"].value], abs=spacing / 2)
    assert figures["peak"].value == pytest.approx(peak.middle, abs=1.5 * spacing)
    assert figures["heat"].value == pytest.approx(peak.area / RATE, rel=2e-3)


def test_a_gaussian_starts_and_finishes_two_widths_from_its_middle():
    assert KnownPeak(middle=40.0, before=6.0, after=6.0).feet == pytest.approx((28.0, 52.0), abs=2e-3)


@pytest.mark.long("takes ten seconds", cases=("stepped-0.01", "sloped-0.02"))
@pytest.mark.parametrize(("name", "noise"), [("sloped", 0.003), ("stepped", 0.01), ("sloped", 0.02)])
def test_the_intervals_contain_the_known_values(name, noise):
    """Of 20 intervals with 95 % each, 16 or more contain the truth with a probability of 99.7 %."""
    peak = SHAPES[name]
    true = {"low": peak.feet[0], "peak": peak.middle, "high": peak.feet[1], "heat": peak.area / RATE}
    found = [found_of(peak, noise, seed).figures for seed in range(20)]
    for key, value in true.items():
        inside = [f[key].ci95[0] <= value <= f[key].ci95[1] for f in found]
        assert sum(inside) >= 16, key
    widths = [np.ptp(f["low"].ci95) for f in found]
    errors = [f["low"].value - true["low"] for f in found]
    assert np.median(widths) < 12 * np.std(errors), "an interval that is always too wide says nothing"


def test_more_noise_gives_wider_intervals():
    little, much = (found_of(SHAPES["level"], noise).figures["low"] for noise in (0.001, 0.01))
    assert np.ptp(much.ci95) > 3 * np.ptp(little.ci95)


def test_without_a_rate_there_is_no_heat_but_a_reason():
    found = found_of(SHAPES["level"], rate=None)
    assert "heat" not in found.figures
    assert "rate is not known" in found.why_not["heat"]


def test_a_peak_at_the_beginning_of_the_curve_has_no_start():
    found = found_of(KnownPeak(middle=-14.0, before=4.0, after=4.0), 1e-4)
    assert {"high", "peak"} <= found.figures.keys()
    assert "low" not in found.figures
    assert "no baseline before the peak" in found.why_not["low"]


@pytest.mark.parametrize(
    ("height", "words"), [(0.0, "stands out"), (0.004, "stands out")], ids=["flat", "below the noise"]
)
def test_a_curve_without_a_peak_is_refused(height, words):
    with pytest.raises(UsageError, match=words):
        found_of(KnownPeak(height=height), 0.003)
