"""Causes that the comparison of measured records names, on wires that share no code with it."""

import numpy as np
import pytest

from benchmarks.boxes.relay_worlds import TRUTHS, relay_world
from diagnosis.comparison.few_readings import ASIDE, ROWS, WIRE, drive
from diagnosis.measured.independent_wire import as_run, lagged, triangles
from smarig.diagnosis import diagnose
from smarig.diagnosis.comparison.measured.measured_comparison import compare_measured
from smarig.diagnosis.comparison.weights_json import causes_json, hypotheses_json
from smarig.identification import identify
from smarig.measurement import CONTINUES_AT

pytestmark = pytest.mark.usefixtures("few_readings")


def test_a_thermometer_that_lags_is_named_though_the_output_leads():
    u = drive()
    function = 4 / (
        1 + np.exp((u - 55) / 4)
    )  # without hysteresis the lag alone makes loops, the wrong way round
    for y in (WIRE.strain(u), function):
        found = compare_measured([as_run("a", lagged(u, 5.0, 1.0), y, dt=1.0)], without=ASIDE)
        assert found.verdict.names == ("input_lag",)
        value, low, high = found.parameters["input_lag"]["lag_s"]
        assert low <= value <= high
        assert value == pytest.approx(5.0, rel=0.3)


@pytest.mark.long("takes three seconds")
def test_a_drift_goes_on_in_the_held_out_part():
    u = drive()
    t = np.arange(u.size, dtype=float)
    run = as_run("a", u, WIRE.strain(u) + 0.6 * t / t[-1], dt=1.0)
    cut = int(0.6 * u.size)
    parts = [
        as_run(n, u[s], run["position"][s], dt=1.0) for n, s in (("a", slice(cut)), ("b", slice(cut, None)))
    ]
    whole = compare_measured([run], without=ASIDE)
    assert whole.verdict.names == ("output_drift",)
    continued = _compared_as_one(parts)
    assert continued.verdict.names == ("output_drift",)
    assert continued.held_out[continued.weights.heaviest.name] < 0.5 * continued.held_out["nothing"]


def _excursions(seed, count, rates, peaks, valleys):
    """(t, u, rate): every second from 25 °C to random peaks and back to valleys, each branch at a rate of its own."""
    rng = np.random.default_rng(seed)
    tops = [92.0, *rng.uniform(*peaks, count - 1)]
    ends = np.array([25.0, *np.ravel([(top, rng.uniform(*valleys)) for top in tops])])
    of_branch = np.exp(rng.uniform(*np.log(rates), ends.size - 1))
    at = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(ends)) / of_branch)])
    t = np.arange(0.0, at[-1])
    return (
        t,
        np.interp(t, at, ends),
        of_branch[np.clip(np.searchsorted(at, t, "right") - 1, 0, ends.size - 2)],
    )


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("seed", [2, 5])
def test_a_ratcheting_that_does_not_slow_down_is_named_by_the_travel_of_its_cycles(seed):
    """A cycle leaves behind a share of what the strain has travelled; counted, minor loops would leave as much."""
    _, u, _ = _excursions(seed, 18, (0.3, 5.0), peaks=(55.0, 92.0), valleys=(25.0, 52.0))
    y = WIRE.strain(u)
    run = as_run("a", u, y + 0.06 * np.cumsum(np.abs(np.diff(y, prepend=y[0]))) / (2 * np.ptp(y)), dt=1.0)
    assert compare_measured([run], without=ASIDE).verdict.names == ("ratcheting",)


@pytest.mark.long("takes ten seconds")
def test_loops_that_narrow_with_the_rate_are_no_lag():
    _, u, rate = _excursions(4, 14, (0.4, 3.0), peaks=(62.0, 92.0), valleys=(25.0, 42.0))
    middle, half = (WIRE.up + WIRE.down) / 2, (WIRE.up - WIRE.down) / 2
    hot, y = np.zeros(half.size, dtype=bool), []
    for x, width in zip(u, 1 - 0.7 * np.log10(rate / 0.4)):
        hot = np.where(x > middle + width * half, True, np.where(x < middle - width * half, False, hot))
        y.append(4.0 * (1 - WIRE.share @ hot))
    run = as_run("a", u, np.array(y), dt=1.0)
    found = diagnose(identify([run]).model, [run], without=("input_drift", "output_jump"))
    assert (found.verdict.word, found.verdict.depends_on) == ("unknown", "rate")


def _compared_as_one(parts):
    """Runs of which the second continues the first."""
    parts[1].meta["initial"] = "continued"
    parts[0].meta["imported"] = {"sha256": "a" * 64}
    parts[1].meta["imported"] = {"sha256": "b" * 64, "continues_sha256": "a" * 64}
    return compare_measured(parts[:1], parts[1:], without=ASIDE)


def _ascending_loads(shift_K, drift_K):
    """Four parts of one record, each at a larger load: the transformation shifts, or the thermometer drifts."""
    u = triangles((90.0, 70.0, 62.0, 90.0), rows=[40, 25, 30, 20])
    runs, hours = [], 4 * u.size / 3600
    for k, stress in enumerate((50.0, 75.0, 100.0, 125.0)):
        t = k * u.size + np.arange(u.size)
        read = u + drift_K * t / 3600 / hours
        run = as_run(f"load {k}", read, WIRE.strain(u - k * shift_K), dt=1.0, stress=stress, seed=k)
        run.columns["t_s"] = t.astype(float)
        run.meta["imported"] = {"sha256": "a" * 64, CONTINUES_AT: {"began_s": 0.0}}
        runs.append(run)
    return runs


@pytest.mark.parametrize(
    ("shift_K", "drift_K", "cause"), [(0.0, 6.0, "input_drift"), (2.0, 0.0, "stress_shift")]
)
def test_a_drift_over_a_record_of_ascending_loads_is_no_effect_of_the_load(shift_K, drift_K, cause):
    """From load to load both look the same; the drift goes on within each load."""
    runs = _ascending_loads(shift_K, drift_K)
    found = compare_measured([*runs[:2], runs[3]], [runs[2]], without=tuple(set(ASIDE) - {"input_drift"}))
    assert found.verdict.names == (cause,)
    assert found.held_out[found.weights.heaviest.name] < 0.3 * found.held_out["nothing"]


def test_an_offset_of_a_held_out_run_is_told_by_its_run():
    u = drive()
    runs = [as_run(n, u + o, WIRE.strain(u), dt=1.0) for n, o in (("a", 0.0), ("b", 6.0))]
    found = compare_measured(runs[:1], runs[1:], without=ASIDE)
    assert found.missing is None
    assert found.between_runs
    assert found.verdict.names == ("input_offset",) or found.verdict.depends_on == "run"


def test_an_offset_is_told_of_runs_at_other_rates_whatever_little_the_first_run_holds():
    """A lag would move both branches apart; a slight drift of the first run says nothing of the other's shift."""
    slow, fast = drive(), drive([max(n // 3, 6) for n in ROWS])
    parts = [("a", slow, 0.0, 3.0), ("b", fast, 5.0, 0.8)]
    runs = [
        as_run(n, u + o + 0.4 * np.arange(u.size) / u.size, WIRE.strain(u), dt=dt, seed=k)
        for k, (n, u, o, dt) in enumerate(parts)
    ]
    found = compare_measured(runs[:1], runs[1:], without=tuple(set(ASIDE) - {"input_drift"}))
    assert found.between_runs
    assert found.verdict.names == ("input_offset",)
    assert found.parameters["input_offset"]["b"][0] == pytest.approx(-5.0, abs=0.6)


@pytest.mark.long("takes two seconds")
def test_json_has_every_hypothesis_with_its_weight():
    world = relay_world("stress", 8)
    found = compare_measured(world.train, world.held_out, without=(*ASIDE, "output_drift", "ratcheting"))
    assert found.verdict.names == ("stress_shift",)
    assert sum(h["weight"] for h in hypotheses_json(found.weights)) == pytest.approx(1.0)
    assert causes_json(found.weights)[0]["name"] == "stress_shift"
    assert found.held_out[found.weights.heaviest.name] < 0.2 * found.held_out["nothing"]


@pytest.mark.parametrize("kind", TRUTHS)
def test_worlds_are_alike_for_a_seed(kind):
    a, b = relay_world(kind, 3), relay_world(kind, 3)
    assert np.array_equal(a.train[0]["position"], b.train[0]["position"])
    assert set(a.names) | set(a.variables) or kind in ("nothing", "memoryless", "second_population")
