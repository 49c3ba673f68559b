"""Passivity of measured runs: a passive wire keeps its bound within noise, and a wire that returns energy is
detected."""

from dataclasses import replace

import numpy as np
import pytest

from control.model_files import model_of
from smarig.certificate.hysteresis_analysis import HysteresisAnalysis
from smarig.certificate.measured_passivity import (
    SPREADS,
    noise_weight,
    reading_noise,
    segment_passivity,
    trapezoid,
)
from smarig.certificate.passivity import counterexample, passivity
from smarig.core.errors import DataError, UsageError
from smarig.identification.run_passivity import passivity_of_run
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.record import load_run
from smarig.replay.model_file import SignalDescription
from smarig.runner.session import Session

LEVELS = {"partition_K": [0, 40, 90, 130, 170]}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """First-order curves of a one_e twin with its noise, from a cold wire."""
    folder = tmp_path_factory.mktemp("readings")
    with Session("one_wire_twin", seed=1) as session:
        return load_run(session.run("first_order_descending", LEVELS, folder / "f.run.sqlite"))


def with_columns(run, **columns):
    return replace(run, columns=run.columns | columns)


def synthetic(run, u, y, **meta):
    empty = np.full(u.size, np.nan)
    columns = dict.fromkeys(run.columns, empty) | {"tick": np.arange(u.size), "input": u, "position": y}
    return replace(run, columns=columns, meta=run.meta | meta)


@pytest.mark.long("takes three seconds")
def test_a_twin_keeps_the_bound_and_its_model_within_noise(run):
    found = passivity_of_run(run, model_of("one_e"))
    (one,) = found.segments
    exact = passivity(thesis_surface("one_e"), run["input"])
    np.testing.assert_allclose(one.model, exact.supplied, atol=1e-9)
    assert np.ptp(one.model) > 100, "mm·K: energy went in"
    assert (np.abs(one.supplied - one.model) <= SPREADS * one.spread + one.sampling).all()
    assert 0.4 < ((one.supplied - one.model) / np.maximum(one.spread, 1e-9))[100:].std() < 1.6, (
        "nor is it too wide"
    )
    assert (found.within, one.bound, one.proven) == (True, 0.0, True)
    assert one.supplied.min() < 0, "some reading is below zero by noise: that is none"
    assert "does not fall below the bound of 0 mm·K" in found.text
    assert f"at sample {one.worst}" in found.text


@pytest.mark.long
def test_a_loop_that_gives_energy_back_goes_below_whatever_the_noise(run):
    """A two_p wire around its loop with negative area, evaluated with a model that is passive, and with its
    own."""
    broken, count = counterexample(thesis_surface("two_p"), "anhysteretic"), 0.18
    cosine = (1 - np.cos(np.linspace(0, np.pi, 20, endpoint=False))) / 2
    turns = broken.inputs(2000)
    u = np.concatenate([a + (b - a) * cosine for a, b in zip(turns, turns[1:])])
    y = Preisach(thesis_surface("two_p"), "anhysteretic").simulate(u) + np.random.default_rng(1).normal(
        0, 0.06, u.size
    )
    output = {"quantity": "shaft angle", "unit": "deg", "per_count": count}
    wire = synthetic(run, u, np.round(y / count) * count, initial="anhysteretic", output=output)
    early = passivity_of_run(
        with_columns(wire, position=np.where(np.arange(u.size) < 900 * 40, wire["position"], np.nan)),
        model_of("two_e"),
    )
    found = passivity_of_run(wire, model_of("two_e"))
    assert early.within is True
    assert found.within is False
    assert "falls below the bound of 0 deg·K by more than noise" in found.text
    assert found.worst.worst > 970 * 40, "not before the certificate says so"
    assert found.worst.supplied.min() == pytest.approx(broken.supplied_after(2000), abs=SPREADS * 300)
    own = passivity_of_run(wire, model_of("two_p"))
    assert own.within is None
    assert "no bound to compare with: the model is not dissipative" in own.text


@pytest.mark.long("takes three seconds")
def test_gaps_cut_the_sum_and_not_the_memory(run):
    model, position = model_of("one_e"), run["position"].copy()
    position[4000:4100] = np.nan
    found = passivity_of_run(with_columns(run, position=position), model)
    first, second = found.segments
    whole = passivity_of_run(run, model).segments[0]
    assert (first.first, first.supplied.size, second.first) == (0, 4000, 4100)
    np.testing.assert_allclose(second.model, whole.model[4100:] - whole.model[4100], atol=1e-9)
    np.testing.assert_allclose(second.supplied, whole.supplied[4100:] - whole.supplied[4100], atol=1e-9)
    there = Preisach(thesis_surface("one_e"))
    there.follow(run["input"][:4101])
    assert second.bound == passivity(thesis_surface("one_e"), [there.u], there.state).bound
    assert second.bound < -10, "a warm wire holds energy"
    assert found.within is True
    assert "2 segments" in found.text


@pytest.mark.long("takes two seconds")
def test_a_missing_input_loses_the_memory_until_saturation(run):
    inputs = run["input"].copy()
    inputs[4000:4100] = np.nan
    found = passivity_of_run(with_columns(run, input=inputs), model_of("one_e"))
    first, lost, *later = found.segments
    assert first.within is True
    assert (lost.first, lost.within) == (4100, None)
    assert "the input was missing" in lost.why
    assert np.isnan(lost.model).all()
    assert np.isfinite(lost.supplied).all()
    (known,) = later
    assert known.within is True
    assert abs(run["input"][known.first]) < 0.2 or run["input"][known.first] > 173.9
    assert "Some segments have no bound: the input was missing" in found.text


def test_an_unknown_start_is_reported_and_may_be_supplied(run):
    warm = slice(1500, 2200)
    part = replace(
        run, columns={k: v[warm] for k, v in run.columns.items()}, meta=run.meta | {"initial": "continued"}
    )
    inside = (part["input"] > 1.0) & (part["input"] < 170.0)
    part = replace(part, columns={k: v[inside] for k, v in part.columns.items()})
    found = passivity_of_run(part, model_of("one_e"))
    assert found.within is None
    assert "the state at the start of the run is not known" in found.text
    assert passivity_of_run(part, model_of("one_e"), "negative").within is not None


def test_the_noise_of_a_sum_is_that_of_many(run):
    """Against two thousand draws of independent readings."""
    u = np.concatenate([np.linspace(0, 90, 60), np.full(30, 90.0), np.linspace(90, 20, 50)])
    y, rng = Preisach(thesis_surface("one_e")).simulate(u), np.random.default_rng(5)
    drawn = np.array([trapezoid(u, y + rng.normal(0, 0.05, u.size)) for _ in range(2000)])
    said = 0.05 * noise_weight(u, y + rng.normal(0, 0.05, u.size))
    np.testing.assert_allclose(drawn.std(axis=0)[1:], said[1:], rtol=0.08)


def test_readings_on_one_count_err_together():
    """A slow rise on a coarse encoder: what its rounding does to the sum is never more than is allowed for."""
    u = np.linspace(0, 120, 4000)
    u = np.concatenate([u, u[::-1]])
    y = Preisach(thesis_surface("one_e")).simulate(u)
    for phase in np.linspace(0, 1, 9):
        rounded = (np.round(y / 0.5 + phase) - phase) * 0.5
        off = np.abs(trapezoid(u, rounded) - trapezoid(u, y))
        assert (off <= SPREADS * reading_noise(rounded, 0.5) * noise_weight(u, rounded)).all()
    independent = 0.5 / np.sqrt(12) * np.sqrt(np.sum(np.diff(u) ** 2))
    assert 0.5 / np.sqrt(12) * noise_weight(u, rounded)[-1] > 3 * independent


def test_what_cannot_be_evaluated_is_refused(run):
    model = model_of("one_e")
    with pytest.raises(DataError, match="no sample with both"):
        passivity_of_run(with_columns(run, position=np.full(len(run), np.nan)), model)
    with pytest.raises(DataError, match="measures in 'mm', the model in 'deg'"):
        passivity_of_run(run, model_of("two_e"))
    with pytest.raises(UsageError, match="input in 'K', the model in 'A'"):
        passivity_of_run(run, model_of("one_e", input=SignalDescription(quantity="current", unit="A")))
    with pytest.raises(DataError, match="reversal curves"):
        passivity_of_run(replace(run, meta=run.meta | {"protocol": "first_order_reversal_curves"}), model)
    hysteresis_analysis, cold = (
        HysteresisAnalysis.of(thesis_surface("one_e")),
        Preisach(thesis_surface("one_e")).state,
    )
    with pytest.raises(DataError, match="the same number of readings"):
        segment_passivity(hysteresis_analysis, [0.0, 1.0], [0.0], 0.0, 0, cold)
    with pytest.raises(DataError, match="contains a gap"):
        segment_passivity(hysteresis_analysis, [0.0, 1.0], [0.0, np.nan], 0.0, 0, cold)
