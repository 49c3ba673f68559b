"""The test of equal vertical chords distinguishes congruent, chord-equal and other loops at its stated error
rate."""

import numpy as np
import pytest

from identification.made_runs import made_run
from smarig.core.errors import DataError
from smarig.identification.extended.chord_test import equal_chords, loops
from smarig.identification.noise_floor import NoiseFloor
from theory.extended import truths

NOISE = 0.01
KNOWN = NoiseFloor(NOISE, 0, "mm", "repeats")


def line(start, stop, points=6):
    """Inputs from start (left out) to stop."""
    return list(start + (stop - start) * np.arange(1, points + 1) / points)


def congruency(low, high, crest):
    """The protocol of §5.3.2: loop A from its top on the rising branch, a crest, loop B from its bottom."""
    turns = [0.0, high, low, high, crest, low, high, low, 0.0]
    return [0.0, *(u for a, b in zip(turns, turns[1:]) for u in line(a, b))]


INPUTS = [congruency(40.0, 80.0, 135.0), congruency(60.0, 100.0, 140.0)]
WIRES = {
    "Preisach": truths.classical,
    "non-linear Preisach": lambda u: truths.nonlinear(u, 1.0),
    "neither": lambda u: truths.moving(u, 2.0),
}


@pytest.fixture(scope="module")
def outputs():
    return {name: [wire(u) for u in INPUTS] for name, wire in WIRES.items()}


def judged(outputs, seed, floor=KNOWN):
    rng = np.random.default_rng(seed)
    runs = [made_run(u, y + NOISE * rng.standard_normal(len(u))) for u, y in zip(INPUTS, outputs)]
    return equal_chords(runs, floor)


@pytest.mark.parametrize("name", WIRES)
def test_the_verdict_is_right(outputs, name):
    verdicts = [judged(outputs[name], seed).verdict for seed in range(20)]
    assert verdicts.count(name) >= 18


@pytest.mark.long("takes three seconds")
@pytest.mark.parametrize("floor", [KNOWN, NoiseFloor(NOISE, 10**6, "mm", "repeats")])
def test_p_values_are_uniform_where_the_property_holds(outputs, floor):
    classical = [judged(outputs["Preisach"], seed, floor) for seed in range(200)]
    chords = [judged(outputs["non-linear Preisach"], seed, floor).p_chords for seed in range(200)]
    for p in ([t.p_congruent for t in classical], [t.p_chords for t in classical], chords):
        assert np.mean(p) == pytest.approx(0.5, abs=0.08)
        assert 0.02 <= np.mean(np.array(p) < 0.1) <= 0.19


def test_what_is_left_is_the_noise(outputs):
    left = [judged(outputs["Preisach"], seed) for seed in range(50)]
    assert np.mean([t.rms_congruent for t in left]) == pytest.approx(NOISE, rel=0.05)
    assert np.mean([t.rms_chords for t in left]) == pytest.approx(NOISE, rel=0.05)


def test_an_uncertain_noise_makes_the_test_milder(outputs):
    few = NoiseFloor(NOISE, 3, "mm", "repeats")
    assert judged(outputs["neither"], 1, few).p_chords > judged(outputs["neither"], 1).p_chords


def test_loops_are_found_where_the_protocol_drives_them():
    found = [
        loop for loop in loops([made_run(INPUTS[0], np.zeros(len(INPUTS[0])))]) if loop.ends == (40.0, 80.0)
    ]
    assert [loop.u.size for loop in found] == [5, 5]


def test_loops_without_a_partner_are_refused():
    with pytest.raises(DataError, match="congruency protocol"):
        equal_chords([made_run([0.0, 100.0, 50.0, 0.0], np.zeros(4))], KNOWN)


def test_an_unknown_noise_is_refused(outputs):
    with pytest.raises(DataError, match="noise"):
        judged(outputs["Preisach"], 0, NoiseFloor(None, 0, "mm", "none"))
