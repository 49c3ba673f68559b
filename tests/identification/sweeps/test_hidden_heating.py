"""τ and R/hA hidden in the data of another program are found, or the reason is given why they cannot be."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from identification.sweeps.relay_wire import (
    GAIN,
    PER_COUNT,
    TAU_S,
    heated,
    relays,
    swept_run,
    switched,
    with_temperature,
)
from smarig.core import DataError
from smarig.identification.sweeps.gain_of_sweeps import UNDETERMINED, gain_of_sweeps
from smarig.identification.sweeps.sweep_record import SweepRecord
from smarig.identification.sweeps.tau_of_sweeps import rate_ratio, tau_of_sweeps
from smarig.preisach import FodTable
from smarig.record import Event

ONE_RATE = {"curves": 8, "rates_K_per_s": "6"}


@cache
def found(tau, gain=1.0, drift=0.0, seed=0):
    return tau_of_sweeps([SweepRecord.of(swept_run(tau=tau, gain=gain, drift=drift, seed=seed))])


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize(("tau", "gain"), [(0.65, 1.08), (1.55, 0.92)])
def test_a_hidden_time_constant_is_found(tau, gain):
    estimate = found(tau, gain).tau
    assert estimate.value == pytest.approx(tau * TAU_S, rel=0.03)
    low, high = estimate.ci95
    assert low - (high - low) < tau * TAU_S < high + (high - low)
    assert high / low < 1.1


@pytest.mark.long("takes three seconds")
def test_what_no_preisach_model_follows_is_reported_and_widens_the_interval():
    plain, drifting = found(0.65, 1.08), found(0.65, 1.08, 4.0)
    assert plain.rms < 1.3 * plain.noise
    assert drifting.rms > 2 * drifting.noise

    def width(swept):
        return np.log(swept.tau.ci95[1] / swept.tau.ci95[0])

    assert width(drifting) > 2 * width(plain)
    assert drifting.tau.ci95[0] < 0.65 * TAU_S < drifting.tau.ci95[1]


def test_one_rate_is_refused():
    with pytest.raises(DataError, match="at one rate .* cannot be distinguished from a wider hysteresis"):
        tau_of_sweeps([SweepRecord.of(swept_run(ONE_RATE))])


def test_a_motion_of_a_few_counts_is_refused():
    with pytest.raises(DataError, match="moves by .* counts only, too little"):
        tau_of_sweeps([SweepRecord.of(swept_run(scale=0.05))])


def test_sweeps_that_drown_in_noise_are_refused():
    run = swept_run(scale=0.1, noise=30.0)
    with pytest.raises(DataError, match="noise of the output.* a lag of the heating cannot be identified"):
        tau_of_sweeps([SweepRecord.of(run)])


def test_the_rate_ratio_is_that_of_the_sweeps():
    assert rate_ratio([SweepRecord.of(swept_run(ONE_RATE))]) == pytest.approx(1.0, abs=0.05)
    two = {"curves": 8, "rates_K_per_s": "4,10"}
    assert rate_ratio([SweepRecord.of(swept_run(two))]) == pytest.approx(2.5, rel=0.05)


def test_the_same_record_follows_from_another_gain_and_a_wider_hysteresis():
    alpha, beta, mass = relays()
    one, other = swept_run(gain=1.0), swept_run(gain=1.1, wire=(1.1 * alpha, 1.1 * beta, mass))
    assert np.mean(one["counts"] != other["counts"]) < 1e-3  # rounding at a threshold
    assert gain_of_sweeps([SweepRecord.of(one)], TAU_S) == UNDETERMINED


def test_the_wires_temperature_gives_the_gain():
    run = with_temperature(swept_run(tau=1.3, gain=1.07), 1.3, 1.07)
    gain = gain_of_sweeps([SweepRecord.of(run)], 1.3 * TAU_S)
    assert gain.value == pytest.approx(1.07 * GAIN, rel=2e-3)
    assert gain.ci95[0] < 1.07 * GAIN < gain.ci95[1]


def table_of(wire, nodes):
    """y(α, β) of relays at nodes, by their definition: up if the threshold α was passed and β was not."""
    alpha, beta, mass = wire
    low = np.array([[mass @ ((alpha <= a) & (beta < b)) for b in nodes] for a in nodes])
    return FodTable(nodes, np.where(np.tri(nodes.size, dtype=bool), low, np.nan), "mm")


def test_a_model_of_the_wire_gives_the_gain():
    reference = table_of(relays(), np.linspace(0.0, 200.0, 81))
    gain = gain_of_sweeps([SweepRecord.of(swept_run(tau=0.8, gain=0.93))], 0.8 * TAU_S, reference)
    assert gain.value == pytest.approx(0.93 * GAIN, rel=5e-3)
    assert gain.ci95[1] / gain.ci95[0] < 1.02


def test_a_model_of_another_wire_gives_no_gain():
    alpha, beta, mass = relays()
    reference = table_of((3 * alpha, 3 * beta, mass), np.linspace(0.0, 500.0, 81))
    gain = gain_of_sweeps([SweepRecord.of(swept_run())], TAU_S, reference)
    assert "no value within a factor of 2" in gain


def test_lost_and_stale_samples_change_nothing():
    run = swept_run(tau=0.65, gain=1.08)
    stale, quality, y = np.zeros(len(run), dtype=bool), run["quality"].copy(), run["position"].copy()
    stale[500::97] = True
    quality[stale], y[stale] = 2, 99.0  # a stale reading may be anything
    broken = replace(run, columns=run.columns | {"quality": quality, "position": y})
    record = SweepRecord.of(broken)
    assert np.nanmax(record.means(record.position)) < 280 * PER_COUNT
    keep = np.ones(len(run), dtype=bool)
    keep[700:705] = False
    lost = SweepRecord.of(replace(run, columns={name: v[keep] for name, v in run.columns.items()}))
    whole = SweepRecord.of(run)
    assert lost.inputs_K(3.0)[-1] == pytest.approx(whole.inputs_K(3.0)[-1], abs=1e-9)
    assert lost.inputs_K(3.0)[400] == pytest.approx(whole.inputs_K(3.0)[405], abs=1.0)


def test_inputs_are_those_of_the_heating_law():
    run = swept_run()
    record = SweepRecord.of(run)
    assert record.inputs_K(4.0) == pytest.approx(heated(run["current_A"], 4.0)[record.first :], abs=1e-9)


def test_a_run_without_current_or_actuator_is_refused():
    run = swept_run()
    nothing = np.full(len(run), np.nan)
    with pytest.raises(DataError, match="has no current"):
        SweepRecord.of(replace(run, columns=run.columns | {"current_A": nothing}))
    with pytest.raises(DataError, match="does not name its actuator"):
        SweepRecord.of(run.with_meta(actuator=""))


def test_relays_switch_as_they_should():
    alpha, beta, mass = np.array([2.0]), np.array([1.0]), np.array([5.0])
    assert switched([0.0, 1.5, 2.0, 1.5, 1.0, 1.5], alpha, beta, mass).tolist() == [0, 0, 5, 5, 0, 0]


def test_readings_that_contradict_each_other_and_repeated_steps_do_not_count():
    run = swept_run()
    since_s, end_s = 100.0, 120.0
    event = Event(end_s, "warning", "suspect", "The readings contradict each other.", {"since_s": since_s})
    assert SweepRecord.of(run).valid.all()
    spoiled = SweepRecord.of(replace(run, events=(event,)))
    left_out = run["t_s"][spoiled.first :][~spoiled.valid]
    assert left_out.min() == pytest.approx(since_s)
    assert left_out.max() == pytest.approx(end_s)
    first, second, *others = run.steps
    *_, last = others
    interrupted = SweepRecord.of(replace(run, steps=(first, second, *others[:-1], replace(last, void=True))))
    assert interrupted.valid.sum() == run.rows(last).start - interrupted.first
    repeated = SweepRecord.of(replace(run, steps=(replace(first, void=True), second, *others)))
    assert repeated.first == run.rows(second).stop, "the first step that counts is the hold in saturation"
