"""A surface fit that also matches slopes (§9.2), against a direct minimisation, and the note on the twin's crossing."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import smarig
from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.identification.fod_data import FodData
from smarig.identification.surface.curve_report import twin_crossing_note
from smarig.identification.surface.surface_fit import fit_surface
from smarig.preisach import THESIS_PARTITIONS, FodSurface, thesis_surface
from smarig.theory import loop_area


def measured(surface: FodSurface, noise: float, seed: int) -> FodData:
    """Readings on the thesis's one-wire partition, in mixed order."""
    dice = np.random.default_rng(seed)
    u = np.array(THESIS_PARTITIONS["one_wire"])
    order = dice.permutation(u.size * (u.size + 1) // 2)
    i, j = (x[order] for x in np.nonzero(np.tri(u.size)))
    y = np.asarray(surface.y(u[i], u[j])) + dice.normal(0.0, noise, i.size)
    zeros, major = np.zeros(i.size, dtype=np.int64), (i == j) | (i == u.size - 1)
    return FodData(u[i], u[j], y, i.astype(np.int64), major, zeros, zeros, "mm", 0.0, float(u[-1]), False)


@pytest.mark.parametrize("weight", [0.5, 4.0])
def test_exact_data_give_the_surface_back_for_every_weight(weight):
    truth = thesis_surface("one_c")
    fit = fit_surface(measured(truth, 0.0, 1), "constant", slopes=weight)
    assert fit.values == pytest.approx([*truth.x, truth.y_upper, truth.y_lower], rel=1e-6, abs=1e-6)
    assert fit.slope_weight == weight


def test_the_fit_minimises_outputs_and_slopes_together():
    """The objective written out point by point; no direct search finds a smaller value, and the gradient vanishes."""
    data, weight = measured(thesis_surface("one_e"), 0.02, 2), 2.0
    fit = fit_surface(data, "constant", slopes=weight)
    pairs = [
        (a, b, c)
        for a in np.unique(data.alpha)
        for b, c in zip(
            *(x(np.sort(data.beta[data.alpha == a])) for x in (lambda v: v[1:], lambda v: v[:-1]))
        )
    ]
    spacing = np.mean([b - c for _, b, c in pairs])
    reading = {(a, b): y for a, b, y in zip(data.alpha, data.beta, data.y)}

    def objective(p):
        s = FodSurface("constant", tuple(p[:4]), data.lower, data.upper, p[5], p[4])
        error = (s.y(data.alpha, data.beta) - data.y) * np.where(data.major, 2.0, 1.0)
        slopes = [
            (float(s.y(a, b) - s.y(a, c)) - (reading[a, b] - reading[a, c])) / (b - c) for a, b, c in pairs
        ]
        return float(error @ error + np.sum((weight * spacing * np.array(slopes)) ** 2))

    here = objective(fit.values)
    found = minimize(objective, fit.values, method="Nelder-Mead", options={"maxfev": 500})
    assert found.fun >= here * (1 - 1e-7)
    plain = fit_surface(data, "constant")
    assert here < objective(plain.values) * 0.999


def test_the_covariance_is_that_of_repeated_measurements():
    truth, noise = thesis_surface("one_c"), 0.05
    first = fit_surface(measured(truth, noise, 0), "constant", slopes=2.0)
    fits = [fit_surface(measured(truth, noise, k), "constant", slopes=2.0, start=first) for k in range(1, 81)]
    spread = np.std([f.values for f in fits], axis=0)
    predicted = np.sqrt(np.mean([np.diag(f.covariance) for f in fits], axis=0))
    assert spread == pytest.approx(predicted, rel=0.3)
    assert np.mean([f.sigma for f in fits]) == pytest.approx(noise, rel=0.05)


def test_slopes_help_a_misfit_and_cost_the_right_family():
    """docs/explanation/matching_slopes.md: loop areas of a parabolic and of an exponential fit to one_e."""
    truth, data = thesis_surface("one_e"), measured(thesis_surface("one_e"), 0.02, 3)
    dice = np.random.default_rng(4)
    high, low = np.sort(dice.uniform(0.0, 174.1, (2, 200)), axis=0)[::-1]

    def area_error(form: str, weight: float) -> float:
        fit = fit_surface(data, form, slopes=weight).surface
        return float(np.sqrt(np.mean((loop_area(fit, high, low) - loop_area(truth, high, low)) ** 2)))

    assert area_error("parabolic", 1.0) < 0.75 * area_error("parabolic", 0.0)
    assert area_error("exponential", 3.0) > 1.3 * area_error("exponential", 0.0)


@pytest.fixture(scope="module")
def curves(tmp_path_factory):
    folder = tmp_path_factory.mktemp("curves")
    return smarig.run(
        "first_order_descending",
        rig="one_wire_twin",
        out=folder / "f.run.sqlite",
        seed=1,
        partition_K=(0, 7, 25, 43.5, 62.7, 100, 174),
    )


@pytest.mark.long("takes two seconds")
def test_identify_takes_the_weight_and_stores_it(capsys, curves, tmp_path):
    words = ["identify", str(curves.path), "--surface", "exponential", "--slopes", "1.5"]
    assert cli([*words, "-o", str(tmp_path / "m.model.json"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["fit"]["slope_weight"] == 1.5
    assert smarig.load_model(tmp_path / "m.model.json").fit["slope_weight"] == 1.5
    assert "slope_weight" not in smarig.identify(curves, "exponential").model.fit


@pytest.mark.long("takes three seconds", cases=("table",))
@pytest.mark.parametrize("surface", ["table", "positive", "best"])
def test_only_fitted_surfaces_take_slopes(curves, surface):
    with pytest.raises(UsageError, match="applies to a fitted surface"):
        smarig.identify(curves, surface, slopes=1.0)


@pytest.mark.parametrize("weight", [-1.0, float("nan"), float("inf")])
def test_a_wrong_weight_is_refused(weight):
    with pytest.raises(UsageError, match="weight of slopes"):
        fit_surface(measured(thesis_surface("one_c"), 0.0, 1), "constant", slopes=weight)


@pytest.mark.long("takes three seconds")
def test_the_twins_crossing_is_named_as_its_own(capsys, curves, tmp_path):
    """One sentence in JSON and text on the default twin; none on a twin whose curves do not cross."""
    assert (
        cli(
            [
                "identify",
                str(curves.path),
                "--surface",
                "exponential",
                "-o",
                str(tmp_path / "n.json"),
                "--json",
            ]
        )
        == 0
    )
    printed = capsys.readouterr()
    note = json.loads(printed.out)["crossing_note"]
    assert "surface one_e of Table 5.1" in note
    assert note in printed.err
    two = smarig.run(
        "first_order_descending",
        rig="two_wire_twin",
        out=tmp_path / "t.run.sqlite",
        seed=1,
        partition_K=(-185, -60, 0, 60, 185),
    )
    assert "crossing_note" not in smarig.identify(two, "exponential").to_json()
    with pytest.raises(UsageError, match="leaves no weight to the outputs"):
        smarig.identify(two, "exponential", slopes=1e100)
    values = {**curves.info.actuator_values, "thermomechanical": {"pre_strain": 0.03}}
    assert twin_crossing_note([curves])
    assert not twin_crossing_note([replace(curves, meta={**curves.meta, "actuator_values": values})])
