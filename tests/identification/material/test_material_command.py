"""``smarig identify --material``: its output, files, page, and what it refuses."""

import json

import numpy as np
import pytest

from identification.material.simulated_wires import Wire
from report.pages import Page
from smarig.cli import run as cli
from smarig.exchange import import_file
from smarig.identification.material.material_text import value_text
from smarig.plant import Actuator

WIRE = Wire(A_s=70.0, A_f=80.0, M_s=56.0, M_f=46.0, k=0.03, n=(0.8, 0.8, 0.8, 0.8))
MAPPING = """
name = "loops"
summary = "Strain over temperature."
source = "simulated"
[columns]
temperature_degC = {{ column = "T", unit = "degC" }}
position = {{ column = "e", unit = "{unit}" }}
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "strain"
unit = "{unit}"
[conditions]
stress = {{ column = "s", unit = "MPa" }}
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Imported files of three loads."""
    folder = tmp_path_factory.mktemp("loops")
    (folder / "map.toml").write_text(MAPPING.format(unit="%"))
    found = []
    for load in (60, 150, 240):
        T, s, strain = WIRE.isobaric(load, 60)
        noise = 2e-5 * np.random.default_rng(load).normal(size=T.size)
        rows = np.column_stack([T, 100 * (strain + noise), s])
        file = folder / f"{load} MPa.csv"
        np.savetxt(file, rows, delimiter=";", header="T;e;s", comments="", fmt="%.6f")
        out = folder / f"{load}.run.sqlite"
        import_file(file, format="csv", mapping=str(folder / "map.toml"), out=out)
        found.append(str(out))
    return found


def test_the_command_writes_the_actuator_and_the_page(runs, tmp_path, capsys):
    out, page = tmp_path / "wire.toml", tmp_path / "wire.html"
    command = [
        "identify",
        *runs,
        "--material",
        "--actuator",
        "flexinol_015",
        "-o",
        str(out),
        "--page",
        str(page),
    ]
    assert cli([*command, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    low, high = found["parameters"]["austenite_start"]["ci95"]
    assert low <= 70.0 <= high
    assert "isothermal" in found["not_determined"]["modulus_martensite"]
    assert [r["level"] for r in found["records"]] == [60, 150, 240]
    assert all(r["left_out_rms"] is not None for r in found["records"])
    assert Actuator.named(str(out)).file.thermomechanical.slope_austenite.value == pytest.approx(8.5, rel=0.1)
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") >= 6  # all loops, phase diagram, strain, and each of three loads
    assert "Not determined by these records" in Page(text).visible


@pytest.mark.long("takes five seconds")
def test_the_text_names_what_is_missing(runs, capsys):
    assert cli(["identify", *runs, "--material"]) == 0
    text = capsys.readouterr().out
    assert "C_A   = " in text
    assert "E_M is not determined: each record holds its stress" in text
    assert "if predicted from the other loads" in text


@pytest.mark.parametrize("option", ["-o", "--page"])
def test_a_file_that_exists_is_refused_before_the_fit(runs, tmp_path, capsys, monkeypatch, option):
    monkeypatch.setattr("smarig.identification.identify_material", lambda *_, **__: pytest.fail("was fitted"))
    there = tmp_path / "there"
    there.write_text("kept")
    assert cli(["identify", *map(str, runs), "--material", option, str(there)]) == 2
    assert "exists; give another name or --force" in capsys.readouterr().err
    assert there.read_text() == "kept"


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("expansion_austenite", -5e-5, "−50 10⁻⁶/K"),
        ("strain_least", 0.0, "0 %"),
        ("strain_stress", 3.5, "3.5 MPa"),
    ],
)
def test_the_end_of_a_range_is_written_as_the_parameter_is(name, value, text):
    assert value_text(name, value) == text


def test_one_load_is_refused(runs, capsys):
    assert cli(["identify", runs[0], "--material"]) == 2
    assert "cannot determine C_A and C_M" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "match"),
    [
        (["--material", "--surface", "positive"], "without a surface"),
        (["--page", "x.html"], "--page serves --material only"),
        (["--actuator", "flexinol_015"], "--actuator serves --material only"),
        ([], "Name the model file with -o"),
    ],
)
def test_options_that_do_not_fit(runs, more, match, capsys):
    assert cli(["identify", runs[0], *more]) == 2
    assert match in capsys.readouterr().err
