"""Measurements by others from import to report, with the required results of each."""

import pytest

import smarig
from smarig.cli import run

WIRE_DATA = [
    ("sma_staircase/test.csv", "sma_staircase"),
    ("sma_isobaric/cal_sample_1/150 MPa.txt", "sma_isobaric_1"),
    ("sma_isobaric/cal_sample_2/100 MPa.txt", "sma_isobaric_2"),
    ("flexinol_isobaric/filtered_data_100MPa.txt", "flexinol_isobaric"),
    ("sma_heating_step/step.csv", "sma_heating_step"),
    ("sma_cycles/cycles.txt", "sma_cycles"),
    ("sma_force_pulse/AB0.csv", "sma_force_pulse"),
    ("sma_nested_bumps/ele_hys_1.txt", "sma_nested_bumps"),
    ("ferroelectric_loops/RMN_TRAP_SLOW.dat", "ferroelectric_loops:2"),
]
FORC = [("hchb_forc", 0.0006), ("MSM33-55-1_d330.forc", 0.0005), ("UB199BF", 0.00015)]


def call(*arguments):
    assert run([str(a) for a in arguments]) == 0


@pytest.mark.long("takes ten seconds", cases=("sma_cycles-sma_cycles", "sma_force_pulse-sma_force_pulse"))
@pytest.mark.parametrize(("file", "mapping"), WIRE_DATA, ids=lambda v: str(v).split("/")[0])
def test_it_imports_through_its_mapping_and_gives_a_report(shared_data, tmp_path, file, mapping):
    out, page = tmp_path / "r.run.sqlite", tmp_path / "r.html"
    call("import", shared_data / file, "--format", "csv", "--map", mapping, "-o", out)
    call("report", out, "-o", page)
    text = page.read_text(encoding="utf-8")
    recorded = smarig.load_run(out)
    assert not recorded.twin
    assert "TWIN:" not in text
    for warning in recorded.meta["warnings"]:
        assert warning.split("<")[0][:40].replace("'", "&#x27;") in text


@pytest.mark.long("takes three seconds", cases=("UB199BF-0.00015", "hchb_forc-0.0006"))
@pytest.mark.parametrize(("name", "allowed"), FORC)
def test_every_second_reversal_curve_predicts_the_others(shared_data, tmp_path, capsys, name, allowed):
    import json

    forc, model = tmp_path / "forc.run.sqlite", tmp_path / "half.model.json"
    call("import", shared_data / "forc_magnetic" / name, "--format", "forc", "-o", forc)
    call("identify", forc, "--surface", "table", "--select", "curve%2==0", "-o", model)
    curves = smarig.load_run(forc).meta["forc"]["curves"]
    capsys.readouterr()
    call("verify", model, forc, "--select", f"curve%2==1 and curve<{curves - 1}", "--json")
    judged = json.loads(capsys.readouterr().out)["runs"][0]
    assert judged["n"] > 3000
    assert judged["nrmse"] <= allowed


def test_the_heating_step_gives_a_time_constant_with_an_interval(shared_data, tmp_path, capsys):
    import json

    out = tmp_path / "step.run.sqlite"
    source = shared_data / "sma_heating_step" / "step.csv"
    call("import", source, "--format", "csv", "--map", "sma_heating_step", "-o", out)
    capsys.readouterr()
    call("calibrate", out, "--json")
    found = json.loads(capsys.readouterr().out)
    low, high = found["parameters"]["tau"]["ci95"]
    assert 15 < low < found["parameters"]["tau"]["value"] < high < 40
    assert high - low > 1, "a quantised, autocorrelated record does not pin τ down to less than that"
    assert "R_M" in found["not_available"]
