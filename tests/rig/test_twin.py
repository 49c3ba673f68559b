"""The twin: the rig contract, its instruments, and its physics against closed forms."""

import math

import numpy as np
import pytest

from rig.rig_contract import drive
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.rig.specimen import TickNoise
from smarig.rig.twin import Twin


def test_noise_free_position_follows_heating_and_hysteresis_in_closed_form():
    twin = Twin.named("one_wire_twin", noise=False)
    samples = drive(twin, [0.6] * 400)
    t = np.array([s.t_s for s in samples])
    temperature = 174.1 * 0.36 * (1 - np.exp(-t / twin.actuator.tau_s))
    expected = thesis_surface("one_e").y(temperature, temperature) / twin.position_per_count
    assert np.max(np.abs(np.array([s.counts for s in samples]) - expected)) <= 0.5 + 1e-9
    assert samples[-1].counts > 90


def test_encoder_is_relative_to_power_up():
    twin = Twin.named("two_wire_twin", noise=False)
    assert drive(twin, [0.0])[0].counts == 0, "the anhysteretic state is not at zero output, the encoder is"


def test_voltage_gives_the_phase_weighted_resistance():
    twin = Twin.named("one_wire_twin", noise=False)
    cold, hot = drive(twin, [0.05])[0], drive(twin, [1.0] * 900)[-1]
    assert math.isclose(cold.voltage_V / cold.current_A, 5.0, rel_tol=1e-3)
    assert math.isclose(hot.voltage_V / hot.current_A, 4.5, rel_tol=1e-3)


def test_differential_voltage_belongs_to_the_heated_wire():
    twin = Twin.named("two_wire_twin", noise=False)
    hot = drive(twin, [-1.0] * 900)[-1]
    assert hot.voltage_V < 0
    assert math.isclose(hot.voltage_V / hot.current_A, 1.895, rel_tol=1e-2)


def test_noise_has_the_levels_of_the_rig_file():
    twin = Twin.named("one_wire_twin", seed=3)
    drive(twin, [0.7] * 1200)
    samples = drive(twin, [0.7] * 4000)
    counts = np.array([s.counts for s in samples])
    current = np.array([s.current_A for s in samples])
    assert math.isclose(counts.std(), math.sqrt(0.4**2 + 1 / 12), rel_tol=0.08)
    assert math.isclose(current.std(), 0.0002, rel_tol=0.08)


def test_temperature_noise_is_remembered_by_the_hysteresis():
    twin = Twin.named("one_wire_twin", seed=3)
    noisy = twin.file.model_copy(update={"temperature_noise_K": 1.5})
    twin = Twin(noisy, twin.actuator, twin.settings)
    drive(twin, [0.55] * 1000)
    early = np.mean([s.counts for s in drive(twin, [0.55] * 500)])
    drive(twin, [0.55] * 20000)
    late = np.mean([s.counts for s in drive(twin, [0.55] * 500)])
    assert late > early + 1, "extremes of the disturbance ratchet the wire upwards at constant current"


def test_noise_is_a_function_of_seed_channel_and_tick():
    assert TickNoise(1, 0).at(5000) == TickNoise(1, 0).at(5000)
    assert TickNoise(1, 0).at(5000) != TickNoise(1, 1).at(5000)
    values = [TickNoise(2, 1).at(k) for k in (0, 4095, 4096, 8192)]
    assert len(set(values)) == 4


def test_bad_values_are_refused():
    with pytest.raises(UsageError, match="NaN"):
        Twin.named("one_wire_twin").step(float("nan"))
    with pytest.raises(UsageError, match="negative"):
        Twin.named("one_wire_twin", seed=-1)
