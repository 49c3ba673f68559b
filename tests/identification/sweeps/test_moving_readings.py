"""Curves of a wire in motion: the moment of a reading within its tick is no evidence against Assumption 2.1."""

from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import fod_run
from identification.sweeps.relay_wire import PER_COUNT, TAU_S, heated, swept_run, switched
from smarig.identification import identify
from smarig.identification.fod_data import fod_data
from smarig.identification.surface.curve_report import curve_report, motion_within_a_tick
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

FINE = 10  # moments of a tick
TRAVEL = 270 * PER_COUNT


def read(run, outputs, seed=0):
    """The run with these outputs (n,) as the encoder reads them: 0.4 counts of noise, then whole counts."""
    noisy = outputs / PER_COUNT + 0.4 * np.random.default_rng(seed).standard_normal(outputs.size)
    return replace(run, columns={**run.columns, "position": np.floor(noisy + 0.5) * PER_COUNT})


def steep_wire():
    """Relays, all of positive mass, that switch within a few kelvin: μ ≥ 0 everywhere."""
    centre = np.random.default_rng(1).normal(64.0, 4.0, 2000)
    return centre + 16, centre - 16, np.full(centre.size, TRAVEL / centre.size)


def swept(earlier):
    """Sweeps of that wire, each position read a share of a tick before the moment for which the input is computed."""
    run = swept_run({"curves": 7})
    fine = heated(
        np.repeat(run["current_A"], FINE), FINE * TAU_S
    )  # ten times the ticks, ten times slower in each
    return read(run, switched(fine, *steep_wire())[FINE - 1 - round(earlier * FINE) :: FINE])


@pytest.mark.long("takes three seconds", cases=("0.3",))
@pytest.mark.parametrize("earlier", [0.3, 0.9])
def test_a_position_read_at_another_moment_of_its_tick_breaks_no_assumption(earlier):
    found = identify(swept(earlier), "exponential")
    assert not curve_report(found.data).monotone, "the readings themselves do rise by more than their noise"
    assert found.curves.monotone
    assert not found.curves.cross
    assert not [w for w in found.warnings if "Assumption 2.1" in w or "Prop. 4.6" in w]


@pytest.mark.long("takes three seconds")
def test_a_wire_that_does_extend_while_it_cools_is_still_reported():
    run = swept(0.0)
    T = heated(run["current_A"], TAU_S)
    bump = 4 * PER_COUNT * np.exp(-(((T - 100) / 10) ** 2))  # on a flat part of every high curve
    found = identify(replace(run, columns={**run.columns, "position": run["position"] + bump}), "exponential")
    assert not found.curves.monotone
    assert any(w.startswith("Curves rise while the input falls") for w in found.warnings)


@pytest.mark.long("takes five seconds")
def test_curves_that_do_cross_are_still_reported_and_do_not_contradict_a_positive_surface():
    surface, run = thesis_surface("one_e"), swept_run({"curves": 13})
    T = np.clip(heated(run["current_A"], TAU_S), surface.lower, surface.upper)
    found = identify(read(run, Preisach.from_surface(surface).simulate(T)), "positive")
    assert found.curves.cross
    (warning,) = [w for w in found.warnings if "Prop. 4.6" in w]
    assert "the density μ of these data is negative somewhere" in warning
    assert found.density.M_P
    assert found.text.endswith("; its μ ≥ 0 everywhere, although that of the data is not.")


def test_settled_points_are_held_and_samples_of_the_same_motion_are_not():
    run = fod_run("one_c", seed=1)
    samples = replace(run, steps=())
    assert not motion_within_a_tick([run], fod_data(run)).any()
    assert motion_within_a_tick([samples], fod_data(samples)).max() > 10 * PER_COUNT
