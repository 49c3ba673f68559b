"""Two days of a wire without common steps: the figures of full branches, against loops whose change is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.report.runs.comparison_assessment import comparison_assessment
from smarig.report.runs.run_alignment import aligned
from smarig.report.runs.temperature_change import temperature_change
from transformation.known_loops import known_loop, run_of

FAMILY = SimpleNamespace(strokes=())


def days(seed, shift_K=0.0, gain=1.0):
    """Two measurements of one loop with independent noise; the second one shifted and scaled."""
    loop = known_loop(seed, noise=0.005, drift=0.0)
    noise = np.random.default_rng(1000 + seed).normal(0, 0.005 * np.ptp(loop.y), len(loop.y))
    return run_of(loop.u, loop.y, name="monday"), run_of(
        loop.u + shift_K, gain * loop.y + noise, name="friday"
    )


def sentences(first, other):
    return comparison_assessment(aligned({"monday": first, "friday": other}), FAMILY)


@pytest.mark.parametrize("seed", range(3))
def test_a_shift_is_found_in_every_temperature_and_in_nothing_else(seed):
    changes = {c.name: c for c in temperature_change(*days(seed, shift_K=6.0))}
    assert {"A_s", "A_f", "M_s", "M_f"} <= changes.keys()
    for name in ("A_s", "A_f", "M_s", "M_f"):
        assert changes[name].significant
        assert changes[name].ci95[0] < 6.0 < changes[name].ci95[1]
    assert not changes["width"].significant
    assert not changes["stroke"].significant


def test_a_loss_of_stroke_is_found():
    changes = {c.name: c for c in temperature_change(*days(1, gain=0.9))}
    assert changes["stroke"].significant
    assert changes["stroke"].after / changes["stroke"].before == pytest.approx(0.9, abs=0.01)
    assert not changes["M_s"].significant


@pytest.mark.long("takes three seconds")
def test_where_nothing_changed_it_says_so():
    """95 % hold for all figures together: of 20 pairs one may differ in some figure."""
    differ = [any(c.significant for c in temperature_change(*days(seed))) for seed in range(20)]
    assert sum(differ) <= 1


def test_the_assessment_names_what_moved():
    found = sentences(*days(0, shift_K=6.0))
    assert found.level == "warning"
    text = " ".join((found.measured, found.quality, found.advice))
    assert "no steps in common" in text
    assert "Their full branches differ: A_s" in text
    assert "unchanged within the intervals: the width, the stroke" in text
    same = sentences(*days(0))
    assert same.level == "good"
    assert "agree within the 95 % intervals" in same.quality


def test_a_run_without_a_full_loop_is_drawn_but_not_compared():
    first, other = days(0)
    heating = slice(0, int(np.argmax(other["input"])))
    half = run_of(other["input"][heating], other["position"][heating], name="friday")
    assert temperature_change(first, half) == []
