"""What repeats of one state show besides noise: a drift over cycles, and changes that are no noise of a reading."""

import numpy as np
import pytest

from identification.made_runs import driven_run, made_run, read
from identification.test_representation import run_of_twin
from smarig.identification import identify, verify
from smarig.identification.error_verdict import ErrorLevel, error_verdict
from smarig.identification.noise_floor import noise_floor
from smarig.identification.repeatability import Repeatability, Repeats, pooled_repeats
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.replay import load_model

CYCLES = [0, *([174.1, 0, 50, 0] * 12)]
COUNT_MM = 2 * np.pi * 15 / 2000
NOISE = np.sqrt(0.4**2 + 1 / 12) * COUNT_MM


def _walking(share_per_cycle, seed):
    """A run of repeated cycles on a wire that lengthens by a share of its stroke with every full cycle."""
    y = Preisach.from_surface(thesis_surface("one_e")).simulate(CYCLES, "negative")
    cycles = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(y)))]) / (2 * np.ptp(y))
    walked = y + share_per_cycle * np.ptp(y) * cycles
    return made_run(CYCLES, read(walked, "one", np.random.default_rng(seed)))


def test_a_drift_from_cycle_to_cycle_is_stated_and_is_no_noise():
    floor = noise_floor(_walking(0.01, 1))
    assert floor.repeatability.drift == pytest.approx(0.01, rel=0.15)
    assert floor.value == pytest.approx(NOISE, rel=0.35)
    assert "drift" in floor.warnings[0]


def test_a_wire_that_shortens_has_a_negative_drift():
    assert noise_floor(_walking(-0.01, 1)).repeatability.drift < 0


def test_noise_alone_gives_no_drift():
    found = [noise_floor(_walking(0.0, seed)) for seed in range(40)]
    assert not any(floor.warnings for floor in found)
    mean = np.mean([floor.value for floor in found])
    assert mean == pytest.approx(NOISE, rel=0.25)  # quantisation differs between levels


def test_a_trend_needs_to_be_more_than_chance_and_to_matter():
    rng = np.random.default_rng(0)
    cycles = np.arange(12.0)
    alarms = [
        pooled_repeats([Repeats(cycles, rng.standard_normal(12)) for _ in range(2)]).drift is not None
        for _ in range(2000)
    ]
    assert sum(alarms) <= 4  # the F test allows 2, and the size of the trend fewer
    weak = [Repeats(cycles, 0.01 * cycles + rng.standard_normal(12)) for _ in range(500)]
    found = pooled_repeats(weak)
    assert found.drift is None, "beyond chance, but too small to change a verdict"
    assert found.freedom == 500 * 11


def test_a_trend_that_slows_down_is_removed_as_well():
    cycles = np.arange(1.0, 13.0)
    noise = 0.01 * np.random.default_rng(2).standard_normal((3, 12))
    found = pooled_repeats([Repeats(cycles, 0.1 * cycles - 0.003 * cycles**2 + e) for e in noise])
    assert np.sqrt(found.squares / found.freedom) == pytest.approx(0.01, rel=0.4)


def _branches(shift, states=30, noise=0.01, seed=0):
    """Repeats of the states of one branch, which each visit shifts as a whole."""
    rng = np.random.default_rng(seed)
    cycles = np.arange(float(len(shift)))
    return [
        Repeats(cycles + place, shift + noise * rng.standard_normal(len(shift)))
        for place in np.linspace(0, 0.4, states)
    ]


@pytest.mark.long("takes a second each", cases=("3", "4", "6"))
@pytest.mark.parametrize("visits", [2, 3, 4, 6, 12])
def test_branches_that_visits_shift_at_random_have_no_drift(visits):
    """As relaxation does after holds of unequal length."""
    rng = np.random.default_rng(visits)
    found = [pooled_repeats(_branches(rng.exponential(0.1, visits), seed=k)) for k in range(200)]
    assert sum(f.drift is not None for f in found) <= 1


@pytest.mark.parametrize("visits", [8, 12])
def test_one_step_between_two_visits_is_no_drift(visits):
    shift = np.where(np.arange(visits) < visits / 2, 0.0, 0.2)
    found = [
        pooled_repeats(_branches(shift + 0.01 * np.random.default_rng(k).standard_normal(visits), seed=k))
        for k in range(100)
    ]
    assert sum(f.drift is not None for f in found) <= 1


@pytest.mark.parametrize("slows", [0.0, 0.003])
@pytest.mark.parametrize("visits", [8, 12])
def test_branches_that_go_on_moving_drift(visits, slows):
    cycles = np.arange(float(visits))
    shift = 0.1 * cycles - slows * cycles**2 + 0.003 * np.random.default_rng(1).standard_normal(visits)
    found = pooled_repeats(_branches(shift))
    assert found.drift == pytest.approx(0.1 - slows * (visits - 1), rel=0.1)
    assert np.sqrt(found.squares / found.freedom) == pytest.approx(0.01, rel=0.5)


@pytest.mark.long("takes five seconds")
def test_a_fit_that_follows_the_scatter_of_a_walking_wire_is_poor_and_its_verification_too(tmp_path):
    """Repeats that hold the drift would call its error noise."""
    run = run_of_twin(tmp_path, "first_order_descending", 1, ["walking=1"])
    found = identify(run, "exponential")
    assert found.fit_verdict.level is ErrorLevel.POOR
    assert "repeats drift by 1 % of the travel per cycle" in found.fit_verdict.text
    assert any("drift" in warning for warning in found.warnings)
    path = found.model.save(tmp_path / "wire.model.json")
    assert load_model(path).noise_floor == found.model.noise_floor
    judged = verify(found.model, run).runs[0]
    assert judged.verdict.level is ErrorLevel.POOR
    assert judged.to_json()["repeatability"]["drift_per_cycle"] == pytest.approx(0.01, rel=0.1)


@pytest.mark.long("takes three seconds")
def test_repeats_that_differ_by_more_than_readings_are_never_good(tmp_path):
    run = run_of_twin(tmp_path, "wiping_out", 1, ["settling"])
    floor = noise_floor(run)
    assert floor.repeatability.over_readings > 5
    assert error_verdict(floor.value, floor.value, 0.001).level is ErrorLevel.GOOD
    cautious = error_verdict(floor.value, floor.value, 0.001, floor.repeatability)
    assert cautious.level is ErrorLevel.FAIR
    assert "the noise of a reading" in cautious.text


@pytest.mark.long("takes three seconds", cases=("0",))
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.long("takes three seconds")) for seed in (1, 2))]
)
def test_a_clean_twin_is_silent(tmp_path, seed):
    assert not noise_floor(run_of_twin(tmp_path, "wiping_out", seed)).warnings


def test_nothing_to_state_leaves_a_verdict_as_it_is():
    assert error_verdict(1.0, 0.1, 0.01, Repeatability()) == error_verdict(1.0, 0.1, 0.01)
    assert noise_floor(driven_run("one_e", [0, 100, 50], seed=1)).repeatability == Repeatability()
