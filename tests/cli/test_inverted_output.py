"""Data whose output has the wrong sign: refused, or a fit with a warning, on every surface; never a silent success."""

import json
import shutil
import warnings

import numpy as np
import pytest

from record.runs import edited
from smarig.cli import run as cli
from smarig.diagnosis.refit.variance_components import bounds_of
from smarig.identification import surface_choices
from smarig.record import load_run
from smarig.replay import build_timeline, load_model
from smarig.replay.plant_model import plant_model_of

SIGNS = {"falling": "-{y}", "leading": "0.12 * {u} - {y}"}  # the second leads its input: no hysteresis


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A run of reversal curves, its two inversions, and a model of the run as it was measured."""
    folder = tmp_path_factory.mktemp("inverted")
    run, model = folder / "fod.run.sqlite", folder / "m.model.json"
    made = ["run", "first_order_descending", "--rig", "one_wire_twin", "-o", str(run)]
    assert cli([*made, "--set", "partition_K=0,20,40,60,90,120,170"]) == 0
    assert cli(["identify", str(run), "--surface", "exponential", "-o", str(model)]) == 0
    found = {"model": model, "run": run}
    for name, law in SIGNS.items():
        found[name] = folder / f"{name}.run.sqlite"
        shutil.copy(run, found[name])
        with edited(found[name]) as db:
            db.execute(f"UPDATE sample SET position = {law.format(y='position', u='input')}")
            db.execute(f"UPDATE step SET position = {law.format(y='position', u='target')}")
    return found


FITS = [(surface, "none") for surface in surface_choices()] + [
    ("positive", "best"),
    ("table", "accommodating"),
]


@pytest.mark.long(
    "takes three seconds",
    cases=(
        "falling-constant-none",
        "falling-exponential-none",
        "falling-positive-best",
        "falling-positive-none",
        "leading-best-none",
        "leading-exponential-none",
        "leading-positive-best",
        "leading-positive-none",
    ),
)
@pytest.mark.parametrize(("surface", "extension"), FITS)
@pytest.mark.parametrize("sign", SIGNS)
def test_no_surface_fits_it_without_a_warning(files, tmp_path, capsys, sign, surface, extension):
    model = tmp_path / "m.model.json"
    line = ["identify", str(files[sign]), "--surface", surface, "--extension", extension, "-o", str(model)]
    status = cli(line)
    error = capsys.readouterr().err
    assert status == 4 or (status == 0 and "Warning: " in error)
    assert model.exists() == (status == 0)
    if "The fit is poor" in error:
        assert ("Or try --surface positive" in error) == (surface != "positive")


@pytest.mark.parametrize("sign", SIGNS)
def test_a_model_of_the_right_sign_is_not_verified_without_a_warning(files, capsys, sign):
    assert cli(["verify", str(files["model"]), str(files[sign]), "--json"]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["runs"][0]["verdict"] == "poor"
    assert "Warning: The model does not predict" in shown.err
    assert cli(["verify", str(files["model"]), str(files["run"])]) == 0
    assert "does not predict" not in capsys.readouterr().err


@pytest.mark.long("takes a second")
def test_the_page_of_models_names_the_poor_one(files, tmp_path):
    page = tmp_path / "models.html"
    assert cli(["report", str(files["falling"]), "--model", str(files["model"]), "-o", str(page)]) == 0
    assert ": poor." in page.read_text(encoding="utf-8")


def test_the_noise_of_a_falling_output_is_positive(files, tmp_path):
    model = tmp_path / "falling.model.json"
    assert cli(["identify", str(files["falling"]), "--surface", "positive", "-o", str(model)]) == 0
    run = load_run(files["falling"])
    plant = plant_model_of(load_model(model), run)
    assert plant.stroke < 0
    bounds = np.array(bounds_of(build_timeline([run], plant.actuator.tau_s), plant))
    assert np.isfinite(bounds).all()
    assert (bounds[0] < bounds[1]).all()


@pytest.mark.long("takes ten seconds")
def test_a_model_whose_output_falls_is_diagnosed(files, tmp_path, capsys):
    model = tmp_path / "falling.model.json"
    assert cli(["identify", str(files["falling"]), "--surface", "positive", "-o", str(model)]) == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        assert cli(["diagnose", str(model), "--train", str(files["falling"]), "--json"]) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert found["verdict"] == "silent"
    assert 0 < found["error"]["base"] < 0.1  # mm
