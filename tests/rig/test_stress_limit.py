"""Two wires that are both hot: refused before it happens, by the force balance of an independent reference."""

import os

import numpy as np
import pytest
from scipy.optimize import brentq

from smarig.config import load_rig
from smarig.core import ConfigError, Elapsed, Hold, LimitExceeded, UsageError
from smarig.plant import Actuator
from smarig.rig import Guard, Twin, TwinSettings, inconsistencies, stress_limit
from smarig.runner import preview

A_S, A_F, M_S, M_F = 53.0, 80.0, 47.0, 19.0  # °C
CAMPAIGNS = 200 if os.environ.get("SMARIG_LONG") else 60


def limited(most_MPa, rig="two_wire_twin"):
    file = load_rig(rig)
    return file.model_copy(update={"limits": file.limits.model_copy(update={"stress_max_MPa": most_MPa})})


def reference_stress_MPa(temperatures_degC):
    """The largest stress along the true temperatures of both wires, by a root finder."""
    phases, most = [0.0, 0.0], 0.0
    for pair in temperatures_degC:
        for k, T in enumerate(pair):
            rising = np.interp(T, [A_S, A_F], [0, 1])
            falling = np.interp(T, [M_F, M_S], [0, 1])
            phases[k] = float(max(rising, min(phases[k], falling)))
        most = max(most, sum(phases))

    def strains(s):
        martensite = s / 16800 if s < 228.48 else 0.0136 + (s - 228.48) / 826
        return (2 - most) * martensite + most * s / 35917 - 0.06

    return brentq(strains, 1.0, 2000.0)


def random_campaign(rng, file):
    """Random holds of random length; the true stress until the end or after the trip, and whether it tripped."""
    actuator = Actuator.named(file.actuator)
    twin = Twin(file, actuator, TwinSettings(seed=int(rng.integers(1000))))
    guard = Guard(twin, file.limits, actuator, stress=stress_limit(file, actuator))
    levels = rng.choice([-1, 1], 12) * rng.uniform(0.2, 1.0, 12) * rng.choice([0, 1, 1], 12)
    true, tripped = [], ""
    for current_A in np.repeat(levels, rng.integers(5, 150, 12)).tolist():
        try:
            guard.step(current_A)
        except LimitExceeded as refused:
            tripped = str(refused)
            break
        true.append([T + file.ambient_degC for T in twin.specimen.plant.heating.wire_K])
    for _ in range(200 if tripped else 0):  # what follows the trip
        assert "Both wires would be hot" in tripped
        assert twin.step(0.0)[0].current_command_A == 0.0
        true.append([T + file.ambient_degC for T in twin.specimen.plant.heating.wire_K])
    return reference_stress_MPa(true), bool(tripped)


def test_the_true_stress_never_exceeds_its_limit():
    rng = np.random.default_rng(20)
    outcomes = []
    for _ in range(CAMPAIGNS):
        limit_MPa = float(rng.uniform(265, 900))
        stress_MPa, tripped = random_campaign(rng, limited(limit_MPa))
        assert stress_MPa <= limit_MPa
        outcomes.append((stress_MPa, tripped))
    assert (
        CAMPAIGNS / 5 < sum(tripped for _, tripped in outcomes) < CAMPAIGNS
    )  # some are refused, others are not
    assert max(stress for stress, _ in outcomes) > 450  # and the limits are used


@pytest.mark.parametrize("cooled_ticks", [0, 60, 90, 120])
def test_a_host_that_is_late_by_a_lease_keeps_the_limit(cooled_ticks):
    """The last current that is allowed may flow on until the lease ends."""
    file = limited(320.0)
    actuator = Actuator.named(file.actuator)
    allowed = 0
    for late in (False, True):
        twin = Twin(file, actuator, TwinSettings(noise=False))
        guard = Guard(twin, file.limits, actuator, stress=stress_limit(file, actuator))
        true = []
        steps = [0.9] * 200 + [0.0] * cooled_ticks + [-0.9] * (allowed if late else 100)
        for k, current_A in enumerate(steps):
            try:
                guard.step(current_A)
            except LimitExceeded:
                allowed = k - 200 - cooled_ticks
                break
            true.append([T + file.ambient_degC for T in twin.specimen.plant.heating.wire_K])
    twin.idle(file.lease_s)
    true.append([T + file.ambient_degC for T in twin.specimen.plant.heating.wire_K])
    assert 0 <= allowed < 100
    assert reference_stress_MPa(true) <= 320.0


def test_without_a_limit_both_wires_become_hot():
    rng = np.random.default_rng(21)
    assert max(random_campaign(rng, limited(None))[0] for _ in range(10)) > 800


def test_the_preview_refuses_a_protocol_that_would_heat_both():
    def protocol(setup):
        yield Hold(0.9, Elapsed(60.0))
        yield Hold(-0.9, Elapsed(60.0))

    with pytest.raises(UsageError, match="not started.*Both wires would be hot.*stress_max_MPa = 300"):
        preview("hasty", limited(300.0), protocol_factory=protocol)
    preview("hasty", limited(1100.0), protocol_factory=protocol)


@pytest.mark.parametrize(
    ("rig", "limit", "words"),
    [
        ("one_wire_twin", 300.0, "applies to two wires"),
        ("two_wire_twin", 200.0, "below 261 MPa, the stress with one hot wire at ambient_degC = 22"),
        ("two_wire_twin", 250.0, "below 261 MPa, the stress with one hot wire at ambient_degC = 22"),
    ],
)
def test_limits_that_make_no_sense(rig, limit, words):
    file = limited(limit, rig)
    actuator = Actuator.named(file.actuator)
    with pytest.raises(ConfigError, match=words):
        stress_limit(file, actuator)
    assert [words in problem for problem in inconsistencies(file)] == [True]


def test_a_bench_of_two_real_wires_needs_a_limit():
    free = load_rig("two_wire_serial")
    assert not any("stress_max_MPa" in s for s in inconsistencies(free))  # simulated wires do not break
    hardware = free.model_copy(update={"simulator": None})
    problem = next(s for s in inconsistencies(hardware) if "stress_max_MPa is missing" in s)
    assert "up to 1078 MPa" in problem
    limits = free.limits.model_copy(update={"stress_max_MPa": 300.0})
    assert not any(
        "stress_max_MPa" in s for s in inconsistencies(hardware.model_copy(update={"limits": limits}))
    )
    one = load_rig("bench_one_wire")
    assert not any("stress_max_MPa" in s for s in inconsistencies(one))
