"""Everett tables and weights over the Preisach plane: recognised, refused as records, and written as models."""

import numpy as np
import pytest

from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.record import load_run
from smarig.replay import load_model
from smarig.study import StudyOptions, study

QUICK = StudyOptions(diagnose=False)
LEVELS = np.linspace(20.0, 100.0, 9)
A, B = np.meshgrid(LEVELS, LEVELS, indexing="ij")
WEIGHTS = np.where(A >= B, np.exp(-(((A - 75) / 20) ** 2) - ((B - 45) / 20) ** 2), 0.0)
EVERETT = np.where(A >= B, (A - B) ** 2 / 6400, 0.0)  # of an even density


def matrix(path, values, *, corner="", delimiter=",", blank="", transposed=False):
    values = values.T if transposed else values
    above = (lambda i, j: i < j) if not transposed else (lambda i, j: i > j)
    rows = [delimiter.join([corner, *(f"{u:g}" for u in LEVELS)])]
    for i, u in enumerate(LEVELS):
        cells = [blank if above(i, j) and blank is not None else f"{v:.9f}" for j, v in enumerate(values[i])]
        rows.append(delimiter.join([f"{u:g}", *cells]))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def columns(path, values, name):
    rows = [f"{LEVELS[i]:g}\t{LEVELS[j]:g}\t{values[i, j]:.9f}" for i in range(9) for j in range(i + 1)]
    path.write_text(f"alpha\tbeta\t{name}\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def relays(u):
    """The output of relays with the weights, from negative saturation: each switches in the middle of its cell."""
    state, out = -np.ones_like(WEIGHTS), []
    for value in u:
        state = np.where(value >= A, 1.0, np.where(value <= B, -1.0, state))
        out.append(float((WEIGHTS * state).sum()))
    return np.array(out)


def refused(path, folder, **units):
    with pytest.raises(UsageError) as error:
        study([path], folder, StudyOptions(units=units))
    return str(error.value)


WAY = np.array([15.0, 105.0, 45.0, 75.0, 55.0, 95.0, 25.0, 65.0])  # edges of cells


@pytest.mark.parametrize(
    "write",
    [
        lambda path: matrix(path, WEIGHTS),
        lambda path: matrix(path, WEIGHTS, corner="alpha\\beta", delimiter=";"),
        lambda path: matrix(path, WEIGHTS, corner="0", delimiter=" ", blank=None),
        lambda path: matrix(path, WEIGHTS, transposed=True),
        lambda path: columns(path, WEIGHTS, "weight"),
        lambda path: columns(path, WEIGHTS, "z"),
    ],
    ids=["matrix", "semicolons", "zeros", "beta in rows", "columns", "columns without a name"],
)
def test_weights_become_the_model_of_their_relays(tmp_path, write):
    said = refused(write(tmp_path / "mu.txt"), tmp_path / "out")
    assert "is a table of Preisach weights over 9 levels" in said
    assert "no record" in said
    model = load_model(tmp_path / "out" / "model.json")
    halves = np.concatenate([[WAY[0]], *(np.linspace(a, b, 19)[1:] for a, b in zip(WAY, WAY[1:]))])
    ends = np.arange(0, halves.size, 18)
    np.testing.assert_allclose(model.predict(halves)[ends], relays(halves)[ends], atol=1e-6)


@pytest.mark.parametrize("corner", ["", "Everett"])
def test_an_everett_table_becomes_a_model_with_its_first_order_curves(tmp_path, corner):
    assert "is an Everett table" in refused(
        matrix(tmp_path / "e.csv", EVERETT, corner=corner), tmp_path / "out"
    )
    model = load_model(tmp_path / "out" / "model.json")
    low, turn, back = model.predict([20.0, 80.0, 40.0])
    assert low == pytest.approx(-0.5)
    assert turn - low == pytest.approx(60**2 / 6400)
    assert turn - back == pytest.approx(40**2 / 6400)


def test_a_density_is_a_weight_per_area(tmp_path):
    refused(matrix(tmp_path / "a.csv", WEIGHTS), tmp_path / "weights")
    assert "is a Preisach density" in refused(
        columns(tmp_path / "b.txt", WEIGHTS / 100, "density"), tmp_path / "out"
    )
    one, other = (load_model(tmp_path / f / "model.json").predict(WAY) for f in ("weights", "out"))
    np.testing.assert_allclose(one, other, atol=1e-6)


@pytest.mark.parametrize("by", ["option", "names"])
def test_the_model_runs_along_a_record(tmp_path, by):
    if by == "option":
        said = refused(matrix(tmp_path / "mu.csv", WEIGHTS), tmp_path / "out", input="degC", output="mm")
    else:
        path = columns(tmp_path / "mu.txt", WEIGHTS, "weight [mm]")
        path.write_text(path.read_text(encoding="utf-8").replace("alpha", "alpha (°C)"), encoding="utf-8")
        said = refused(path, tmp_path / "out")
    assert "does not say its units" not in said
    u = 60 - 40 * np.cos(np.linspace(0, 4 * np.pi, 200))
    rows = "\n".join(f"{k / 2},{a:.3f},{a / 10:.4f}" for k, a in enumerate(u))
    (tmp_path / "r.csv").write_text(f"time (s),temperature (°C),stroke (mm)\n{rows}\n", encoding="utf-8")
    (run,) = [t.run.path for t in study([tmp_path / "r.csv"], tmp_path / "r", QUICK).tables]
    out = tmp_path / "simulated.run.sqlite"
    model = str(tmp_path / "out" / "model.json")
    assert cli(["simulate", model, "--along", str(run), "-o", str(out)]) == 0
    assert np.ptp(load_run(out)["position"]) > WEIGHTS.sum()


def test_units_that_are_not_known_are_asked_for(tmp_path):
    assert refused(matrix(tmp_path / "mu.csv", WEIGHTS), tmp_path / "out").endswith(
        "The file does not say its units; give them with --unit input=UNIT --unit output=UNIT."
    )


def test_a_square_matrix_with_values_below_the_diagonal_makes_no_model(tmp_path):
    said = refused(matrix(tmp_path / "s.csv", WEIGHTS + 1, blank=None), tmp_path / "out")
    assert "it makes no model: it has values where α < β" in said
    assert not (tmp_path / "out" / "model.json").exists()


def test_a_missing_value_is_named(tmp_path):
    values = WEIGHTS.copy()
    values[5, 2] = np.nan
    assert "no value at α = 70, β = 40" in refused(matrix(tmp_path / "m.csv", values), tmp_path / "out")


@pytest.mark.parametrize("names", ["a,b,c", "time (s),temperature (°C),stroke (mm)"])
def test_a_record_is_none(tmp_path, names):
    u = 60 - 40 * np.cos(np.linspace(0, 4 * np.pi, 45))  # 45 rows: as many as pairs of 9 levels
    path = tmp_path / "r.csv"
    path.write_text(
        f"{names}\n" + "\n".join(f"{k},{a:.3f},{a / 10:.4f}" for k, a in enumerate(u)), encoding="utf-8"
    )
    assert study([path], tmp_path / "out", StudyOptions(accept=True, diagnose=False)).evaluation is not None
