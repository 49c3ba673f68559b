"""One model of several loads: its slope, loads between and beyond, and what cannot be modelled."""

from functools import cache

import numpy as np
import pytest

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles
from smarig.cli import run as cli
from smarig.core import DataError, UsageError
from smarig.identification import identify, verify
from smarig.record import load_run
from smarig.replay import load_model, simulate

T = triangles((95.0, 95.0), rows=80, low=20.0)
C = 8.0  # MPa/K
LOADS = (50.0, 120.0, 200.0)


def stroke(stress):
    """Grows with the stress and saturates, as transformation strain does."""
    return 4.0 * (1 - np.exp(-stress / 80.0))


@cache
def loaded(stress, seed=0):
    strain = RelayWire(5).strain(T, stroke(stress), rise=(stress - 50.0) / C) + 0.004 * stress
    return as_run(f"load_{stress:.0f}", T, strain, stress=stress, seed=seed)


@cache
def modelled():
    return identify([loaded(s) for s in LOADS], load_from="stress")


@pytest.mark.long
def test_the_slope_is_found_with_an_interval_that_contains_it():
    load = modelled().to_json()["load"]
    low, high = load["MPa_per_K"]["ci95"]
    assert low <= C <= high
    assert load["MPa_per_K"]["value"] == pytest.approx(C, rel=0.1)
    assert load["values"] == list(LOADS)


@pytest.mark.long
def test_a_load_between_is_predicted_with_its_zero_and_far_better_than_by_pooling():
    other = loaded(160.0)
    error = simulate(modelled().model, other) - other["position"]
    rms = float(np.sqrt(np.nanmean(error**2)))
    pooled = verify(identify([loaded(s) for s in LOADS], "positive").model, other).runs[0].settled.rms
    assert rms < 0.02 * stroke(160.0)
    assert rms < 0.25 * pooled


@pytest.mark.long("takes five seconds")
def test_a_load_beyond_is_predicted_and_said_to_be_extrapolated():
    found = verify(modelled().model, loaded(230.0)).runs[0]
    assert found.settled.nrmse < 0.05
    assert any("extrapolates" in w for w in found.warnings)
    assert found.expected == modelled().load.left_out_rms(beyond=True)


def test_a_measured_load_needs_no_expectation():
    assert verify(modelled().model, loaded(120.0, seed=1)).runs[0].expected is None


def test_the_model_survives_its_file_bit_for_bit(tmp_path):
    model = modelled().model
    again = load_model(model.save(tmp_path / "load.model.json"))
    assert np.array_equal(simulate(again, loaded(160.0)), simulate(model, loaded(160.0)), equal_nan=True)


@pytest.mark.long("takes five seconds")
def test_a_run_that_ended_early_is_named():
    tripped = loaded(LOADS[0]).with_meta(end={"cause": "stopped: The lease expired."})
    found = identify([tripped, loaded(LOADS[1])], load_from="stress")
    (warning,) = [w for w in found.warnings if "ended early" in w]
    assert "stopped: The lease expired. The model describes only the rows before." in warning


@pytest.mark.long("takes three seconds")
def test_loads_that_differ_in_shape_get_a_measure_each(tmp_path):
    """The loop widens with the load, which no gain describes."""

    def widening(stress):
        wire = RelayWire(6)
        wire.up = wire.up + 0.12 * (stress - 50.0)
        return as_run(f"wide_{stress:.0f}", T, wire.strain(T, rise=(stress - 50.0) / 20.0), stress=stress)

    found = identify([widening(s) for s in (50.0, 100.0, 150.0)], load_from="stress")
    assert found.load.own
    other = widening(125.0)
    error = simulate(load_model(found.model.save(tmp_path / "w.model.json")), other) - other["position"]
    inner = next(k for k in found.load.left_out if not k.beyond)
    assert inner.own < inner.one
    assert float(np.sqrt(np.nanmean(error**2))) < inner.own


def test_runs_without_a_stress_or_of_one_stress_are_refused_in_one_sentence():
    with pytest.raises(DataError, match="does not state its stress"):
        identify([loaded(50.0), as_run("bare", T, RelayWire(5).strain(T))], load_from="stress")
    with pytest.raises(DataError, match="about 50 in all runs"):
        identify([loaded(50.0), loaded(50.0, seed=1)], load_from="stress")
    with pytest.raises(UsageError, match="did you mean stress"):
        identify([loaded(50.0), loaded(120.0)], load_from="stres")
    with pytest.raises(UsageError, match="not with 'exponential'"):
        identify([loaded(50.0), loaded(120.0)], "exponential", load_from="stress")


@pytest.mark.long("takes five seconds")
def test_the_command_identifies_loads_and_simulates_another(shared_data, tmp_path, capsys):
    files = []
    for stress in (50, 150, 100):
        source = shared_data / "flexinol_isobaric" / f"filtered_data_{stress}MPa.txt"
        if not source.is_file():
            pytest.skip(f"real data {source.name} are not in {source.parent}")
        files.append(str(tmp_path / f"{stress}.run.sqlite"))
        assert (
            cli(["import", str(source), "--format", "csv", "--map", "flexinol_isobaric", "-o", files[-1]])
            == 0
        )
    model, out = str(tmp_path / "f.model.json"), str(tmp_path / "sim.run.sqlite")
    assert cli(["identify", *files[:2], "--load-from", "stress", "-o", model]) == 0
    printed = capsys.readouterr().out
    assert "MPa_per_K = " in printed
    assert "of 499 rows used" in printed
    assert cli(["simulate", model, "--along", files[2], "-o", out]) == 0
    measured, simulated = load_run(files[2]), load_run(out)
    error = simulated["position"] - measured["position"]
    assert float(np.sqrt(np.nanmean(error**2))) < 0.0010, (
        "mm/mm; the nearest load's own model misses it by 0.004"
    )
