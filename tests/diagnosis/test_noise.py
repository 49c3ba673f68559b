"""Temperature noise at a turning point affects every later reading until the turning point is wiped out."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.made_memories import prediction_for_inputs
from smarig.diagnosis.refit.memory_noise import memory_covariance, memory_slopes
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

CORRELATION_S = 60.0
DRAWS = 2000


def wander(low, high, n, seed):
    """Inputs up and down between these, and times at uneven distances."""
    rng = np.random.default_rng(seed)
    return rng.uniform(low, high, n), np.cumsum(rng.uniform(5.0, 60.0, n))


def ornstein_uhlenbeck(t_s, rng):
    """Noise of unit variance at times (n,), by its covariance, (DRAWS, n)."""
    kernel = np.exp(-np.abs(np.subtract.outer(t_s, t_s)) / CORRELATION_S)
    return rng.standard_normal((DRAWS, t_s.size)) @ np.linalg.cholesky(kernel).T


@pytest.mark.long("takes two seconds", cases=("two_c-anhysteretic--100.0-100.0",))
@pytest.mark.parametrize(
    ("wire", "initial", "low", "high"),
    [("one_e", "negative", 65.0, 95.0), ("two_c", "anhysteretic", -100.0, 100.0)],
)
def test_covariance_is_that_of_many_noisy_simulations(wire, initial, low, high):
    hysteresis, size_K = thesis_surface(wire), 0.01
    inputs, t_s = wander(low, high, 24, seed=4)
    J, times = memory_slopes(hysteresis, prediction_for_inputs(hysteresis, inputs, t_s, initial))
    covariance = memory_covariance(J, times, CORRELATION_S)

    operator = Preisach(hysteresis)
    noise = size_K * ornstein_uhlenbeck(t_s, np.random.default_rng(9))
    still = operator.simulate(inputs, initial)
    moved = np.array([operator.simulate(inputs + n, initial) - still for n in noise]) / size_K
    drawn = moved.T @ moved / DRAWS

    variance = np.diag(covariance)
    sd = np.sqrt((np.outer(variance, variance) + covariance**2) / DRAWS)
    assert np.abs(drawn - covariance).max() < 5 * sd.max()
    assert np.all(np.abs(drawn - covariance) < 5 * sd + 2e-3 * variance.max())
    apart = np.abs(covariance - np.diag(variance))
    assert apart.max() > 0.3 * variance.max()  # readings do share a past


def test_constant_noise_moves_every_remembered_input_equally():
    hysteresis = thesis_surface("one_e")
    inputs, t_s = wander(65.0, 95.0, 12, seed=5)
    J, times = memory_slopes(hysteresis, prediction_for_inputs(hysteresis, inputs, t_s))
    operator, small = Preisach(hysteresis), 1e-4
    shifted = (operator.simulate(inputs + small) - operator.simulate(inputs - small)) / (2 * small)
    np.testing.assert_allclose(
        memory_covariance(J, times, 1e9), np.outer(shifted, shifted), atol=1e-5 * np.abs(shifted).max() ** 2
    )


@pytest.mark.parametrize(("wire", "beyond"), [("one_e", 200.0), ("two_c", 210.0), ("one_c", -20.0)])
def test_a_reading_in_saturation_has_no_temperature_noise(wire, beyond):
    hysteresis = thesis_surface(wire)
    prediction = prediction_for_inputs(hysteresis, [60.0, beyond])
    J, times = memory_slopes(hysteresis, prediction)
    assert Preisach(hysteresis).simulate([60.0, beyond + 1.0])[1] == prediction.output[1]
    covariance = memory_covariance(J, times, CORRELATION_S)
    assert covariance[0, 0] > 0
    assert covariance[1, 1] == pytest.approx(0.0, abs=1e-12)


def test_saturation_forgets_the_noise_before_it():
    hysteresis = thesis_surface("one_e")
    J, times = memory_slopes(
        hysteresis, prediction_for_inputs(hysteresis, [60.0, 90.0, 70.0, 200.0, 80.0], [1, 2, 3, 4, 5])
    )
    last = J.toarray()[4]
    assert not last[times < 4].any()
    assert last[times == 5].all()


def test_a_wiped_out_reversal_leaves_no_trace():
    hysteresis = thesis_surface("one_e")
    inputs, t_s = [110.0, 60.0, 90.0, 70.0, 95.0, 65.0], np.array([10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    J, times = memory_slopes(hysteresis, prediction_for_inputs(hysteresis, inputs, t_s))
    slope = {t: J.toarray()[:, k] for k, t in enumerate(times.tolist())}
    assert slope[30.0][2:4].all()  # 90 and 70, while they are remembered
    assert slope[40.0][3] != 0
    assert not slope[30.0][4:].any()  # 95 has wiped out both
    assert not slope[40.0][4:].any()

    K = [0, 1, 4, 5]
    bare = memory_slopes(hysteresis, prediction_for_inputs(hysteresis, [inputs[k] for k in K], t_s[K]))
    np.testing.assert_allclose(
        memory_covariance(J, times, CORRELATION_S)[np.ix_(K, K)],
        memory_covariance(*bare, CORRELATION_S),
        rtol=1e-12,
    )


def test_a_level_that_was_held_twice_is_remembered_from_the_last_time():
    """A hold is many ticks at one input: the reversal is where the wire left it."""
    hysteresis = thesis_surface("one_e")
    prediction = prediction_for_inputs(hysteresis, [100.0, 100.0, 100.0, 70.0], [10.0, 20.0, 30.0, 40.0])
    J, times = memory_slopes(hysteresis, prediction)
    assert times[J.toarray()[3] != 0].tolist() == [30.0, 40.0]


def test_each_reading_remembers_a_repeated_level_from_its_own_visit():
    """From saturation to 60, up to 95 and down, read; much later, from saturation, once more."""
    hysteresis = thesis_surface("one_e")
    inputs = [200.0, 60.0, 95.0, 75.0, 200.0, 60.0, 95.0, 76.0]
    t_s = [10.0, 20.0, 30.0, 40.0, 5010.0, 5020.0, 5030.0, 5040.0]
    J, times = memory_slopes(hysteresis, prediction_for_inputs(hysteresis, inputs, t_s))
    first, second = (times[J.toarray()[k] != 0].tolist() for k in (3, 7))
    assert sorted(first) == [20.0, 30.0, 40.0]
    assert sorted(second) == [5020.0, 5030.0, 5040.0]
    C = memory_covariance(J, times, CORRELATION_S)
    assert abs(C[3, 7]) < 1e-9 * np.sqrt(C[3, 3] * C[7, 7])
    lasting = memory_covariance(J, times, 1e9)
    assert lasting[3, 7] > 0.9 * np.sqrt(lasting[3, 3] * lasting[7, 7])


def two_sittings(first, second, initial):
    """Every tick is read, and the second session starts again from the initial state, much later."""
    hysteresis = thesis_surface("one_e")
    one = prediction_for_inputs(hysteresis, first, initial=initial)
    other = prediction_for_inputs(hysteresis, second, 1e5 + np.arange(1.0, len(second) + 1), initial)
    n = len(first)
    return hysteresis, replace(
        one,
        t_s=np.append(one.t_s, other.t_s),
        hysteresis_input_K=np.append(one.hysteresis_input_K, other.hysteresis_input_K),
        states=(*one.states, *other.states),
        output=np.append(one.output, other.output),
        tick_index=np.append(one.tick_index, n + other.tick_index),
        output_slope=np.append(one.output_slope, other.output_slope),
        session_starts=(0, n),
    )


def test_an_input_of_an_earlier_session_is_not_remembered_from_there():
    """90 and 70 are in the memory at both starts; the first session reaches them again, the second never does."""
    operator = Preisach(thesis_surface("one_e"))
    operator.simulate([90.0, 70.0])
    hysteresis, prediction = two_sittings([110.0, 90.0, 70.0, 85.0, 75.0], [80.0, 75.0], operator.state)
    assert {90.0, 70.0} <= set(prediction.states[6].extrema)
    J, times = memory_slopes(hysteresis, prediction)
    slope = J.toarray()
    assert not slope[5:, times < 1e5].any()
    assert sorted(times[slope[6] != 0]) == [1e5 + 1, 1e5 + 2]
    assert sorted(times[slope[4] != 0]) == [1.0, 3.0, 4.0, 5.0]

    alone = prediction_for_inputs(hysteresis, [80.0, 75.0], 1e5 + np.arange(1.0, 3.0), operator.state)
    np.testing.assert_allclose(
        memory_covariance(J, times, CORRELATION_S)[5:, 5:],
        memory_covariance(*memory_slopes(hysteresis, alone), CORRELATION_S),
        rtol=1e-12,
    )
