"""The physics of each effect, against closed forms and against the gauge theorem.

The theorem (steady states, constant room and load): an effect that maps the current monotonically to the
local temperature, adds relays in parallel or scales the output gives another classical Preisach operator in
current. Such an effect keeps return-point memory and congruency exactly, and no refitted density can show
it.
"""

import numpy as np
import pytest

from plant.effects.driven import CATALOGUE, WIRES, driven, kind, settled, wire_of
from smarig.plant.effect import EffectContext
from smarig.plant.plant import Plant
from smarig.preisach.hysteresis.relay_measure import RelayMeasure
from smarig.preisach.operator import Preisach

CLASSICAL = [
    "wire_lag",
    "latent_heat",
    "convection",
    "end_conduction",
    "r_phase",
    "amplifier_gain",
    "dead_zone",
    "sensor_lag",
    "coulomb_friction",
    "thermal_expansion",
    "saturation",
]
FORGETFUL = {  # strong enough to be seen in a short record
    "ambient_drift": {"swing_K": 4.0, "period_h": 0.5},
    "settling": {"share_percent": 8.0, "time_constant_s": 400.0},
    "accommodation": {},
    "fatigue": {"cycles": 2.0},
    "walking": {"percent_per_cycle": 2.0},
    "slip": {"jump_percent": 5.0, "at_h": 0.14},
    "creep": {"percent_per_decade": 4.0},
}
INCONGRUENT = {"resistance_phase": None, "stress_coupling": None, "noncongruency": None, "eccentricity": 10.0}
MAJOR = [0.98, 0.05]
LOOP = [0.6, 0.35]  # a minor loop, between these currents, on both branches
HIGH, LOW = [*MAJOR, *LOOP * 3], [*MAJOR, 0.98, *reversed(LOOP * 3)]
PER_COUNT = WIRES["one_wire"][0].position_per_count(2000)


def misses(effect):
    """How far repeats of a minor loop miss, and how much its two congruent copies differ in height (counts)."""
    rise = settled(HIGH, effect, hold_s=90.0) / PER_COUNT
    fall = settled(LOW, effect, hold_s=90.0) / PER_COUNT
    repeat = max(np.ptp(rise[2::2]), np.ptp(rise[3::2]), np.ptp(fall[3::2]), np.ptp(fall[4::2]))
    heights = abs(rise[6] - rise[5]), abs(fall[7] - fall[6])
    return repeat, abs(heights[0] - heights[1])


@pytest.mark.parametrize("name", CLASSICAL)
def test_gauge_theorem_the_effect_leaves_a_classical_preisach_operator(name):
    repeat, height = misses(kind(name)())
    assert repeat < 0.03
    assert height < 0.03


@pytest.mark.parametrize("name", FORGETFUL)
def test_it_breaks_return_point_memory(name):
    repeat, _ = misses(kind(name)(**FORGETFUL[name]))
    assert repeat > 0.5


@pytest.mark.parametrize("name", INCONGRUENT)
def test_it_keeps_return_point_memory_and_breaks_congruency(name):
    repeat, height = misses(kind(name)(INCONGRUENT[name]))
    assert repeat < 0.3
    assert height > 0.3


def test_temperature_memory_breaks_wiping_out():
    """A full heating erases every earlier one (§3.3.1); an arrest is remembered all the same."""
    staircase = np.linspace(0.4, 0.9, 26).tolist()
    before = settled([*MAJOR, *staircase])[2:]
    arrests = [0.68, 0.05] * 3
    after = settled([*MAJOR, *arrests, *staircase], kind("temperature_memory")(2.5))[8:]
    unarrested = settled([*MAJOR, *staircase], kind("temperature_memory")(2.5))[2:]
    np.testing.assert_allclose(unarrested, before, atol=1e-9)
    dent = (after - before) / PER_COUNT
    assert dent.min() < -3
    assert abs(staircase[int(np.argmin(dent))] - 0.68) < 0.03
    assert np.abs(dent[-5:]).max() < 0.01


def test_walking_adds_its_share_of_the_stroke_each_full_cycle():
    context, n = EffectContext(*WIRES["one_wire"]), 4
    full = [1.0, 0.0] * n
    added = settled(full, kind("walking")(0.5)) - settled(full)
    np.testing.assert_allclose(added[1::2], 0.005 * context.stroke * np.arange(1, n + 1), rtol=2e-3)


def test_slip_is_a_step_at_its_time():
    added = driven([0.8] * 6, kind("slip")(3.0, at_h=150 / 3600)) - driven([0.8] * 6)
    t = 0.1 * np.arange(1, added.size + 1)
    stroke = EffectContext(*WIRES["one_wire"]).stroke
    np.testing.assert_allclose(added.ravel(), np.where(t > 150 - 0.05, 0.03 * stroke, 0.0), atol=1e-12)


def test_creep_is_the_convolution_with_the_logarithm():
    currents = [0.9, 0.6, 0.85, 0.4]
    y = driven(currents, hold_s=300.0).ravel()
    found = driven(currents, kind("creep")(2.0), hold_s=300.0).ravel() - y
    dy = np.diff(y, prepend=Preisach(WIRES["one_wire"][1]).y)
    t = 0.1 * np.arange(1, y.size + 1)
    at = np.arange(500, y.size, 700)
    exact = np.array([0.02 * np.sum(dy[: k + 1] * np.log10(1 + t[k] - t[: k + 1])) for k in at])
    assert np.sqrt(np.mean((found[at] - exact) ** 2)) < 0.06 * np.sqrt(np.mean(exact**2))


def test_settling_comes_late_by_its_share_and_its_time():
    """Far above the transformation nothing moves; within it a hold drifts like the second mass."""
    f, tau_s = 0.04, 300.0
    y = driven([0.7], kind("settling")(100 * f, time_constant_s=tau_s), hold_s=1500.0)[0]
    t = 0.1 * np.arange(1, y.size + 1)
    source = WIRES["one_wire"][0].input_for(0.7)
    wire = source * (1 - np.exp(-t / WIRES["one_wire"][0].tau_s))
    input_with_feedback = (1 - f) * wire + f * source * (1 - np.exp(-t / tau_s))
    np.testing.assert_allclose(y, Preisach(WIRES["one_wire"][1]).simulate(input_with_feedback), atol=1e-9)


def test_stress_and_resistance_are_solved_within_the_tick():
    """A steady state meets its own feedback: y = Γ[T(y)]."""
    context = EffectContext(*WIRES["one_wire"])
    wire, low, stroke = context.actuator, context.y_lower, context.stroke
    for name, input_with_feedback in {
        "stress_coupling": lambda T, m: T - 8.0 * m,
        "resistance_phase": lambda T, m: T * (1 - 0.1 * (m - 0.5)),
    }.items():
        y = settled([0.62], kind(name)(), hold_s=200.0)[0]
        T = input_with_feedback(wire.input_for(0.62), (y - low) / stroke)
        assert y == pytest.approx(Preisach(context.hysteresis).simulate([T])[0], abs=1e-6)


@pytest.mark.long("takes a second")
def test_falling_resistance_widens_the_top_of_the_loop_and_narrows_its_bottom():
    """The skew of thesis §5.4.1: R_M > R_A under an average R."""
    currents = np.sqrt(np.linspace(0.0, 1.0, 60))
    scan = [*currents, *currents[::-1]]

    def width(level, *effects):
        y = settled(scan, *effects)
        share = (y - y.min()) / np.ptp(y)
        up, down = share[:60], share[60:][::-1]
        return np.interp(level, up, currents**2) - np.interp(level, down, currents**2)

    fall = kind("resistance_phase")(-20.0)
    assert width(0.9, fall) > 1.03 * width(0.9)
    assert width(0.15, fall) < 0.97 * width(0.15)


def test_convection_keeps_steady_temperatures_of_its_law():
    n, wire = 0.2, WIRES["one_wire"][0]
    y = settled([0.5, 0.7, 0.9], kind("convection")(n), hold_s=120.0)
    reference = wire.file.heating.reference_temperature.value
    lost = np.array([wire.input_for(i) for i in (0.5, 0.7, 0.9)])
    input_with_feedback = reference * (lost / reference) ** (1 / (1 + n))
    np.testing.assert_allclose(y, Preisach(WIRES["one_wire"][1]).simulate(input_with_feedback), atol=1e-6)


def test_convection_cools_by_its_differential_equation():
    from scipy.integrate import solve_ivp

    n, wire = 0.3, WIRES["one_wire"][0]
    reference = wire.file.heating.reference_temperature.value
    y = driven([0.9, 0.4], kind("convection")(n), hold_s=60.0)[1]
    source = wire.input_for(0.4)

    def rate(_, u):
        return (source - u * (u / reference) ** n) / wire.tau_s

    start = reference * (wire.input_for(0.9) / reference) ** (1 / (1 + n))
    t = 0.1 * np.arange(1, y.size + 1)
    exact = solve_ivp(rate, (0, 60), [start], t_eval=t, rtol=1e-9, atol=1e-9).y[0]
    operator = Preisach(WIRES["one_wire"][1])
    operator.step(start)
    truth = np.array([operator.step(u) for u in exact])
    assert np.abs(y - truth).max() < 0.01 * np.ptp(truth)


@pytest.mark.parametrize("name", ["convection", "cross_talk"])
def test_convection_cools_each_of_two_wires_by_itself(name):
    """The current turns from wire 1 to wire 2 and back: each wire has a heat loss of its own."""
    from scipy.integrate import solve_ivp

    n, (wire, hysteresis, initial) = 0.3, WIRES["two_wire"]
    share = 0.1 if name == "cross_talk" else 0.0
    effects = [kind("convection")(n), *([kind("cross_talk")(10.0, time_constant_s=20.0)] if share else [])]
    reference = wire.file.heating.reference_temperature.value
    currents = [0.95, -0.8, 0.6]
    y = driven(currents, *effects, wire="two_wire", hold_s=15.0)

    def rates(_, T, lost, input_with_feedback):
        loss = T[:2] * (np.maximum(np.abs(T[:2]), 1e-9) / reference) ** n
        return [*(lost - loss) / wire.tau_s, (input_with_feedback - T[2]) / 20.0]

    state, t, inputs = [0.0, 0.0, 0.0], 0.1 * np.arange(1, y.shape[1] + 1), []
    for i in currents:
        lost = np.array([max(wire.input_for(i), 0.0), max(-wire.input_for(i), 0.0)])
        input_with_feedback = float(np.sign(i)) * reference * (lost.max() / reference) ** (1 / (1 + n))
        T = solve_ivp(
            rates, (0, 15.0), state, args=(lost, input_with_feedback), t_eval=t, rtol=1e-9, atol=1e-9
        ).y
        state = T[:, -1]
        inputs.append(T[0] - T[1] - share * T[2])
    operator = Preisach(hysteresis, initial)
    truth = np.array([operator.step(u) for u in np.concatenate(inputs)])
    assert np.abs(y.ravel() - truth).max() < 0.01 * np.ptp(truth)


def _grains(n):
    """The surface's relays in so many grains of equal mass and a width of their own."""
    rng = np.random.default_rng(5)
    middle, half = rng.normal(80.0, 8.0, n), rng.uniform(8.0, 12.0, n)
    return RelayMeasure.from_arrays(middle + half, middle - half, np.full(n, 6.0 / n))


@pytest.mark.parametrize("dt_s", [0.02, 0.1])
@pytest.mark.parametrize(("grains", "within"), [(0, 0.02), (600, 0.02), (60, 0.05)])
def test_latent_heat_takes_its_joules(dt_s, grains, within):
    """Energy over heating and cooling: power − loss = c ΔT + L Δξ, whatever the path and the grains.

    A coarse grain takes half a kelvin at once, which the wire does not show: it halts until all is paid.
    """
    wire, surface, initial = WIRES["one_wire"]
    plant = Plant(wire, _grains(grains) if grains else surface, initial, dt_s, [kind("latent_heat")(20.0)])
    latent_K, now = 1000 * 20.0 / wire.file.wire.specific_heat.value, plant.now
    for i in (0.8, 0.3):
        begin_K, begin, stored_K = now.input_K, plant.share, 0.0
        for _ in range(round(60.0 / dt_s)):
            before = now.input_K
            plant.step(i)
            stored_K += (now.source_K - (before + now.input_K) / 2) * dt_s / wire.tau_s
        taken_K = latent_K * (plant.share - begin)
        assert abs(taken_K) > 10
        assert stored_K == pytest.approx(now.input_K - begin_K + taken_K, abs=within * abs(taken_K))


def _growing(hold_s):
    """Ends of ticks that grow from 0.1 to 5 s, as the critic's do."""
    t, step = [0.1], 0.1
    while t[-1] < hold_s:
        step = min(1.25 * step, 5.0)
        t.append(min(t[-1] + step, hold_s))
    return np.array(t)


@pytest.mark.parametrize(
    ("grains", "short", "growing"), [(0, 0.005, 0.16), (600, 0.02, 0.16), (60, 0.06, 0.25)]
)
def test_latent_heat_does_not_mind_how_long_a_tick_is(grains, short, growing):
    """Relays switch one by one: in a short tick none or one does, in a long one many."""

    def told(t, *effects):
        """Positions at the ends of ticks (s), computed both ways."""
        plant = Plant(*WIRES["one_wire"], 0.1, effects)
        if grains:
            plant = Plant(WIRES["one_wire"][0], _grains(grains), "negative", 0.1, effects)
        return np.array([[plant.advance(i, dt) for dt in np.diff(t, prepend=0.0)] for i in (0.75, 0.4)])

    def apart(t, *effects):
        """Root mean square between these ticks and ones of 10 ms."""
        fine = 0.01 * np.arange(1, 6001)
        at = np.searchsorted(fine, t - 1e-6)
        return np.sqrt(np.mean((told(t, *effects) - told(fine, *effects)[:, at]) ** 2))

    latent = kind("latent_heat")(20.0)
    even = 0.1 * np.arange(1, 601)
    size = np.sqrt(np.mean((told(even, latent) - told(even)) ** 2))
    assert apart(even, latent) < short * size
    assert apart(_growing(60.0), latent) < growing * size


def test_latent_heat_is_none_where_friction_holds_the_wire():
    """The wire cools within the play: the hysteresis input is constant, so there is no transformation and no
    latent heat."""
    wire = WIRES["one_wire"][0]
    effects = [kind("latent_heat")(40.0), kind("coulomb_friction")(8.0)]
    plant = Plant(*WIRES["one_wire"], 0.1, effects)
    for _ in range(1500):
        plant.step(0.75)
    top_K, source_K = plant.now.input_K, wire.input_for(0.75) - 14.0
    T = []
    for _ in range(400):
        plant.step(wire.current_for(source_K))
        T.append(plant.now.input_K)
    t = 0.1 * np.arange(1, 401)
    bare = source_K + (top_K - source_K) * np.exp(-t / wire.tau_s)
    assert np.abs(np.array(T) - bare).max() < 0.02 * 14.0


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("rig", ["one_wire", "two_wire"])
@pytest.mark.parametrize("name", ["slack", "noncongruency", "eccentricity", "r_phase"])
def test_creep_has_no_part_in_where_the_output_begins(rig, name):
    """What maps the output was there before: a wire that never moved does not creep."""
    wire, hysteresis, _ = WIRES[rig]
    initial = "anhysteretic" if rig == "two_wire" else "negative"
    plants = [
        Plant(wire, hysteresis, initial, 0.1, e) for e in ([kind(name)()], [kind(name)(), kind("creep")(5.0)])
    ]
    for _ in range(600):
        mapped, crept = (plant.step(0.0) for plant in plants)
        assert crept == pytest.approx(mapped, abs=1e-12)


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_plant_stands_at_first_where_it_stays_without_current(name):
    """An encoder zeroed before the first tick does not see the maps of the output as a move."""
    for rig in {"two_wire", wire_of(name)}:
        wire, hysteresis, _ = WIRES[rig]
        initial = "anhysteretic" if rig == "two_wire" else "negative"
        plant = Plant(wire, hysteresis, initial, 0.1, [kind(name)()])
        begin = plant.position
        assert plant.step(0.0) == pytest.approx(
            begin, abs=1e-3 * EffectContext(wire, hysteresis, initial).stroke
        )


def test_backlash_swallows_its_play_after_each_reversal():
    stroke = EffectContext(*WIRES["one_wire"]).stroke
    currents = [0.9, 0.3, 0.8, 0.4]
    x, y = settled(currents), settled(currents, kind("backlash")(4.0))
    np.testing.assert_allclose(np.abs(np.diff(x)) - np.abs(np.diff(y)), 0.04 * stroke, rtol=1e-9)


def test_slack_is_a_floor_under_which_the_wire_goes_on():
    context = EffectContext(*WIRES["one_wire"])
    x, y = settled([0.9, 0.2, 0.6, 0.1]), settled([0.9, 0.2, 0.6, 0.1], kind("slack")(10.0))
    floor = context.y_lower + 0.1 * context.stroke
    assert x.min() < floor
    np.testing.assert_array_equal(y, np.maximum(x, floor))


def test_eccentricity_is_a_wave_over_the_position():
    x, y = settled([0.9, 0.6, 0.5, 0.3]), settled([0.9, 0.6, 0.5, 0.3], kind("eccentricity")(5.0, phase=0.1))
    turn = x / 15.0 + 0.2 * np.pi  # the thesis's pulley has a radius of 15 mm
    np.testing.assert_allclose(y - x, 0.05 * 15.0 * (np.sin(turn) - np.sin(0.2 * np.pi)), atol=1e-12)


def test_sensor_lag_is_first_order_after_its_dead_time():
    x = driven([0.8], hold_s=30.0)[0]
    late = driven([0.8], kind("sensor_lag")(2.0, dead_time_s=1.0), hold_s=30.0)[0]
    seen = np.concatenate([np.full(10, x[0]), x[:-10]])
    fine = np.interp(np.arange(0.5, 100 * seen.size) / 100, np.arange(seen.size + 1), [x[0], *seen])
    expected, value = [], x[0]
    for v in fine:  # a straight line from tick to tick, in steps of 1 ms
        value = v + (value - v) * np.exp(-0.001 / 2.0)
        expected.append(value)
    np.testing.assert_allclose(late, expected[99::100], atol=1e-6)


def test_cross_talk_needs_two_wires_and_comes_late():
    wire = WIRES["two_wire"][0]
    y = driven([0.8], kind("cross_talk")(10.0, time_constant_s=60.0), wire="two_wire", hold_s=400.0)[0]
    t = 0.1 * np.arange(1, y.size + 1)
    T = wire.input_for(0.8)
    input_with_feedback = T * (1 - np.exp(-t / wire.tau_s)) - 0.1 * T * (1 - np.exp(-t / 60.0))
    np.testing.assert_allclose(y, Preisach(WIRES["two_wire"][1]).simulate(input_with_feedback), atol=1e-9)


@pytest.mark.parametrize("name", ["amplifier_gain", "dead_zone", "saturation"])
def test_the_measured_current_shows_what_the_amplifier_did(name):
    from smarig.rig.twin import Twin

    twin = Twin.named("one_wire_twin", noise=False, effects=[kind(name)()])
    shown = [twin.step(i)[0] for i in (0.0, 0.3, 0.9)]
    expected = {
        "amplifier_gain": [0.0, 0.309, 0.927],
        "dead_zone": [0.0, 0.25, 0.85],
        "saturation": [0.0, 0.3, 0.8],
    }[name]
    assert [s.current_A for s in shown] == pytest.approx(expected, abs=1e-9)
    assert [s.current_command_A for s in shown] == [0.0, 0.3, 0.9]


def test_the_voltage_shows_the_resistance():
    from smarig.rig.twin import Twin

    shown = []
    for effects in ([], [kind("resistance_phase")(-20.0)]):
        twin = Twin.named("one_wire_twin", noise=False, effects=effects)
        samples = [twin.step(0.9)[0] for _ in range(900)]
        shown.append((samples[0].voltage_V / 0.9, samples[-1].voltage_V / 0.9))
    (cold, hot), (cold_with, hot_with) = shown
    assert cold_with / cold == pytest.approx(1.1, abs=2e-3)
    assert hot_with / hot == pytest.approx(0.91, abs=2e-2)


def test_a_drifting_room_shows_on_the_rooms_thermometer():
    from smarig.rig.twin import Twin

    twin = Twin.named("one_wire_twin", noise=False, effects=[kind("ambient_drift")(2.0, period_h=0.1)])
    room = [twin.step(0.0)[0].ambient_degC for _ in range(900)]
    assert room[-1] - 22.0 == pytest.approx(2.0, abs=1e-6)
