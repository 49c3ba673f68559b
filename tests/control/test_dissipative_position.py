"""§9.2: controllers that match the supply rate, its assumptions for a hysteresis, and scheduled gains."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from control.findings_page import CLASSES
from control.measures import DT_S, tables
from smarig.certificate.position_assumptions import indistinguishable_states, supply_while_held
from smarig.certificate.position_supply_rate import PositionController, SupplyRate
from smarig.control.position_feedback import SwitchedGain, position_loop
from smarig.core.errors import DataError, UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.theory.energy import available_storage
from smarig.theory.properties.classes import classes

OMEGA = np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 4001)])
coefficient = st.floats(-10, 10, allow_subnormal=False).map(lambda x: round(x, 3))


@st.composite
def second_order(draw):
    n = draw(st.lists(coefficient, min_size=1, max_size=3))
    d = [draw(st.floats(0.1, 10)), draw(st.floats(0.05, 5)), draw(st.floats(0.1, 10))]
    return PositionController.of(n, d[: draw(st.integers(max(1, len(n)), 3))])


@given(
    second_order(), st.sampled_from([0.0, 0.1, 1.0]), st.sampled_from([0.0, 1.0]), st.sampled_from([0.0, 1.0])
)
def test_the_class_is_decided_as_a_dense_sweep_decides_it(k, a, b, c):
    supply = SupplyRate(a, b, c)
    scale = 1e-6 * (1 + np.abs(k.at(OMEGA)).max() ** 2)
    least = float((k.density(OMEGA, supply) / (1 + OMEGA)).min())
    if k.matches(supply):
        assert least >= -scale
        assert k.static_gain >= 0
    elif k.stable and k.static_gain >= 0:
        assert least < scale


MEMBERS = ("filtered velocity 10s/(1 + 0.5s)", "filtered acceleration 10s²/(1 + 0.8s + s²)")


def test_members_have_no_static_gain():
    assert {n for n, (k, d) in CLASSES.items() if PositionController.of(k, d).largest_a()} == set(MEMBERS)


@pytest.mark.parametrize("name", MEMBERS)
def test_a_member_never_gives_more_than_it_was_supplied(name: str):
    """∫ w_c from rest, at every T, by simulation; and beyond the largest a some input breaks it."""
    k = PositionController.of(*CLASSES[name])
    a = k.largest_a()
    assert a > 0.1
    rng, t = np.random.default_rng(2), np.linspace(0.0, 40.0, 40001)
    rough = np.interp(t, np.arange(0.0, 41.0), np.concatenate([[0.0], rng.normal(0, 1, 40)]))
    assert integral(k, rough, t, a).min() >= -1e-3
    slow = np.sin(0.02 * np.pi * t * 50) * np.minimum(t, 1.0)
    worst = OMEGA[np.argmin(k.density(OMEGA, SupplyRate(1.05 * a)) / (1e-12 + OMEGA**2 / (1 + OMEGA**2)))]
    assert k.density(np.array([worst]), SupplyRate(1.05 * a))[0] < 0
    assert integral(k, slow, t, 3 * a)[-1] < 0


def integral(k: PositionController, u: np.ndarray, t: np.ndarray, a: float) -> np.ndarray:
    """∫ (u̇ Ku − a²|Ku|²) up to every T; in the convention of K that is w_c with b = c."""
    from scipy.signal import lsim

    _, y, _ = lsim((k.numerator[::-1], k.denominator[::-1]), u, t)
    middle = (y[1:] + y[:-1]) / 2
    return np.cumsum(np.diff(u) * middle - a**2 * middle**2 * np.diff(t))


def test_with_a_static_gain_nothing_is_left_of_a():
    """(*) at ω = 0: with b = c every controller that answers a steady error has a = 0, and c > b has no member."""
    for numerator, denominator in CLASSES.values():
        k = PositionController.of(numerator, denominator)
        assert (k.largest_a() > 0) <= (k.static_gain == 0)
        assert not k.matches(SupplyRate(0.0, 0.0, 0.1))


def test_a_hysteresis_has_no_b():
    model = thesis_surface("two_c")
    held = [supply_while_held(model, 60.0, t, b=0.01) for t in (0.0, 1e6, 2e6)]
    assert held[1] < -1000.0
    assert held[2] - held[1] == pytest.approx(held[1] - held[0])
    assert supply_while_held(model, 60.0, 1e9, b=0.0) == held[0] > 0


def test_states_of_one_output_are_indistinguishable_at_zero_input():
    model = thesis_surface("two_e")
    pair = indistinguishable_states(model)
    first, second = Preisach(model, pair.first), Preisach(model, pair.second)
    assert (first.u, second.u) == (0.0, 0.0)
    assert first.y == pytest.approx(second.y, abs=1e-9)
    assert pair.distance > 0.1 * pair.most
    assert abs(first.step(60.0) - second.step(60.0)) > 0.5, "they are different states: an input tells"
    with pytest.raises(UsageError, match="one side"):
        indistinguishable_states(thesis_surface("one_c"))


laws = st.builds(SwitchedGain, st.floats(0.1, 5), st.floats(5, 50), st.floats(0.05, 2), st.floats(0.2, 5))


@pytest.mark.long("takes two seconds")
@settings(max_examples=20)
@given(tables, laws, st.floats(-2, 8), st.lists(st.floats(-3, 3), max_size=3), st.sampled_from([0.0, 0.5]))
def test_a_gain_switched_by_the_error_has_a_certificate(model, law, goal, past, lag_s):
    """V = Q_r + Φ(e) never rises: constant reference, increasing φ, with and without lag, on ν ≥ 0."""
    assert law.increasing
    start = Preisach(model, "anhysteretic")
    start.follow(past)
    loop = position_loop(model, law, np.full(40, goal), dt_s=DT_S, initial=start.state, lag_s=lag_s)
    v = loop.certificate(law.potential)
    assert np.diff(v).max() <= 1e-9 * (1 + v[0])
    np.testing.assert_allclose(loop.y, goal - loop.error, atol=1e-12)


def test_the_potential_is_the_integral_of_the_law():
    law = SwitchedGain(20.0, 60.0, 0.5, below=2.0)
    for error in (0.3, 2.0, -0.4, -1.5):
        e = np.linspace(0.0, error, 200001)
        assert law.potential(error) == pytest.approx(np.trapezoid([law(0, x) for x in e], e), rel=1e-4)


def test_the_certificate_is_about_storage():
    """Q_r is S_a for ν ≥ 0, so V counts all that can be taken out."""
    model = thesis_surface("two_c")
    assert classes(model).positive
    loop = position_loop(model, SwitchedGain(60.0, 60.0, 1.0), np.full(3, 6.0))
    wire = Preisach(model, "anhysteretic")
    for u in loop.u:
        wire.step(u)
    assert available_storage(model, wire.state).value == pytest.approx(loop.stored[-1], rel=1e-6)


def test_schedules_by_time_and_delay_have_none():
    goal = np.full(300, 4.0)
    by_time = position_loop(
        thesis_surface("two_e"), lambda k, e: (60.0 if k // 25 % 2 else 20.0) * e, goal, lag_s=1.0
    )
    assert by_time.late_travel() > 0.5, "the wire is kept moving by the schedule alone"
    hard = SwitchedGain(6000.0, 6000.0, 1.0)
    prompt = position_loop(thesis_surface("two_e"), hard, goal, lag_s=5.3)
    late = position_loop(thesis_surface("two_e"), hard, goal, lag_s=5.3, delayed=True)
    assert prompt.late_travel() < 1e-6
    assert late.late_travel() > 1.0, "a tick's delay is enough for a limit cycle"
    assert np.diff(prompt.certificate(hard.potential)).max() <= 1e-6
    assert np.diff(late.certificate(hard.potential)).max() > 1.0


@pytest.mark.parametrize(
    ("n", "d"), [([np.nan], [1.0]), ([1.0], [1.0, 2.0, 3.0, 4.0]), ([0.0, 0.0, 1.0], [1.0])]
)
def test_what_is_no_position_controller_is_refused(n, d):
    with pytest.raises(UsageError, match="position controller"):
        PositionController.of(n, d)


def test_a_reference_is_required():
    with pytest.raises(DataError, match="finite references"):
        position_loop(thesis_surface("two_e"), SwitchedGain(1.0, 1.0, 1.0), [])
