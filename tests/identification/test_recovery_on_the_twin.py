"""Recovery of the surface from noisy, quantised FOD runs of the twin: ten seeds, or 20 and both rigs (SMARIG_LONG)."""

import os
from dataclasses import dataclass

import numpy as np
import pytest

from smarig.config import load_rig
from smarig.identification.fod_data import fod_data
from smarig.identification.surface.surface_fit import fit_surface
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.record import load_run
from smarig.rig.twin import TwinSettings
from smarig.runner.preview import preview
from smarig.runner.session import Session

LONG = bool(os.environ.get("SMARIG_LONG"))
SEEDS = range(20 if LONG else 10)


@dataclass
class Recovery:
    """What the fits say, against the noise-free truth."""

    rms: np.ndarray
    density_error: np.ndarray
    worst_parameter: np.ndarray
    coverage: float


def recovered(tmp_path, rig, truth_name, form):
    cost = preview("first_order_descending", load_rig(rig))
    rows = [one(tmp_path, rig, thesis_surface(truth_name), form, seed, cost) for seed in SEEDS]
    rms, density_error, worst, inside = (list(column) for column in zip(*rows, strict=True))
    return Recovery(np.array(rms), np.array(density_error), np.array(worst), float(np.mean(inside)))


def one(tmp_path, rig, truth, form, seed, cost):
    with Session(rig, twin=TwinSettings(seed=seed, hysteresis=truth)) as session:
        zero = round(session.rig.specimen.plant.position / session.rig.position_per_count)
        path = session.run(
            "first_order_descending", {}, tmp_path / "fod.run.sqlite", force=True, expected=cost
        )
        offset = zero * session.rig.position_per_count  # what the relative encoder calls zero
    data = fod_data(load_run(path))
    fit = fit_surface(data, form)
    error = fit.surface.y(data.alpha, data.beta) + offset - truth.y(data.alpha, data.beta)
    a, b = np.meshgrid(*[np.linspace(truth.lower, truth.upper, 120)] * 2, indexing="ij")
    a, b = a[b <= a], b[b <= a]
    mu = truth.density(a, b)
    density_error = np.max(np.abs(fit.surface.density(a, b) - mu)) / np.max(np.abs(mu))
    shapes = dict(zip(("x2", "x3", "x4", "x5", "x6", "x7"), truth.x, strict=False))
    values = dict(zip(fit.names, fit.values, strict=True))
    worst = max(abs(values[name] / true - 1) for name, true in shapes.items())
    ends = {"y_lower": truth.y_lower - offset, "y_upper": truth.y_upper - offset}
    inside = [fit.intervals[n][0] <= true <= fit.intervals[n][1] for n, true in (shapes | ends).items()]
    return np.sqrt(np.mean(error**2)), density_error, worst, inside


@pytest.mark.long
def test_the_surface_and_its_density_are_found_far_below_a_count(tmp_path):
    one_e = recovered(tmp_path, "one_wire_twin", "one_e", "exponential")
    assert np.median(one_e.rms) <= 0.0015
    assert one_e.rms.max() <= 0.003
    assert np.median(one_e.density_error) <= 0.005
    assert one_e.density_error.max() <= 0.01
    assert 0.90 <= one_e.coverage <= 0.99


@pytest.mark.long("takes half a minute")
def test_the_parameters_are_found_and_their_intervals_cover(tmp_path):
    two_c = recovered(tmp_path, "two_wire_twin", "two_c", "constant")
    assert np.median(two_c.worst_parameter) <= 0.003
    assert two_c.worst_parameter.max() <= 0.01
    assert 0.90 <= two_c.coverage <= 0.99
