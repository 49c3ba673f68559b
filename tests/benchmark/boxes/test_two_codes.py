"""The boxes and the plant of smarig, two implementations of one description, along one current staircase.

Their difference must be small compared with the effect itself. This is the only test of the boxes that
imports ``smarig.plant``.
"""

from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from benchmark.boxes.small import HOLDS, WIRES, few_relays
from benchmarks.boxes.box_effects import EFFECTS
from benchmarks.boxes.box_plant import BoxPlant
from benchmarks.boxes.box_session import simulate_on_grid, simulate_on_new_grid
from benchmarks.boxes.output_effects import position, sensor_output
from benchmarks.boxes.wire import actuator_toml
from smarig.core.catalogue import catalogue_entry
from smarig.plant.actuator import Actuator
from smarig.plant.effect_catalogue import effect_types
from smarig.plant.plant import Plant as EstimatorsPlant
from smarig.preisach.hysteresis.relay_measure import RelayMeasure

NAMES = sorted({kind.name for rig in ("one_wire", "two_wire") for kind in effect_types(rig)})
VALUES = {  # where the typical ones would not show all of the equation
    "ambient_drift": {"swing_K": 2.0, "period_h": 0.7, "phase": 0.1},
    "amplifier_gain": {"gain_percent": 3.0, "offset_A": 0.01},
    "latent_heat": {"latent_J_per_g": 20.0, "cooling_ratio": 0.7, "specific_heat_change_percent": 20.0},
    "sensor_lag": {"lag_s": 3.0, "dead_time_s": 1.0},
    "settling": {"share_percent": 3.0, "time_constant_s": 300.0},
    "slip": {"jump_percent": 2.0, "at_h": 0.2},
}
RELAYS = 1100  # the operator of the estimator holds a square of them
TRANSIENT = {"wire_lag", "latent_heat", "sensor_lag"}  # steady states do not show them
# Shares of the effect's own size, settled points (all times for the transient ones). 0.5 % but for:
WIDE = {
    "latent_heat": 0.04,  # steps of a box: heat first, relays after (0.03); the plant's books close a tick late
    "sensor_lag": 0.03,  # position is linear between the times of a box, a staircase of ticks in the plant
}


@lru_cache(maxsize=1)  # its relays are large
def estimators_rig(rig):
    """Actuator, from the file a box would write, and the same relays as a measure."""
    h = few_relays(rig, RELAYS)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "actuator.toml"
        path.write_text(actuator_toml(WIRES[rig], rig), encoding="utf-8")
        actuator = Actuator.named(str(path))
    return actuator, RelayMeasure.from_arrays(h.alpha, h.beta, h.mass / h.mass.sum() * h.stroke / 2)


PAIRS = [  # the order in which effects follow one another
    ("accommodation", "stress_coupling"),
    ("amplifier_gain", "dead_zone"),
    ("backlash", "eccentricity"),
    ("coulomb_friction", "temperature_memory"),
    ("creep", "walking"),
    ("fatigue", "settling"),
    ("noncongruency", "r_phase"),
    ("resistance_phase", "slack"),
]


def estimators(rig, grid, hidden):
    """Positions of the estimator's plant, stepped by 0.1 s, at the times of a grid."""
    wire, (actuator, measure) = WIRES[rig], estimators_rig(rig)
    effects = [catalogue_entry("smarig.plant.effects", name)(**values) for name, values in hidden.items()]
    start = "anhysteretic" if wire.two_wire else "negative"
    plant = EstimatorsPlant(actuator, measure, start, 0.1, effects)
    positions = []
    for k, ticks in zip(grid.hold.tolist(), np.diff(grid.tick, prepend=0).tolist()):
        for _ in range(ticks):
            y = plant.sensed(plant.step(wire.command(HOLDS[rig][k].target_K)))
        positions.append(y)
    return np.array(positions)


def rms(x):
    return float(np.sqrt(np.mean(x**2)))


def test_the_catalogues_agree():
    assert sorted(EFFECTS) == sorted(NAMES)
    for name, mine in EFFECTS.items():
        theirs = catalogue_entry("smarig.plant.effects", name)
        p = theirs.primary
        assert (mine.strength, mine.lower, mine.upper, mine.typical) == (p.name, p.lower, p.upper, p.typical)
        known = {p.name: p for p in theirs.parameters}
        assert set(mine.values({})) == set(known)
        for second in mine.secondary:
            q = known[second.name]
            assert q.typical == second.default
            assert second.scale == "session" or q.lower <= second.low <= second.high <= q.upper


def both(*hidden_names):
    """Grid, positions of both codes and of the generator without effects (n,)."""
    rig = next((EFFECTS[n].only for n in hidden_names if EFFECTS[n].only), "one_wire")
    wire, h, holds = WIRES[rig], few_relays(rig, RELAYS), HOLDS[rig]
    hidden = {name: EFFECTS[name].values(VALUES.get(name, {})) for name in hidden_names}
    grid, record = simulate_on_new_grid(BoxPlant(wire, h, hidden), wire, holds, lambda _: 0.0)
    own = sensor_output(position(record, wire, h, hidden), record.t_s, hidden)
    bare = position(simulate_on_grid(BoxPlant(wire, h, {}), wire, holds, grid), wire, h, {})
    return grid, own, estimators(rig, grid, hidden), bare


@pytest.mark.parametrize("name", NAMES)
def test_both_codes_agree(name):
    grid, own, theirs, bare = both(name)
    size, apart = own - bare, own - theirs
    if name not in TRANSIENT:
        size, apart = grid.settled(size), grid.settled(apart)
    assert rms(size) > 0.01  # mm: there is something to compare
    assert rms(apart) < WIDE.get(name, 0.005) * rms(size)
    assert rms(grid.settled(own - theirs)) < 0.01  # a fifth of a count, whatever the effect


@pytest.mark.parametrize("pair", PAIRS)
def test_both_codes_agree_on_two_effects(pair):
    grid, own, theirs, bare = both(*pair)
    assert rms(grid.settled(own - theirs)) < 0.005 * rms(grid.settled(own - bare))
