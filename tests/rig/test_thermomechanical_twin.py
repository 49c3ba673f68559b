"""The twin of a thermomechanical wire: what it refuses, and what takes its place."""

import pytest

from rig.lying import TamperedRig
from smarig.config import load_rig
from smarig.core.errors import LimitExceeded, UsageError
from smarig.plant import Actuator, Plant, ThermomechanicalPlant, effects_from_pairs
from smarig.preisach import thesis_surface
from smarig.rig import Guard, Plausibility, Twin, TwinSettings

RIGS = ("one_wire_thermomechanical", "two_wire_thermomechanical", "flexinol_015", "flexinol_031")


@pytest.mark.parametrize("rig", RIGS)
def test_it_moves_returns_and_repeats(rig):
    samples = []
    for _ in range(2):
        twin = Twin.named(rig, seed=4)
        current_A = twin.file.limits.current_max_A
        ticks = round(60.0 / twin.period_s)
        samples.append([twin.step(i)[0] for i in (current_A, 0.0) for _ in range(ticks)])
    assert samples[0] == samples[1]
    hot = samples[0][ticks - 1]
    assert hot.position > (
        50.0 if twin.actuator.two_wire else 0.03 * twin.actuator.file.wire.active_length.value
    )
    assert hot.voltage_V == pytest.approx(
        hot.current_A * twin.actuator.file.heating.resistance_austenite.value, rel=0.05
    )


@pytest.mark.long("takes three seconds")
def test_holds_within_a_narrow_transformation_are_no_slip():
    """The input hardly changes between two holds, and the wire moves through most of its travel."""
    twin = Twin.named("two_wire_thermomechanical", seed=1)
    bench = twin.file.model_copy(update={"kind": "bench"})
    guard = Guard(twin, twin.file.limits, twin.actuator, Plausibility(bench, twin.actuator))
    positions = []
    for input_K in (-185.0, 0.0, 56.0, 62.0, 68.0, 73.5):  # the other wire first: the way is then longest
        for _ in range(900):
            ((sample, _),) = guard.step(twin.actuator.current_for(input_K))
        positions.append(sample.position)
    assert positions[-1] - positions[2] > 40.0
    assert guard.alarms() == []


def driven(guard, currents_A):
    for current_A in currents_A:
        for _ in range(600):
            guard.step(current_A)


def test_motion_is_judged_by_the_travel_of_the_wires():
    """2 % of their travel is no motion, although it is 7 % of the travel of the surface in [hysteresis]."""
    rig = TamperedRig("two_wire_thermomechanical", lambda s: s._replace(counts=round(0.02 * s.counts)))
    actuator = Actuator.named(rig.file.actuator)
    guard = Guard(rig, rig.file.limits, actuator, Plausibility(rig.file, actuator))
    with pytest.raises(LimitExceeded, match="did not move|away from all that a wire"):
        driven(guard, (1.0, 0.0, -1.0))


def test_effects_and_initial_states_are_those_of_an_operator():
    with pytest.raises(
        UsageError, match="Effects act on a Preisach operator, and the wire of thermomechanical_one"
    ):
        Twin.named(RIGS[0], effects=effects_from_pairs(["walking=0.2"]))
    with pytest.raises(UsageError, match="starts cold under its load"):
        Twin.named(RIGS[0], initial="anhysteretic")
    file = load_rig(RIGS[0]).model_copy(update={"hidden_effect": True})
    with pytest.raises(UsageError, match="Effects act on a Preisach operator"):
        Twin(file, Actuator.named(file.actuator))


def test_a_given_hysteresis_takes_the_place_of_the_wire():
    """As on every rig: a simulation uses the model, not the hardware."""
    file = load_rig(RIGS[0])
    settings = TwinSettings(hysteresis=thesis_surface("one_c"))
    assert isinstance(Twin(file, Actuator.named(file.actuator), settings).specimen.plant, Plant)
    assert isinstance(Twin.named(RIGS[0]).specimen.plant, ThermomechanicalPlant)
