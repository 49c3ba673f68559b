"""One model of several loads from settled points of a rig: exact for a wire with this law, honest for another one."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from identification.made_runs import made_run
from smarig.core import DataError
from smarig.identification import identify, verify
from smarig.plant import Load
from smarig.record import load_run
from smarig.replay import load_model, simulate_samples, temperature_source, with_wire_temperature
from smarig.runner import Session

C, REFERENCE_MPA, PER_MPA, PER_K = 8.0, 280.0, -0.02, -0.01
LEVELS = np.arange(0.0, 100.0, 12.0)  # of v: one step is 96 MPa
SECTION_MM2 = np.pi / 4 * 0.3**2
LOADS = (280.0, 376.0, 472.0)
long = pytest.mark.long("takes two minutes")


def relays(seed):
    """Relays that switch half way between levels, so that a partition at the levels describes them exactly."""
    rng = np.random.default_rng(seed)
    places = LEVELS[1:-1] + 6.0
    beta, alpha = np.sort(rng.choice(places, (2, 60)), axis=0)
    return alpha, beta, rng.uniform(0.02, 0.3, 60)


def outputs(wire, v):
    """The relays one by one: up from α on, down from β on, all down at the start."""
    alpha, beta, mass = wire
    up, found = np.zeros(alpha.size, dtype=bool), []
    for level in v:
        up = (level >= alpha) | (up & (level > beta))
        found.append(mass @ up)
    return np.array(found)


def curves():
    """All first-order descending curves, which determine the measure between the levels, as levels of v."""
    return LEVELS[
        [0, *(k for top in range(1, LEVELS.size) for k in (*range(1, top + 1), *range(top - 1, -1, -1)))]
    ]


def path(seed, points=60):
    """Levels of v in any order."""
    return LEVELS[[0, *np.random.default_rng(seed).integers(0, LEVELS.size, points)]]


def gain(stress):
    return 1.0 + (stress - REFERENCE_MPA) / 500.0


def law(wire, v, stress):
    """y = g(σ) P[v] + k u + c (σ − σ₀), with u = v + (σ − σ₀)/C, for one stress or one at each point."""
    above = np.asarray(stress) - REFERENCE_MPA
    return gain(stress) * outputs(wire, v) + PER_K * (v + above / C) + PER_MPA * above


def constant(wire, stress, v, name):
    """A run under one load, zeroed under it."""
    u = v + (stress - REFERENCE_MPA) / C
    y = law(wire, v, stress) - law(wire, LEVELS[:1], stress)[0]
    conditions = {"stress": {"unit": "MPa", "mean": stress}}
    return made_run(u, y, name=f"{name}.run.sqlite", conditions=conditions, encoder_zero="power-up")


def changing(wire, seed):
    """A run whose load and temperature change together, zeroed at its start."""
    v = path(seed)
    t = 30.0 * np.arange(v.size)
    stress = np.interp(t, [0.0, t[-1] / 2, t[-1]], [300.0, 400.0, 320.0])
    load = Load(SECTION_MM2, None, "", tuple(t.tolist()), tuple((stress * SECTION_MM2).tolist()))
    y = law(wire, v, stress)
    return made_run(
        v + (stress - REFERENCE_MPA) / C,
        y - y[0],
        name=f"changing_{seed}.run.sqlite",
        load=load.to_json(),
        conditions={"stress": {"unit": "MPa", "mean": 350.0, "min": 300.0, "max": 400.0}},
        encoder_zero="power-up",
    )


@cache
def modelled(seed, *, with_changing=True):
    wire = relays(seed)
    runs = [constant(wire, s, curves(), f"load_{s:.0f}") for s in LOADS]
    return wire, identify([*runs, *([changing(wire, seed + 7)] if with_changing else [])], load_from="stress")


@pytest.mark.long("takes five seconds", cases=("0",))
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=long) for k in range(1, 6))])
def test_a_wire_with_this_law_is_identified_up_to_the_smoothing(seed):
    wire, found = modelled(seed)
    low, high = found.load.interval
    assert low <= C <= high
    assert found.load.value == C
    assert found.model.fit["rms"] < 3e-3, "mm, of a stroke of some 10 mm"
    slope = found.model.fit["load"]["zero_slope"]
    assert slope["value"] == pytest.approx(PER_MPA + PER_K / C, rel=5e-3), "of a run zeroed at v = 0"
    for k, stress in enumerate((312.0, 376.0, 444.0)):
        checked = verify(found.model, constant(wire, stress, path(k), f"other_{k}")).runs[0]
        assert checked.offset_kind == "known"
        assert checked.settled.rms < 1e-2


@pytest.mark.long("takes five seconds")
def test_a_load_that_changes_is_followed_with_memory(tmp_path):
    wire, found = modelled(0)
    model = load_model(found.model.save(tmp_path / "m.model.json"))
    other = changing(wire, 30)
    checked = verify(model, other).runs[0]
    assert checked.offset_kind == "known"
    assert checked.settled.rms < 1e-2
    samples = simulate_samples(model, other) + checked.offset
    assert samples == pytest.approx(other["position"], abs=0.05)
    frozen = other.with_meta(load={"force_N": 350.0 * SECTION_MM2, "section_mm2": SECTION_MM2})
    assert verify(model, frozen, offset="fitted").runs[0].settled.rms > 50 * checked.settled.rms, (
        "the load matters"
    )


@long
def test_without_such_a_run_the_slope_is_fitted_to_the_verified_run_and_said():
    wire, found = modelled(0, with_changing=False)
    assert "zero_slope" not in found.model.fit["load"]
    checked = verify(found.model, changing(wire, 30)).runs[0]
    assert any("zeroed under their own load" in w for w in checked.warnings)
    assert checked.settled.rms < 1e-2


@pytest.mark.long("takes five seconds")
def test_loads_far_outside_and_unknown_loads_are_said():
    wire, found = modelled(0)
    far = verify(found.model, constant(wire, 600.0, path(1), "far")).runs[0]
    assert any("farther outside" in w for w in far.warnings)
    assert far.expected is None
    near = verify(found.model, constant(wire, 500.0, path(1), "near")).runs[0]
    assert near.expected == found.load.left_out_rms(beyond=True)
    assert not any("farther outside" in w for w in near.warnings)
    bare = made_run([0.0, 50.0, 20.0, 0.0], [0.0, 1.0, 1.0, 0.0])
    with pytest.raises(DataError, match="does not state it"):
        verify(found.model, bare)
    with pytest.raises(DataError, match="does not state its stress"):
        identify([constant(wire, 280.0, path(1), "a"), bare], load_from="stress")


def test_runs_of_changing_loads_alone_are_refused():
    with pytest.raises(DataError, match="constant loads"):
        identify([changing(relays(0), 1)], load_from="stress")


def cycles(folder, weight, points, seed=0):
    out = folder / f"{weight:g}.run.sqlite"
    with Session("one_wire_thermomechanical", seed=seed, load=str(weight), wire=f"w{weight}") as session:
        return load_run(session.run("constant_force_cycles", {"cycles": 1, "points": points}, out))


@pytest.mark.long
def test_the_slope_of_the_thermomechanical_wire_is_found_by_its_own_temperature(tmp_path):
    """The twin has 8 MPa/K. By the heating model's kelvins the same runs give 9 to 10."""
    runs = [cycles(tmp_path, weight, 14) for weight in (20, 24, 28)]
    assert temperature_source(runs) == "power"
    found = identify(runs, load_from="stress")
    low, high = found.load.interval
    assert low <= 8.0 <= high
    assert high - low < 2.0
    assert np.abs(with_wire_temperature(runs[0], "power").points()[0] - runs[0].points()[0]).max() > 8.0


@long
def test_two_weights_between_are_predicted_within_twice_the_noise(tmp_path):
    runs = {w: cycles(tmp_path, w, 100, seed=round(10 * w)) for w in (20, 21.5, 23, 24.5, 26, 28)}
    found = identify([runs[w] for w in (20, 23, 26, 28)], load_from="stress")
    low, high = found.load.interval
    assert low <= 8.0 <= high
    assert high - low < 0.3
    assert found.load.own
    for weight in (21.5, 24.5):
        checked = verify(found.model, runs[weight]).runs[0]
        assert checked.offset_kind == "known"
        assert checked.settled.rms <= 2 * checked.noise_floor


def test_a_damaged_slope_of_a_model_is_refused_in_a_sentence():
    wire, found = modelled(0)
    load = {**found.model.fit["load"], "zero_slope": {"value": 0.1}}
    with pytest.raises(DataError, match="reference_MPa"):
        verify(replace(found.model, fit={**found.model.fit, "load": load}), changing(wire, 30))
