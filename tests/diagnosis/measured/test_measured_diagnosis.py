"""Effects hidden in runs with a measured input are found; nothing is named where the catalogue has no cause."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, lagged, triangles
from smarig.core import UsageError
from smarig.diagnosis import MeasuredDiagnosis, diagnose
from smarig.diagnosis.diagnose import _by_input
from smarig.diagnosis.run_checks import check_held_out
from smarig.identification import identify, verify
from smarig.record import Step
from smarig.replay import load_model

long = pytest.mark.long("takes ten seconds")
pytestmark = pytest.mark.usefixtures("few_readings")
PEAKS = (85.0, 62.0, 80.0, 57.0, 85.0, 66.0)
T = triangles(PEAKS)
RATES = triangles(PEAKS, (30, 90, 50, 120, 40, 80)), triangles((85.0, 70.0, 60.0), (60, 30, 90))


@cache
def any_model():
    """A model to compare with; the diagnosis refits everything itself."""
    return identify(as_run("any", T[:300], RelayWire(1).strain(T[:300])), "positive").model


def diagnosed(train, held_out=(), **settings) -> MeasuredDiagnosis:
    found = diagnose(any_model(), train, held_out, **settings)
    assert isinstance(found, MeasuredDiagnosis)
    return found


def parameter(found, name):
    (effect,) = found.effects()
    return effect["parameters"][name]


@pytest.fixture(scope="module", params=[1])
def wire(request):
    return RelayWire(request.param)


def test_it_is_silent_where_nothing_is_hidden(wire):
    found = diagnosed([as_run("plain", T, wire.strain(T), dt=1.0)])
    assert found.verdict.word == "silent"
    assert not found.extended
    assert found.model.measurement == {}
    assert "Nothing stands out" in found.text()


@pytest.mark.long("takes five seconds", cases=("1-0.1", "1-0.4"))
@pytest.mark.parametrize("step", [0.1, 0.4])
def test_a_reading_in_steps_has_at_least_the_noise_of_its_rounding(wire, step):
    run = as_run("steps", T, np.round(wire.strain(T) / step) * step, dt=1.0, noise=(0.05, 0.0))
    rounded = replace(run, meta={**run.meta, "output": {**run.meta["output"], "per_count": step}})
    found = diagnosed([rounded])
    assert found.noise >= step / np.sqrt(12)
    assert found.to_json()["adequacy"]["times_noise"] < 2
    assert not found.effects()


@pytest.fixture(scope="module")
def slow_thermometer():
    """At one rate a lag is a wider loop, which any measure has; so the ramps differ in their rates."""
    wire, dt, lag_s = RelayWire(3), 0.5, 4.0
    runs = [
        as_run(f"lag_{k}", lagged(u, lag_s, dt), wire.strain(u), dt=dt, seed=k) for k, u in enumerate(RATES)
    ]
    return diagnosed(runs[:1], runs[1:]), runs


@pytest.mark.long("takes ten seconds")
def test_a_slow_thermometer_is_named_with_its_time_constant(slow_thermometer):
    found, _ = slow_thermometer
    assert found.verdict.names == ("input_lag",)
    low, high = parameter(found, "lag_s")["ci95"]
    assert low <= 4.0 <= high
    assert parameter(found, "lag_s")["value"] == pytest.approx(4.0, rel=0.2)
    assert found.gain is not None
    assert found.gain.extended < 0.5 * found.gain.base


@pytest.mark.long("takes five seconds", cases=("8.0",))
@pytest.mark.parametrize("lag_rows", [8.0, pytest.param(0.0, marks=long)])
def test_a_slow_thermometer_is_named_without_a_clock_too(lag_rows, tmp_path):
    """Rows that are equally spaced, but nobody wrote down how."""
    wire, (first, second) = RelayWire(3), RATES
    read = [lagged(u, lag_rows, 1.0) if lag_rows else u for u in (first, second)]
    runs = [
        as_run(f"rows_{k}", r, wire.strain(u), seed=k) for k, (r, u) in enumerate(zip(read, (first, second)))
    ]
    found = diagnosed(runs[:1], runs[1:])
    if not lag_rows:
        assert not found.effects()
        return
    assert found.verdict.names == ("input_lag",)
    assert parameter(found, "lag_rows")["value"] == pytest.approx(lag_rows, rel=0.2)
    model = load_model(found.model.save(tmp_path / "lag.model.json"))
    given = verify(identify(runs[:1], "positive").model, runs[1:]).runs[0].settled.nrmse
    assert verify(model, runs[1:]).runs[0].settled.nrmse < 0.5 * given


@pytest.mark.long("takes five seconds", cases=("5-1.0", "5-None"))
@pytest.mark.parametrize("dt", [None, 1.0])
@pytest.mark.parametrize("seed", [5, *(pytest.param(k, marks=long) for k in (1, 2, 3, 4))])
def test_exchanged_columns_are_no_slow_sensor(seed, dt):
    """Their output leads, too: the temperature, given as the output of a strain."""
    wire = RelayWire(seed)
    runs = [
        as_run(f"exchanged_{k}", wire.strain(u), u, dt=dt, noise=(0.004, 0.05), seed=k)
        for k, u in enumerate(RATES)
    ]
    assert "input_lag" not in diagnosed(runs[:1], runs[1:]).verdict.names


@pytest.mark.long("takes three seconds")
def test_the_extended_model_is_saved_and_predicts_as_found(slow_thermometer, tmp_path):
    found, runs = slow_thermometer
    model = load_model(found.model.save(tmp_path / "lag.model.json"))
    given = verify(identify(runs[:1], "positive").model, runs[1:]).runs[0].settled.nrmse
    assert verify(model, runs[1:]).runs[0].settled.nrmse < 0.5 * given


@pytest.fixture(scope="module")
def loads():
    """Runs of one wire under 50, 100, 150, 200 MPa: 8 MPa/K, and a stroke that grows with the load."""
    wire = RelayWire(4)
    u = triangles((110.0, 75.0, 110.0), rows=80)
    return {
        s: as_run(f"load_{s}", u, wire.strain(u, stroke=2.0 + s / 100, rise=s / 8.0), stress=float(s), seed=s)
        for s in (50, 100, 150, 200)
    }


@pytest.mark.long("takes five seconds", cases=("train0-200",))
@pytest.mark.parametrize(
    ("train", "held_out"), [((50, 100, 150), 200), pytest.param((50, 100, 200), 150, marks=long)]
)
def test_a_shift_by_stress_predicts_a_load_between_and_beyond(loads, train, held_out):
    found = diagnosed([loads[s] for s in train], [loads[held_out]])
    assert found.verdict.names == ("stress_shift",)
    assert parameter(found, "MPa_per_K")["value"] == pytest.approx(8.0, rel=0.1)
    nearest = min(train, key=lambda s: abs(s - held_out))
    own = verify(identify([loads[nearest]], "positive").model, loads[held_out]).runs[0].settled.rms
    assert found.gain is not None
    assert found.gain.extended < 0.5 * own
    assert "Each stress was measured in one run only" in found.text()


@pytest.mark.parametrize(
    ("name", "stresses", "expected"),
    [
        ("stress_shift", [50.0, 150.0, 100.0], ("stress",)),
        ("stress_shift", [50.0, 100.0, 50.0], ()),
        ("stress_shift", [50.0], ()),
        ("input_lag", [50.0, 100.0], ()),
    ],
)
def test_a_load_that_was_measured_once_may_go_with_the_day(name, stresses, expected):
    """The zero of a thermometer that rises from day to day shifts the loop as a load does that rises with it."""
    records = [SimpleNamespace(conditions={"stress": s}) for s in stresses]
    found = SimpleNamespace(verdict=SimpleNamespace(names=(name,)), records=records)
    assert MeasuredDiagnosis.measured_once.fget(found) == expected


@pytest.mark.long("takes three seconds")
def test_runs_under_other_loads_are_never_explained_by_an_offset_of_the_thermometer(loads):
    found = diagnosed([loads[50], loads[200]], without=("stress_shift",))
    assert "input_offset" in found.not_testable
    assert found.verdict.word == "unknown"


def test_an_offset_between_training_runs_is_named():
    wire = RelayWire(5)
    runs = [as_run("first", T, wire.strain(T)), as_run("second", T - 3.0, wire.strain(T), seed=1)]
    found = diagnosed(runs)
    assert found.verdict.names == ("input_offset",)
    assert parameter(found, "second")["value"] == pytest.approx(3.0, abs=0.5)


@pytest.mark.long("takes two seconds")
def test_a_held_out_run_whose_thermometer_is_off_is_reported():
    wire = RelayWire(5)
    found = diagnosed(
        [as_run("first", T, wire.strain(T))], [as_run("second", T - 3.0, wire.strain(T), seed=1)]
    )
    (offset,) = found.offsets
    assert offset.run == "second"
    assert offset.interval[0] <= 3.0 <= offset.interval[1]
    assert offset.with_offset < 0.5 * offset.without
    assert found.verdict.names == ("input_offset",)
    assert not found.extended, "no run is left to measure a gain on"
    assert not found.to_json()["adequacy"]["adequate"], "a plain model is not as good as the noise allows"
    assert f"is shifted by {-offset.offset:.3g} [" in found.text()
    assert "the reading of the input, the load or the specimen differs" in found.text()


@pytest.mark.long("takes two seconds")
def test_a_strain_that_each_cycle_leaves_is_named():
    wire = RelayWire(6)
    u = triangles((85.0,) * 20, rows=25)
    cycle = np.arange(u.size) / 48.0
    y = wire.strain(u) + 0.5 * (1 - np.exp(-cycle / 5.0))
    found = diagnosed([as_run("training", u, y)])
    assert found.verdict.names == ("ratcheting",)
    assert parameter(found, "amplitude")["value"] == pytest.approx(0.5, rel=0.2)


def test_a_drift_of_the_output_is_named_with_its_rate():
    """Peaks that differ, so that the count of cycles is not the clock."""
    wire = RelayWire(12)
    u = triangles(
        tuple(60.0 + 30.0 * ((7 * k) % 10) / 10 for k in range(14)),
        tuple(20 + 11 * (k % 4) for k in range(14)),
    )
    hours = 10.0 * np.arange(u.size) / 3600
    found = diagnosed([as_run("drift", u, wire.strain(u) + 0.4 * hours, dt=10.0)])
    assert "output_drift" in found.verdict.names
    tau_h, size = (parameter(found, name)["value"] for name in ("time_constant_h", "amplitude"))
    drifted = size * (1 - np.exp(-hours[-1] / tau_h))
    assert drifted == pytest.approx(0.4 * hours[-1], rel=0.2)


def test_a_clamp_that_slips_once_is_named_with_the_moment_and_the_size():
    wire = RelayWire(13)
    u = triangles(tuple(60.0 + 30.0 * ((7 * k) % 10) / 10 for k in range(12)), rows=30)
    t = 2.0 * np.arange(u.size)
    found = diagnosed([as_run("slip", u, wire.strain(u) + 0.3 * (t > 500.0), dt=2.0)])
    assert found.verdict.names == ("output_jump",)
    assert parameter(found, "slip")["value"] == pytest.approx(500.0 / 3600, abs=0.01 * t[-1] / 3600)
    assert parameter(found, "amplitude")["value"] == pytest.approx(0.3, rel=0.2)


def test_a_table_of_settled_readings_keeps_its_clock():
    """Drifts and jumps of the output are told by it; no current is kept, because its heating is not known."""
    run = as_run("table", np.array([20.0, 60.0, 90.0, 60.0]), np.array([0.0, 1.0, 3.0, 2.0]), dt=60.0)
    steps = tuple(
        Step(k, 0, False, "up", u, t, t, "settled", y, 1) for k, (u, t, y) in enumerate(rows_of(run))
    )
    (found,) = _by_input([replace(run, steps=steps)])
    np.testing.assert_allclose(found["t_s"], run["t_s"])
    np.testing.assert_allclose(found["position"], run["position"])
    assert not found.has("current_A")


def rows_of(run):
    return zip(run["input"].tolist(), run["t_s"].tolist(), run["position"].tolist())


# --- causes that no effect describes ---------------------------------------------------------------------


@long
def test_a_loop_that_widens_with_the_rate_is_unknown_and_depends_on_the_rate():
    """Thresholds that move apart with the rate: no lag of the input, whose time constant would be one for all rates."""
    runs = []
    for k, (dt, wider) in enumerate(((10.0, 0.0), (0.1, 8.0))):
        wire = RelayWire(7)
        wire.up, wire.down = wire.up + wider / 2, wire.down - wider / 2
        runs.append(as_run(f"rate_{k}", T, wire.strain(T), dt=dt, seed=k))
    found = diagnosed(runs)
    assert found.verdict.word == "unknown"
    assert found.verdict.depends_on == "rate"
    assert not found.effects()


@pytest.mark.long("takes five seconds")
def test_a_slope_that_comes_and_goes_is_not_named():
    """A supply that sags: the output is scaled by a slow beat, which is no effect of the catalogue."""
    wire = RelayWire(8)
    u = triangles((85.0,) * 12, rows=30)
    beat = 1 + 0.15 * np.sin(2 * np.pi * np.arange(u.size) / 260.0)
    found = diagnosed([as_run("sag", u, wire.strain(u) * beat, dt=1.0)])
    assert (found.verdict.word, found.verdict.depends_on) == ("unknown", "time")
    assert not found.effects()


def test_rows_of_zeros_are_left_out_and_counted():
    wire = RelayWire(9)
    run = as_run("zeros", T, wire.strain(T))
    run["input"][100:103] = 0.0
    run["input"][300] = 0.0
    found = diagnosed([run])
    assert sum(r.dropouts for r in found.records) == 4
    assert "4 rows in which the input reads exactly 0" in found.text()
    assert found.verdict.word == "silent"


@pytest.mark.long("takes three seconds")
def test_a_copy_of_a_training_run_is_refused_as_held_out(tmp_path):
    wire = RelayWire(1)
    run = as_run("plain", T, wire.strain(T))
    file = tmp_path / "plain.run.sqlite"
    file.write_bytes(b"the same bytes")
    run = replace(run, path=file)
    model = identify(run, "positive").model
    with pytest.raises(UsageError, match="copy of a training run"):
        diagnose(model, run, run)
    with pytest.raises(UsageError, match="cannot be left out"):
        diagnose(model, run, without=("nonsense",))


def test_a_training_run_is_given_once():
    u = triangles((80.0, 60.0, 85.0), rows=30)
    runs = [as_run("a", u, u, dt=1.0) for _ in range(2)]
    with pytest.raises(UsageError, match="count twice"):
        check_held_out(runs, [])
    check_held_out([runs[0], as_run("a", u, u, dt=1.0, seed=1)], [])
