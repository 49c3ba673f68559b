"""Stress of two antagonist wires against a root finder on the curves of §5.5.1."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from smarig.plant import AntagonistStress, differential_stress

shares = st.floats(0.0, 1.0)


def strain(stress_MPa, austenite):
    """A wire in parts of both phases, one after the other."""
    martensite = (
        stress_MPa / 16800 if stress_MPa <= 16800 * 0.0136 else 0.0136 + (stress_MPa - 16800 * 0.0136) / 826
    )
    return (1 - austenite) * martensite + austenite * stress_MPa / 35917


def by_root(first, second):
    return brentq(lambda s: strain(s, first) + strain(s, second) - 0.06, 0.0, 2000.0, xtol=1e-10)


@given(shares, shares)
def test_both_wires_share_a_stress_and_their_strains_add_up(first, second):
    assert AntagonistStress(22.0).stress_MPa(first + second) == pytest.approx(
        by_root(first, second), rel=1e-9
    )


def test_cold_one_hot_both_hot():
    wires, thesis = AntagonistStress(22.0), differential_stress()
    assert wires.step((0.0, 0.0)) == pytest.approx(thesis.cold_MPa)
    assert wires.step((100.0, 0.0)) == pytest.approx(thesis.hot_MPa)
    assert wires.step((100.0, 100.0)) == pytest.approx(35917 * 0.03)


def test_austenite_stays_until_the_wire_is_below_martensite_start():
    wires = AntagonistStress(22.0)
    wires.step((58.0, 0.0))  # A_f, 80 °C
    assert wires.austenite == [1.0, 0.0]
    wires.step((25.0, 0.0))  # M_s, 47 °C
    assert wires.austenite[0] == pytest.approx(1.0)
    wires.step((11.0, 31.0))  # halfway to M_f; the other at A_s
    assert wires.austenite == pytest.approx([0.5, 0.0])
    wires.step((20.0, 44.5))  # heated again below A_s: no change; the other halfway to A_f
    assert wires.austenite == pytest.approx([0.5, 0.5])


@given(st.lists(st.tuples(st.floats(0, 200), st.floats(0, 200)), min_size=1, max_size=30))
def test_stress_lies_between_cold_and_both_hot(temperatures):
    wires = AntagonistStress(22.0)
    for pair in temperatures:
        foreseen = wires.stress_at(pair)
        stress = wires.step(pair)
        assert foreseen == stress
        assert 241.9 < stress < 1077.6


def test_a_warm_wire_of_unknown_history_may_still_be_austenite():
    wires = AntagonistStress(22.0)
    wires.start((25.0, 11.0))  # M_s, and halfway to M_f
    assert wires.austenite == pytest.approx([1.0, 0.5])
