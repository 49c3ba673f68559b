"""The removable share of the squared error, and its interval over resampled blocks."""

from dataclasses import replace

import numpy as np
import pytest

from replay.sittings import LISTED, LONG, session_runs, twin_plant_model
from smarig.diagnosis.comparison.commanded.commanded_comparison import _worse
from smarig.diagnosis.held_out_gain import HeldOutGain, held_out_gain
from smarig.diagnosis.refit.density_prior import density_prior
from smarig.diagnosis.refit.memory_noise import memory_covariance, memory_slopes
from smarig.diagnosis.refit.refit import NoiseEstimate
from smarig.replay import build_timeline, predict


def gain(base, extended, block, floor):
    return HeldOutGain(np.array(base, dtype=float), np.array(extended, dtype=float), np.array(block), floor)


def test_all_that_can_be_removed_is_removed_when_only_noise_is_left():
    assert gain([3.0, -3.0, 3.0, -3.0], [0.5, 0.5, -0.5, 0.5], [0, 0, 1, 1], 0.5).removable_share == 1.0


def test_nothing_is_removed_without_a_change():
    assert gain([3.0, -1.0, 2.0], [-3.0, 1.0, 2.0], [0, 0, 1], 0.5).removable_share == 0.0


def test_a_model_that_is_worse_removes_less_than_nothing():
    assert gain([1.0, 1.0], [2.0, 2.0], [0, 1], 0.0).removable_share == -3.0


@pytest.mark.parametrize("floor", [1.0, 1.2])
def test_a_base_at_the_noise_floor_leaves_nothing_to_remove(floor):
    at_floor = gain([1.0, -1.0], [0.9, 0.9], [0, 1], floor)
    assert at_floor.removable_share is None
    assert at_floor.interval() is None


@pytest.mark.parametrize(
    ("extended", "blocks", "chance"),
    [([1.0] * 12, range(12), False), ([1.0, 2.6] * 6, range(12), True), ([1.0, 2.6] * 6, [0, 1] * 6, False)],
)
def test_a_gain_in_some_blocks_only_may_be_chance(extended, blocks, chance):
    assert gain([2.0] * 12, extended, list(blocks), 0.1).by_chance == chance


def test_shares_are_of_squares_and_every_point_has_equal_weight():
    """(1 + 16 + 16 − 3·4) of (33 − 3·1), by hand."""
    g = gain([1.0, 4.0, 4.0], [2.0, -2.0, 2.0], [0, 1, 1], 1.0)
    assert g.removable_share == pytest.approx(21 / 30)
    assert (g.base, g.extended, g.blocks) == (pytest.approx(np.sqrt(11)), 2.0, 2)


def test_blocks_are_drawn_whole(monkeypatch):
    """Of two blocks three draws can be had: the interval ends at the shares of one block alone."""
    monkeypatch.setattr("smarig.diagnosis.held_out_gain.LEAST_BLOCKS", 2)
    g = gain([4.0, 4.0, 4.0, 2.0], [1.0, 1.0, 1.0, 1.9], [7, 7, 7, 9], 0.5)
    alone = [(16 - 1) / (16 - 0.25), (4 - 1.9**2) / (4 - 0.25)]
    assert g.interval() == pytest.approx((alone[1], alone[0]))


def test_few_blocks_have_no_interval():
    """That of one is a point, and that of three holds the truth four times of five."""
    for count, known in ((1, False), (4, False), (5, True)):
        block = np.arange(20) % count
        g = gain(np.linspace(3, 4, 20), np.linspace(0.5, 1.5, 20), block, 0.5)
        assert (g.interval() is not None) == known


def test_no_share_exceeds_one_whatever_blocks_are_drawn():
    """Blocks with little error bring the base model near the floor, and the extended one below it by chance."""
    base = np.repeat([1.02, 1.02, 1.05, 1.1, 3.0, 1.02], 3)
    extended = np.repeat([0.6, 0.5, 0.8, 0.6, 1.5, 0.7], 3)
    g = gain(base, extended, np.arange(18) // 3, 1.0)
    low, high = g.interval()
    assert low < g.removable_share <= high <= 1.0


def test_an_interval_is_the_same_for_the_same_seed():
    rng = np.random.default_rng(2)
    g = gain(rng.normal(0, 3, 60), rng.normal(0, 1, 60), np.arange(60) // 6, 0.5)
    assert g.interval(5) == g.interval(5)
    assert g.interval(5) != g.interval(6)
    low, high = g.interval()
    assert low < g.removable_share < high


@pytest.mark.long("takes two seconds")
def test_intervals_hold_the_true_share_about_as_often_as_they_promise():
    """Errors that share a sign and size within a block: a bootstrap of points would promise too much."""
    rng, cases, blocks, of_each = np.random.default_rng(12), 80, 25, 6
    block = np.repeat(np.arange(blocks), of_each)
    base_sd, extended_sd, floor = 3.0, 1.2, 0.5
    truth = (base_sd**2 - extended_sd**2) / base_sd**2
    inside, too_sure = 0, 0
    for _ in range(cases):
        common = rng.normal(0, 1, blocks)[block]
        base = base_sd * common + rng.normal(0, floor, block.size)
        own = rng.normal(0, 1, blocks)[block]
        extended = extended_sd * own + rng.normal(0, floor, block.size)
        low, high = gain(base, extended, block, floor).interval()
        inside += low <= truth <= high
        low, high = gain(base, extended, np.arange(block.size), floor).interval()
        too_sure += low <= truth <= high
    assert 0.85 * cases < inside < 0.99 * cases
    assert too_sure < 0.75 * cases


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """Runs of a wire that walks, and what is believed of it without and with that."""
    effects = ("walking=1",)
    runs = session_runs(tmp_path_factory.mktemp("gain"), LISTED, LONG, effects=effects)
    return runs, twin_plant_model()[0], *twin_plant_model(effects)


@pytest.mark.long("takes a second")
def test_a_model_with_the_effect_is_at_the_noise_floor_on_held_out_runs(walked):
    (train, judged), base, extended, per_count = walked
    noise = NoiseEstimate(np.empty(0), 0.0, 60.0, 0.4 * per_count / np.sqrt(250))
    g = held_out_gain([train], [judged], base, extended, noise)
    assert g.base_error.size == g.extended_error.size == len(judged.settled)
    assert g.floor == noise.settled
    assert g.base > 20 * g.floor
    assert g.removable_share == pytest.approx(1.0, abs=0.01)
    assert held_out_gain([train], [judged], base, base, noise).removable_share == 0.0
    assert held_out_gain([train], [judged], extended, base, noise).extended == g.base


@pytest.mark.long("takes two seconds")
def test_the_encoders_zero_is_met_on_the_training_runs(walked):
    """A constant offset in the held-out runs alone is an error and remains one."""
    (train, judged), _, extended, per_count = walked

    def lifted(run, by):
        return replace(run, steps=tuple(replace(s, position=s.position + by) for s in run.steps))

    noise = NoiseEstimate(np.empty(0), 0.0, 60.0, 0.01)
    same = held_out_gain([train], [judged], extended, extended, noise)
    both = held_out_gain([lifted(train, 1.0)], [lifted(judged, 1.0)], extended, extended, noise)
    one = held_out_gain([train], [lifted(judged, 1.0)], extended, extended, noise)
    np.testing.assert_allclose(both.base_error, same.base_error, atol=1e-9)
    np.testing.assert_allclose(one.base_error, same.base_error + 1.0, atol=1e-9)
    assert one.base > 10 * per_count


@pytest.mark.long("takes two seconds")
def test_moving_positions_of_another_session_are_left_out_if_their_noise_is_unknown(tmp_path, walked):
    """The training runs hold none, so nothing is known of their noise."""
    (train, _), base, extended, _ = walked
    (judged,) = session_runs(tmp_path, LISTED, effects=("walking=1",), fine=True)
    timeline = build_timeline([train, judged], base.actuator.tau_s)
    assert timeline.sessions
    assert any(r.kind == "moving" for r in timeline.other_readings)
    g = held_out_gain([train], [judged], base, extended, NoiseEstimate(np.empty(0), 0.1, 60.0, 0.01))
    assert g.base_error.size == len(judged.settled)


def test_ambient_fluctuation_in_the_memory_is_part_of_the_floor(walked):
    (train, judged), base, extended, _ = walked
    floors = [
        held_out_gain([train], [judged], base, extended, NoiseEstimate(np.empty(0), T, 60.0, 0.01)).floor
        for T in (0.0, 0.1, 0.2)
    ]
    assert floors[0] == 0.01
    squares = np.square(floors) - 0.01**2
    assert squares[1] > 0
    assert squares[2] == pytest.approx(4 * squares[1])


VARIANCES = np.array([0.1, 0.02, 1e-4])  # of broad and fine factors of the density, and of grains
ZERO = 30.0  # sd of the encoder's zero, in strokes


def positions(runs, plant_model):
    """Settled positions of runs, as read and as predicted by a plant model."""
    timeline = replace(build_timeline(runs, plant_model.actuator.tau_s).positions_only, other_readings=())
    return timeline, predict(timeline, plant_model)


def jointly(whole, plant_model, noise, variances):
    """Covariance of all positions when density, zero, draughts and readings are what they may be."""
    h, n = plant_model.hysteresis, whole.output.size
    shapes = density_prior(whole, h).covariances
    density = sum(v * shape for v, shape in zip(variances, shapes)) + ZERO**2
    draught = memory_covariance(*memory_slopes(h, whole), noise.correlation_s)
    return plant_model.stroke**2 * density + noise.temperature_K**2 * draught + noise.settled**2 * np.eye(n)


@pytest.mark.parametrize("temperature_K", [0.0, 0.1])
def test_a_position_is_weighted_by_how_well_the_training_runs_predict_it(walked, temperature_K):
    """Its variance when theirs are known: of a Gaussian, the inverse of its own block of the joint precision."""
    (train, judged), base, extended, per_count = walked
    noise = NoiseEstimate(np.empty(0), temperature_K, 60.0, 0.4 * per_count)
    timeline, whole = positions([train, judged], extended)
    precision = np.linalg.inv(jointly(whole, extended, noise, VARIANCES))
    held_out = timeline.run == 1
    conditional = np.diag(np.linalg.inv(precision[np.ix_(held_out, held_out)]))
    g = held_out_gain([train], [judged], base, extended, noise, VARIANCES)
    assert g.weight is not None
    np.testing.assert_allclose(1 / g.weight, conditional, rtol=1e-4)
    assert conditional.max() > 1.5 * conditional.min()
    assert conditional.max() > 3 * noise.settled**2
    assert g.floor == pytest.approx(np.sqrt(g.weight.size / np.sum(g.weight)))


def test_the_floor_rises_with_what_is_left_open_of_the_density(walked):
    (train, judged), base, extended, _ = walked
    noise = NoiseEstimate(np.empty(0), 0.0, 60.0, 0.01)
    floors = [
        held_out_gain([train], [judged], base, extended, noise, open_density * VARIANCES).floor
        for open_density in (0.0, 1.0, 10.0)
    ]
    zero = 0.01 * np.sqrt(1 + 1 / len(train.settled))  # is met on the training runs, with their own noise
    assert floors[0] == pytest.approx(zero, rel=1e-3)
    assert zero < floors[1] < floors[2]


def test_an_extended_model_is_no_better_if_settled_points_are_missed_by_more():
    """By its weights it is better: a reading that the training runs cannot predict counts little there."""
    base, extended = np.array([1.0, 1.0, 1.0, 1.0]), np.array([0.5, 0.5, 0.5, 3.0])
    weight = np.array([1.0, 1.0, 1.0, 0.01])
    found = HeldOutGain(base, extended, np.arange(4), 0.1, weight)
    assert found.extended < found.base
    assert _worse(found)
    assert not _worse(HeldOutGain(base, extended, np.arange(4), 0.1, weight, settled=np.arange(4) < 3))
