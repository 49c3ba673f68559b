"""The wire's constants: intervals cover known values as stated; undetermined constants give a reason."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from smarig.core.errors import UsageError
from smarig.identification.calibration.calibrate import Calibration, calibrate
from smarig.identification.interval_estimate import Estimate, linear_fit, variance_inflation
from smarig.plant.actuator import Actuator
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import Run, load_run
from smarig.record.schema import SAMPLE_COLUMNS
from smarig.runner.session import Session

DATA = Path(__file__).resolve().parents[2] / ".." / "shared" / "data"
NAMES = {"R_M", "R_A", "R_over_hA", "hA", "tau", "dead_time"}


def run_of(name: str = "test.run.sqlite", meta=None, **columns) -> Run:
    n = len(next(iter(columns.values())))
    filled = {key: np.full(n, np.nan) for key in SAMPLE_COLUMNS}
    filled |= {"tick": np.arange(n, dtype=float), "quality": np.zeros(n)}
    filled |= {key: np.asarray(value, dtype=float) for key, value in columns.items()}
    return Run(Path(name), meta or {}, filled, (), ())


PWM = {"input": {"quantity": "PWM duty", "unit": "%"}}


def heated(seed: int, tau_s: float, dead_s: float, length_s: float, noise: float = 0.15) -> Run:
    """Irregularly polled, quantised readings (0.25 °C, every 0.22 s) around one step of PWM at 10 s."""
    random = np.random.default_rng(seed)
    t = np.sort(np.round(random.uniform(0, 10 + length_s, 1500), 2))  # many time stamps are repeated
    conversion = np.floor(t / 0.22).astype(int)
    clock = conversion * 0.22
    rise = 1 - np.exp(-np.maximum(clock - 10 - dead_s, 0) / tau_s)
    readings = (
        25 + random.uniform(0, 0.25) + 9 * rise + random.normal(0, noise, conversion.max() + 1)[conversion]
    )
    return run_of(meta=PWM, t_s=t, temperature_degC=np.round(readings / 0.25) * 0.25, input=10.0 * (t > 10))


def estimate(found: Calibration, name: str) -> Estimate:
    assert name in found.parameters, found.not_available.get(name)
    return found.parameters[name]


def covers(e: Estimate, truth: float) -> bool:
    return e.ci95[0] <= truth <= e.ci95[1]


def antagonists(seed: int, points=(-1, 1, -0.6, 0.8, -1, 0.5, 1, -0.8, 1, -1), hold_s: float = 45.0) -> Run:
    """Voltages of two wires whose phases follow a cosine law of their own temperatures: no Preisach operator."""
    rng, dt_s, tau_s, gain = np.random.default_rng(seed), 0.1, rng_tau(seed), 185.0
    start_K, width_K = rng_law(seed)
    i = np.repeat(points, round(hold_s / dt_s)).astype(float)
    T, xi, ohms, position = np.zeros(2), np.zeros(2), [], []
    for current in i:
        steady = gain * current**2 * np.array([current > 0, current < 0])
        T = steady + (T - steady) * math.exp(-dt_s / tau_s)
        heating = (1 - np.cos(np.pi * np.clip((T - start_K) / width_K, 0, 1))) / 2
        cooling = (1 - np.cos(np.pi * np.clip((T - start_K + 20) / width_K, 0, 1))) / 2
        xi = np.minimum(np.maximum(xi, heating), np.maximum(cooling, heating))
        ohms.append(2.105 - 0.21 * xi[1 if current < 0 else 0])
        position.append(17 * (xi[0] - xi[1]) + 0.05 * T[0])
    t = dt_s * np.arange(1, i.size + 1)
    flowed = i + 5e-4 * rng.standard_normal(i.size)
    return run_of(
        t_s=t,
        current_command_A=i,
        current_A=flowed,
        voltage_V=i * np.array(ohms) + 2e-3 * rng.standard_normal(i.size),
        position=np.array(position),
    )


def rng_tau(seed: int) -> float:
    return float(np.random.default_rng(seed + 100).uniform(3.0, 8.0))


def rng_law(seed: int) -> tuple[float, float]:
    """Start of the transformation and its width, kelvin above ambient."""
    rng = np.random.default_rng(seed + 200)
    return float(rng.uniform(25.0, 45.0)), float(rng.uniform(25.0, 60.0))


# --- intervals that know their residuals ------------------------------------------------------------------


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8])
def test_correlated_residuals_count_for_less(rho):
    random = np.random.default_rng(5)
    x = np.zeros(20_000)
    for k, kick in enumerate(random.normal(size=x.size)):
        x[k] = rho * x[k - 1] + kick
    assert variance_inflation(np.split(x, 4)) == pytest.approx((1 + rho) / (1 - rho), rel=0.15)


def test_an_interval_around_a_mean_holds_for_correlated_noise():
    inside = 0
    for seed in range(200):
        x = np.convolve(np.random.default_rng(seed).normal(size=219), np.ones(20), "valid")
        fit = linear_fit([(np.ones((200, 1)), x)])
        assert fit is not None
        inside += abs(fit.x[0]) <= fit.half[0]
    assert 0.85 <= inside / 200 <= 1.0


# --- τ ------------------------------------------------------------------------------------------------------


@pytest.mark.long(
    "takes two seconds",
    cases=(
        "20.0-3.0-45.0",
        "24.0-4.8-41.5",
        "5.3-0.0-30.0",
    ),
)
@pytest.mark.parametrize(
    ("tau_s", "dead_s", "length_s"), [(5.3, 0.0, 30.0), (20.0, 3.0, 45.0), (24.0, 4.8, 41.5)]
)
def test_a_known_time_constant_lies_in_its_interval(tau_s, dead_s, length_s):
    found = [calibrate([heated(seed, tau_s, dead_s, length_s)]) for seed in range(20)]
    taus = [estimate(f, "tau") for f in found]
    assert 0.85 <= np.mean([covers(e, tau_s) for e in taus]) <= 1.0
    assert all((e.ci95[1] - e.ci95[0]) / 2 < 0.15 * tau_s for e in taus)
    dead = [f.parameters["dead_time"] for f in found if "dead_time" in f.parameters]
    if dead_s:
        assert len(dead) == 20
        assert np.mean([covers(e, dead_s) for e in dead]) >= 0.85
    else:
        assert len(dead) <= 2
        assert any(f.not_available.get("dead_time") == "The transients show no dead time." for f in found)


def test_steps_of_several_runs_share_one_time_constant():
    one, six = ([heated(seed, 5.3, 0.0, 20.0) for seed in range(k)] for k in (1, 6))
    narrow, wide = estimate(calibrate(six), "tau"), estimate(calibrate(one), "tau")
    assert covers(narrow, 5.3)
    assert narrow.ci95[1] - narrow.ci95[0] < 0.7 * (wide.ci95[1] - wide.ci95[0])


def test_a_hold_too_short_for_its_time_constant_is_reported():
    found = calibrate([heated(0, 60.0, 0.0, 6.0)])
    assert "Hold the step longer" in found.not_available["tau"]


def test_a_ramp_has_no_step():
    t = np.linspace(0, 60, 600)
    found = calibrate([run_of(meta=PWM, t_s=t, temperature_degC=20 + t, input=t)])
    assert "never follows a step of the drive" in found.not_available["tau"]


def measured(folder: str, name: str, **kwargs) -> np.ndarray:
    path = DATA / folder / name
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    return np.genfromtxt(path, delimiter=",", skip_header=1, encoding="utf-8-sig", **kwargs)


def test_measured_heating_step():
    t, temperature, pwm = measured("sma_heating_step", "step.csv").T
    found = calibrate([run_of(meta=PWM, t_s=t, temperature_degC=temperature, input=pwm)])
    tau, dead = estimate(found, "tau"), estimate(found, "dead_time")
    # Read off the plot: nothing for 4 s, then 63 % of the way to about 38 °C some 25 s later.
    assert 20 < tau.ci95[0] < tau.value < tau.ci95[1] < 30
    assert 3 < dead.value < 6
    assert "PWM duty" in tau.source
    assert set(found.not_available) == {"R_M", "R_A", "R_over_hA", "hA"}
    assert (
        "no run with a measured wire temperature has a measured current" in found.not_available["R_over_hA"]
    )


# --- resistances and heat loss ----------------------------------------------------------------------------------


def staircase() -> Run:
    rows = measured("sma_staircase", "test.csv")
    names = ("current_A", "voltage_V", "position", "temperature_degC")
    return run_of(**{n: np.concatenate([rows[:, k], rows[:, k + 5]]) for k, n in enumerate(names, start=1)})


def test_measured_staircase():
    run = staircase()
    found = calibrate([run])
    i, v = run["current_A"], run["voltage_V"]
    cold, hot = (i > 0.05) & (i < 0.25), i > 0.75
    assert covers(estimate(found, "R_M"), np.mean(v[cold] / i[cold]))
    assert covers(estimate(found, "R_A"), np.mean(v[hot] / i[hot]))
    gain = estimate(found, "R_over_hA")
    clipped = run["temperature_degC"] == run["temperature_degC"].max()
    assert clipped.sum() >= 9
    assert gain.n == 82 - clipped.sum()
    assert 200 < gain.ci95[0] < gain.ci95[1] < 260
    assert "not linear" in gain.source
    mean_ohm = (found.parameters["R_M"].value + found.parameters["R_A"].value) / 2
    assert estimate(found, "hA").value == pytest.approx(mean_ohm / gain.value, rel=0.15)
    assert "cannot be determined" in found.not_available["tau"]


@pytest.mark.long("takes three seconds")
def test_the_twin_s_resistances_and_time_constant(tmp_path):
    wire = Actuator.named("gorbet_one_wire")
    with Session("one_wire_twin", seed=3) as session:
        runs = [
            load_run(session.run("step_currents", {"points": 12}, tmp_path / f"{k}.run.sqlite"))
            for k in (1, 2)
        ]
    without = calibrate(runs, wire)
    assert covers(estimate(without, "R_M"), 5.0)
    assert covers(estimate(without, "R_A"), 4.5)
    assert all(e.ci95[1] - e.ci95[0] < 0.02 for e in without.parameters.values())
    # The ends of the travel are not the extremes of the encoder's noise (that would be 0.002 ohm off).
    assert without.parameters["R_M"].value == pytest.approx(5.0, abs=0.001)
    assert "cannot be determined from position alone without a model" in without.not_available["tau"]
    tau = estimate(calibrate(runs, wire, thesis_surface("one_e")), "tau")
    assert covers(tau, wire.tau_s)
    assert tau.ci95[1] - tau.ci95[0] < 0.1
    # The encoder's zero is arbitrary.
    moved = [replace(r, columns={**r.columns, "position": r["position"] + 3.0}) for r in runs]
    assert estimate(calibrate(moved, wire, thesis_surface("one_e")), "tau").value == pytest.approx(
        tau.value, rel=1e-3
    )
    # A model that fits worse is less sure, and still right.
    rough = estimate(calibrate(runs, wire, thesis_surface("one_c")), "tau")
    assert covers(rough, wire.tau_s)
    assert rough.ci95[1] - rough.ci95[0] > tau.ci95[1] - tau.ci95[0]


@pytest.mark.long("takes three seconds")
def test_cold_antagonists_are_martensite_whatever_the_law_of_their_phases():
    """By the position, the phase of both cold wires would be a half, and R_M 0.13 ohm too large."""
    covered = {"R_M": 0, "R_A": 0}
    for seed in range(20):
        found = calibrate([antagonists(seed)])
        for name, truth in (("R_M", 2.105), ("R_A", 1.895)):
            e = estimate(found, name)
            covered[name] += covers(e, truth)
            assert e.value == pytest.approx(truth, abs=0.01)
            assert e.ci95[1] - e.ci95[0] < 0.05
    assert min(covered.values()) >= 19


def test_antagonists_that_are_never_heated_from_cold_have_no_martensite_resistance():
    t = 0.1 * np.arange(1, 3001)
    i = 0.7 + 0.3 * np.sin(0.5 * t)
    i[1500:] *= -1
    i[:20] = np.linspace(0.0, 0.7, 20)
    found = calibrate([run_of(t_s=t, current_A=i, voltage_V=2.0 * i, position=np.sin(t))])
    assert "R_A" in found.parameters
    slow = run_of(
        t_s=t, current_A=np.where(t < 150, 1, -1) * 1.0, voltage_V=np.full(3000, np.nan), position=np.sin(t)
    )
    assert "voltage" in calibrate([slow]).not_available["R_M"]


@pytest.mark.long("takes two seconds")
def test_the_differential_twin(tmp_path):
    wire = Actuator.named("gorbet_two_wire")
    with Session("two_wire_twin", seed=1) as session:
        run = load_run(session.run("step_currents", {"points": 8}, tmp_path / "a.run.sqlite"))
    found = calibrate([run], wire, thesis_surface("two_e"))
    assert covers(estimate(found, "R_M"), wire.file.heating.resistance_martensite.value)
    assert covers(estimate(found, "R_A"), wire.file.heating.resistance_austenite.value)
    assert covers(estimate(found, "tau"), wire.tau_s)


def steady(seed: int, ambient: bool) -> Run:
    random = np.random.default_rng(seed)
    i = np.concatenate([np.linspace(0, 1, 21), np.linspace(1, 0, 21)])
    v = 4.75 * i + random.normal(0, 0.002, 42)
    t = 22 + 174.1 * i**2 + random.normal(0, 1.0, 42)
    known = {"ambient_degC": np.full(42, 22.0)} if ambient else {}
    return run_of(current_A=i, voltage_V=v, temperature_degC=t, **known)


@pytest.mark.parametrize("ambient", [True, False])
def test_known_heat_loss_lies_in_its_interval(ambient):
    found = [calibrate([steady(seed, ambient)]) for seed in range(20)]
    assert np.mean([covers(estimate(f, "R_over_hA"), 174.1) for f in found]) >= 0.85
    assert np.mean([covers(estimate(f, "hA"), 4.75 / 174.1) for f in found]) >= 0.85
    assert all(e.ci95[1] - e.ci95[0] < 0.1 * e.value for f in found for e in f.parameters.values())


def test_holds_with_a_clock_give_the_steady_temperature():
    t = np.arange(0, 600, 0.1)
    i = np.array([0.0, 0.3, 0.6, 0.9, 0.7, 0.4])[(t // 100).astype(int)]
    temperature = np.empty_like(t)
    now = 0.0
    for k, current in enumerate(i):
        now += (174.1 * current**2 - now) * (1 - math.exp(-0.1 / 5.3))
        temperature[k] = 22 + now
    temperature += np.random.default_rng(1).normal(0, 0.2, t.size)
    found = calibrate(
        [run_of(t_s=t, current_A=i, temperature_degC=temperature, ambient_degC=np.full(t.size, 22.0))]
    )
    assert estimate(found, "R_over_hA").value == pytest.approx(174.1, rel=0.002)
    assert covers(estimate(found, "R_over_hA"), 174.1)
    assert covers(estimate(found, "tau"), 5.3)
    assert "no run with steady temperatures has a measured voltage" in found.not_available["hA"]


# --- sentences, files ------------------------------------------------------------------------------------------------


def test_absent_channels_give_sentences():
    t = np.arange(100.0)
    found = calibrate([run_of(t_s=t, current_A=(t > 10) * 1.0, position=t)])
    assert found.parameters == {}
    assert set(found.not_available) == NAMES
    assert all(text.endswith(".") and len(text) > 40 for text in found.not_available.values())
    assert found.to_json() == {"parameters": {}, "not_available": found.not_available}
    resting = calibrate([run_of(current_A=t, voltage_V=t, position=np.zeros(100))])
    assert "the phase is not known" in resting.not_available["R_M"]
    both = calibrate([run_of(current_A=np.linspace(-1, 1, 50), temperature_degC=np.linspace(20, 30, 50))])
    assert "currents of both signs" in both.not_available["R_over_hA"]
    with pytest.raises(UsageError, match="No run"):
        calibrate([])


def test_what_was_found_goes_into_an_actuator_file(tmp_path):
    base = Actuator.named("gorbet_one_wire")
    values = {"R_M": (3.5, "ohm"), "R_A": (2.8, "ohm"), "R_over_hA": (230.0, "K/A^2"), "tau": (8.0, "s")}
    found = Calibration(
        {n: Estimate(v, (0.9 * v, 1.1 * v), u, 'run "a"', 9) for n, (v, u) in values.items()}, {}
    )
    path = found.write_actuator(tmp_path / "my_wire.toml", base)
    wire = Actuator.named(str(path))
    assert wire.name == "my_wire"
    assert (wire.resistance_at_ohm(0), wire.resistance_at_ohm(1)) == (3.5, 2.8)
    assert wire.gain_K_per_A2 == pytest.approx(230.0, rel=1e-5)
    assert wire.tau_s == pytest.approx(8.0, rel=1e-5)
    assert "95 %: 3.15 to 3.85" in wire.file.heating.resistance_martensite.source
    assert wire.file.transmission == base.file.transmission
    assert 'run "a"' in wire.file.wire.specific_heat.source
    with pytest.raises(UsageError, match="exists"):
        found.write_actuator(path, base)
    found.write_actuator(path, base, force=True)
    with pytest.raises(UsageError, match="--actuator"):
        found.write_actuator(tmp_path / "b.toml", None)
    with pytest.raises(UsageError, match=r"ends in \.toml"):
        found.write_actuator(tmp_path / "b.txt", base)
    with pytest.raises(UsageError, match="The data determine no constant"):
        Calibration({}, {}).write_actuator(tmp_path / "b.toml", base)


@pytest.mark.long("takes three seconds")
def test_runs_of_one_session_share_their_ends(tmp_path):
    """A run that stops short of saturation uses the ends of the other run."""
    with Session("one_wire_twin", seed=2, wire=str(tmp_path)) as session:
        settings = {"partition_K": "0,40,80,174.1"}
        fod = session.run("first_order_descending", settings, tmp_path / "fod.run.sqlite")
        settings = {"temperatures_K": "0,40,80,90,80,90,80,90,80,90,80,90,80,90,80,90,0"}
        short = session.run("step_currents", settings, tmp_path / "short.run.sqlite")
    alone = calibrate([load_run(short)]).parameters["R_A"]
    together = calibrate([load_run(fod), load_run(short)]).parameters["R_A"]
    assert alone.value > 4.515, "its own travel does not end in pure austenite"
    assert abs(together.value - 4.5) < 0.005
