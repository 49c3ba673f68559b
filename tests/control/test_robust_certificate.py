"""The probability of dissipativity over the uncertainty of an identification: draws, verdicts, calibration.

The calibration over 60 identified wires runs with SMARIG_LONG=1.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from control.model_files import model_file
from smarig.certificate import model_posterior, robust_certificate
from smarig.certificate.robust_certificate import Share
from smarig.cli import run as cli
from smarig.core import UsageError
from smarig.identification.fod_data import FodData
from smarig.identification.surface.surface_fit import fit_surface
from smarig.preisach import THESIS_PARTITIONS, FodSurface, FodTable, Mirrored, RelayMeasure, thesis_surface
from smarig.theory import certify, monotone

ONE_P = thesis_surface("one_p")
NAMES = ("x2", "x3", "x4", "x5", "x6", "x7", "y_upper", "y_lower")


def around(surface: FodSurface, share: float):
    """A posterior whose standard deviations are a share of each parameter, correlated in pairs."""
    sizes = share * np.abs([*surface.x, surface.y_upper, 1.0])
    correlation = 0.6 * np.ones((8, 8)) + 0.4 * np.eye(8)
    return model_posterior(surface, NAMES, correlation * np.outer(sizes, sizes))


LEAST = {"one_c": 0.0, "two_e": 0.0, "one_p": -0.0459, "two_p": -1.248}  # smallest loop area, output × K


def test_draws_have_the_covariance_of_the_file():
    sizes = np.array([1e-3, 0.2, 1e-3, 1e-6, 1e-3, 0.3, 0.01, 0.02])
    correlation = np.full((8, 8), -0.1) + 1.1 * np.eye(8)
    draw = model_posterior(ONE_P, NAMES, correlation * np.outer(sizes, sizes)).draw
    assert draw is not None
    dice = np.random.default_rng(1)
    drawn = np.array([[*(s := draw(dice)).x, s.y_upper, s.y_lower] for _ in range(4000)])
    assert np.all(np.abs(drawn.mean(axis=0) - [*ONE_P.x, 12.54, 0.0]) < 5 * sizes / np.sqrt(4000))
    assert np.corrcoef(drawn.T) == pytest.approx(correlation, abs=0.06)
    assert drawn.std(axis=0) == pytest.approx(sizes, rel=0.06)


@pytest.mark.long("takes a second")
def test_verdicts_agree_with_the_exact_ones():
    """Draws on both sides of the border, each decided with proof and by an estimate of its own."""
    posterior, dice = around(ONE_P, 0.15), np.random.default_rng([0, 0x524F])
    assert posterior.draw is not None
    exact = []
    for _ in range(12):
        surface = posterior.draw(dice)
        verdict = certify(surface).dissipative
        exact.append((verdict, verdict and monotone(surface).holds))
    found = robust_certificate(posterior, 12)
    assert found.dissipative is not None
    assert found.covered is not None
    known = [d for d, _ in exact if d is not None]
    assert 2 <= sum(known) <= 10  # both kinds
    assert abs(found.dissipative.count - sum(known)) <= 12 - len(known)
    assert found.covered.count <= sum(1 for _, c in exact if c is not False)
    assert found.least_area is not None
    assert found.least_area[0] < 0


@pytest.mark.parametrize(
    ("name", "probability"), [("one_c", 1.0), ("two_e", 1.0), ("one_p", 0.0), ("two_p", 0.0)]
)
def test_a_certain_model_has_probability_0_or_1(name, probability):
    s = thesis_surface(name)
    names = (*s.surface_form.parameters, "y_upper", "y_lower")
    posterior = model_posterior(s, names, 1e-16 * np.eye(len(names)))
    found = robust_certificate(posterior, 5)
    mirrored = robust_certificate(model_posterior(Mirrored(s), names, 1e-16 * np.eye(len(names))), 5)
    assert found.dissipative is not None
    assert mirrored.dissipative is not None
    assert found.dissipative.probability == mirrored.dissipative.probability == probability
    assert found.covered is not None
    assert found.covered.probability == probability
    assert found.least_area is not None
    assert found.least_area[1] == pytest.approx(LEAST[name], rel=0.05)  # on a grid


def test_the_interval_covers_its_probability():
    """Clopper–Pearson: at least 95 % of binomial counts have an interval with the true probability."""
    for p in (0.02, 0.3, 0.9):
        counts = np.random.default_rng(3).binomial(40, p, 400)
        inside = [low <= p <= high for low, high in (Share(int(k), 40).ci95 for k in counts)]
        assert np.mean(inside) >= 0.95


NODES = np.array([0.0, 50.0, 100.0, 174.0])
TABLE = FodTable.from_arrays(
    NODES, NODES, np.where(np.tri(4, dtype=bool), NODES[:, None] / 20 + NODES / 100, np.nan)
)


@pytest.mark.parametrize(
    ("hysteresis", "non_negative", "says"),
    [
        (TABLE, False, "noise alone makes some loop"),
        (TABLE, True, "non-negative by construction"),
        (RelayMeasure.from_arrays([1.0], [0.0], [1.0]), False, "no uncertainty of a measure of relays"),
        (ONE_P, False, "no covariance"),
    ],
)
def test_a_file_without_a_posterior_gives_no_number(hysteresis, non_negative, says):
    found = robust_certificate(model_posterior(hysteresis, non_negative=non_negative), 5)
    assert says in found.text
    assert found.to_json()["dissipative"] is None


def test_no_samples_are_refused():
    with pytest.raises(UsageError, match="at least 1 sample"):
        robust_certificate(around(ONE_P, 0.1), 0)


@pytest.mark.long("takes a second")
def test_certify_prints_and_stores_the_probability(capsys, tmp_path):
    one_e = thesis_surface("one_e")
    covariance = np.diag(np.square(0.15 * np.abs([*one_e.x, 12.54, 1.0])))
    model = model_file(tmp_path, "one_e", parameters=NAMES, covariance=covariance)
    words = [
        "certify",
        str(model),
        "--controller",
        "constant_gain",
        "--samples",
        "20",
        "-o",
        str(tmp_path / "c.html"),
    ]
    assert cli([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["robust"]
    assert found["samples"] == 20
    assert (
        found["dissipative"]["ci95"][0]
        <= found["dissipative"]["probability"]
        <= found["dissipative"]["ci95"][1]
    )
    assert "Over 20 models drawn from the identification" in (tmp_path / "c.html").read_text(encoding="utf-8")
    certain = model_file(tmp_path, "one_c")
    assert cli(["certify", str(certain), "--controller", "constant_gain", "--samples", "0", "--json"]) == 0
    assert "robust" not in json.loads(capsys.readouterr().out)


# --- calibration -------------------------------------------------------------------------------------------------


def measured(surface: FodSurface, noise: float, dice: np.random.Generator) -> FodData:
    """Readings of a surface on the thesis's partition, with noise."""
    u = np.array(THESIS_PARTITIONS["one_wire"])
    i, j = np.nonzero(np.tri(u.size))
    alpha, beta = u[i], u[j]
    zeros = np.zeros(i.size, dtype=np.int64)
    y = np.asarray(surface.y(alpha, beta)) + dice.normal(0.0, noise, i.size)
    major = (i == j) | (i == u.size - 1)
    return FodData(alpha, beta, y, i.astype(np.int64), major, zeros, zeros, "mm", 0.0, float(u[-1]), False)


@pytest.mark.long("takes some minutes")
def test_the_probability_is_calibrated():
    """Truths from a wide prior around the border, each measured with noise, fitted and judged by its own draws.

    The number of dissipative truths must be what the probabilities sum to, within three standard deviations, and the
    probabilities must have a smaller Brier score than the share of truths alone.
    """
    dice, noise = np.random.default_rng(5), 0.25
    first = fit_surface(measured(ONE_P, noise, dice), "parabolic")
    centre = around_border(first)
    prior = model_posterior(centre, first.names, 9 * first.covariance)
    assert prior.draw is not None
    p, truth = [], []
    for k in range(60):
        wire = prior.draw(dice)
        fit = fit_surface(measured(wire, noise, dice), "parabolic", start=first)
        found = robust_certificate(model_posterior(fit.surface, fit.names, fit.covariance), 40, seed=k)
        assert found.dissipative is not None
        p.append(found.dissipative.probability)
        truth.append(certify(wire).dissipative is not False)
    chance, was = np.array(p), np.array(truth, dtype=float)
    assert 0.1 < was.mean() < 0.9
    spread = np.sqrt(np.sum(chance * (1 - chance)) + 0.25)
    assert abs(was.sum() - chance.sum()) <= 3 * spread
    assert np.mean((chance - was) ** 2) < was.mean() * (1 - was.mean())


def around_border(fit) -> FodSurface:
    """The fitted surface with x₆ moved to where its least loop area leaves zero, by bisection."""
    x = list(fit.surface.x)
    low, high = 0.0, x[4]  # without x₆, and as fitted
    for _ in range(8):
        middle = (low + high) / 2
        surface = replace(fit.surface, x=(*x[:4], middle, x[5]))
        low, high = (low, middle) if certify(surface).dissipative is False else (middle, high)
    return replace(fit.surface, x=(*x[:4], low, x[5]))
