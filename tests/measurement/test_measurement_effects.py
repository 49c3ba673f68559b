"""Measurement effects: each changes a record as its equation says, and is not offered where it cannot be tested."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, lagged, triangles
from smarig.core import DataError
from smarig.measurement import (
    ConditionTable,
    InputRecord,
    MeasurementPart,
    changed,
    full_cycles_before,
    input_records,
    measurement_effect_types,
    measurement_effects,
)

KINDS = {k.name: k for k in measurement_effect_types()}


def record(u, *, dt=0.1, clock=True, conditions=None, name="a", unit="degC"):
    u = np.asarray(u, dtype=float)
    t = dt * np.arange(u.size)
    return InputRecord(
        name, u, u, t, clock, np.linspace(0, 5, u.size), conditions or {}, np.arange(u.size), input_unit=unit
    )


def test_a_lag_is_undone_exactly_on_a_ramp_and_nearly_on_a_wave():
    t = 0.1 * np.arange(2000)
    true = 50 + 20 * np.sin(2 * np.pi * t / 60)
    w, lag_s = 2 * np.pi / 60, 3.0
    # the steady answer of a first-order lag to a sine, in closed form
    read = 50 + 20 / np.hypot(1, w * lag_s) * np.sin(w * t - np.arctan(w * lag_s))
    undone = changed(record(read), [KINDS["input_lag"](lag_s=lag_s)]).input
    assert np.abs(undone - true)[100:-100].max() < 0.1
    ramp = changed(record(2.0 * t), [KINDS["input_lag"](lag_s=lag_s)]).input
    assert np.allclose(ramp, 2.0 * (t + lag_s))


def test_a_drift_slows_down_with_its_time_constant_or_is_steady():
    hours = 0.5 * np.arange(9)
    change = changed(record(np.arange(9.0), dt=1800.0), [KINDS["output_drift"](time_constant_h=2.0)])
    assert np.allclose(change.terms[:, 0], 1 - np.exp(-hours / 2.0))
    steady = changed(record(np.arange(9.0), dt=1800.0), [KINDS["output_drift"](time_constant_h=4000.0)])
    assert np.allclose(steady.terms[:, 0] / steady.terms[-1, 0], hours / hours[-1], atol=1e-3)


def test_a_jump_stays_and_concerns_its_own_run_only():
    jump = KINDS["output_jump"](a=1.0)
    own, other = record(np.arange(9.0), dt=1800.0), record(np.arange(9.0), dt=1800.0, name="b")
    assert changed(own, [jump]).terms[:, 0].tolist() == [0.0] * 2 + [1.0] * 7
    assert not changed(other, [jump]).terms.any()


def test_rows_that_are_missing_do_not_make_a_jump():
    t = 0.1 * np.arange(400)
    kept = np.delete(np.arange(400), [150, 151])
    whole = record(30 + t)
    part = InputRecord("a", whole.u[kept], whole.y[kept], t[kept], True, whole.cycle[kept], {}, kept)
    assert np.allclose(changed(part, [KINDS["input_lag"](lag_s=2.0)]).input, 30 + t[kept] + 2.0)


def test_a_stress_shifts_the_input_by_clausius_and_clapeyron():
    loaded = record([20.0, 80.0, 20.0], conditions={"stress": 150.0})
    shift = KINDS["stress_shift"](MPa_per_K=10.0, reference=50.0)
    assert np.allclose(changed(loaded, [shift]).input, loaded.u - 10.0)


def test_effects_are_not_offered_where_they_cannot_be_tested():
    plain, other = record(np.arange(9.0)), record(np.arange(9.0), name="b")
    loaded = [record(np.arange(9.0), conditions={"stress": s}, name=str(s)) for s in (50.0, 100.0)]
    assert KINDS["input_lag"].parameters([record(np.arange(9.0))]) is None
    assert KINDS["output_drift"].parameters([record(np.arange(9.0), clock=False)]) is None
    assert KINDS["input_offset"].parameters([plain]) is None
    assert KINDS["input_offset"].parameters([plain, other]) is not None
    assert KINDS["input_offset"].parameters(loaded) is None
    assert KINDS["stress_shift"].parameters([plain, other]) is None
    assert KINDS["stress_shift"].parameters(loaded) is not None
    assert KINDS["ratcheting"].parameters([record(np.arange(9.0), unit="A/m")]) is None


def test_a_table_continues_linearly_and_survives_its_file():
    table = ConditionTable.of(
        "stress", [100.0, 50.0, 50.0], np.array([2.0, 1.0, 1.0]), np.array([0.0, 1.0, 3.0])
    )
    shape = np.array([0.0, 2.0])
    assert table.outputs(shape, 75.0).tolist() == [1.0, 4.0]
    assert table.outputs(shape, 150.0).tolist() == [-2.0, 4.0]
    assert ConditionTable.from_json(table.to_json()) == table
    with pytest.raises(DataError, match="damaged"):
        ConditionTable.from_json({"condition": "stress", "values": [1], "gains": [1, 2], "zeros": [0]})
    with pytest.raises(DataError, match="damaged: one of its gains is not a number of plausible size: 1e"):
        ConditionTable.from_json({"condition": "stress", "values": [1], "gains": [1e300], "zeros": [0]})


def test_a_damaged_effect_of_a_model_file_is_refused():
    with pytest.raises(DataError, match="no table of parameters"):
        measurement_effects([{"name": "input_lag"}])


def test_a_model_file_with_too_few_amplitudes_is_refused():
    stored = {"effects": [KINDS["ratcheting"](cycles=5.0).to_json()], "amplitudes": []}
    with pytest.raises(DataError, match="need 1 amplitudes, not 0"):
        MeasurementPart.from_json(stored)
    assert MeasurementPart.from_json(stored | {"amplitudes": [0.1]}).amplitudes == (0.1,)


def test_a_model_file_of_an_earlier_version_may_name_an_effect_as_it_was_called_then():
    stored = {"name": "ratchet_strain", "parameters": {"cycles": 3.0}}
    assert measurement_effects([stored])[0].kind.name == "ratcheting"


def ramps(rates, rows=60):
    """Ramps up and down at these rates, at equal time steps."""
    parts, u = [], 0.0
    for k, rate in enumerate(rates):
        step = rate if k % 2 == 0 else -rate
        parts.append(u + step * np.arange(round(rows / rate)))
        u = parts[-1][-1] + step
    return np.concatenate(parts)


def test_a_lag_is_only_offered_if_the_input_changes_at_several_rates():
    """At one rate a lag shifts each branch, as a wider or narrower loop would."""
    lag = KINDS["input_lag"]
    assert lag.parameters([record(ramps([1.0, 1.0, 1.0, 1.0]))]) is None
    assert lag.parameters([record(ramps([1.0, 2.0, 1.0, 2.0]))]) is not None
    assert lag.parameters([record(ramps([1.0] * 4)), record(ramps([2.0] * 4))]) is not None


def test_without_a_clock_a_lag_is_one_of_rows():
    lag, wire = KINDS["input_lag"], RelayWire(3)
    u = triangles((85.0, 62.0, 80.0, 57.0, 85.0, 66.0), (30, 90, 50, 120, 40, 80))
    honest, read = record(u, clock=False), lagged(u, 8.0, 1.0)
    assert lag.parameters([replace(honest, y=wire.strain(u))]) is None, (
        "rows may be uneven, and nothing leads"
    )
    rows = replace(record(read, clock=False), y=wire.strain(u))
    timed = replace(record(read, dt=0.5), y=wire.strain(u))
    (parameter,) = lag.parameters([rows])
    assert (parameter.name, parameter.unit) == ("lag_rows", "rows")
    assert lag.parameters([timed])[0].name == "lag_s"
    assert lag.parameters([rows, timed]) is None
    undone = changed(rows, [lag(lag_rows=6.0)]).input
    assert np.allclose(undone, changed(timed, [lag(lag_s=3.0)]).input)
    assert np.allclose(undone, changed(timed, [lag(lag_rows=6.0)]).input)


def test_a_drift_of_the_input_is_undone_and_needs_several_cycles():
    drift = KINDS["input_drift"]
    true = record(ramps([1.0, 1.0] * 4), dt=60.0)
    hours = true.t / 3600
    read = record(true.u - 0.5 * hours, dt=60.0)
    assert np.allclose(changed(read, [drift(drift_per_h=0.5)]).input, true.u)
    assert drift.parameters([read]) is not None
    few = InputRecord(
        "a", true.u, true.u, true.t, True, np.linspace(0, 2, true.u.size), {}, np.arange(true.u.size)
    )
    assert drift.parameters([few]) is None


@pytest.mark.parametrize("cut", [30, 45, 61])
def test_full_cycles_go_on_over_a_split(cut):
    """Minor loops count by their size; the part after a cut needs the travel of the part before, and its range."""
    turns = [20.0, 90.0, 50.0, 70.0, 20.0, 60.0]
    u = np.concatenate([*(np.linspace(a, b, 15)[:-1] for a, b in pairwise(turns)), turns[-1:]])
    whole = full_cycles_before(u)[0]
    assert whole[-1] == pytest.approx((70 + 40 + 20 + 50 + 40) / 140)
    first, travel = full_cycles_before(u[: cut + 1])
    rest, _ = full_cycles_before(u[cut:], travel)
    assert [*first, *rest[1:]] == pytest.approx(whole)


@pytest.mark.parametrize(("widest", "starts_at"), [(70.0, 2.5), (float("nan"), 0.0), (-1.0, 0.0)])
def test_a_part_of_a_run_goes_on_from_the_travel_that_it_states(widest, starts_at):
    u = np.linspace(20.0, 55.0, 40)
    run = as_run("part", u, u, noise=(0.0, 0.0))
    run.meta["imported"] = {"continues_at": {"cycles": 3.0, "full_cycles": 2.5, "widest": widest}}
    count = input_records([run])[0].full_cycles
    assert count[0] == starts_at
    assert count[-1] - count[0] == pytest.approx(0.25 if starts_at else 0.5)
