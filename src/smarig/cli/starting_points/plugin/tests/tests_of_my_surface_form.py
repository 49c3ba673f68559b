"""Slope and Jacobian are derivatives of the value; a model with this form is identified, and read when it is named."""

import numpy as np
import pytest

import smarig
from smarig.cli import run
from smarig.preisach import surface_form

X, ALPHA, H = (0.2, -30.0), np.linspace(0.0, 170.0, 18), 1e-4


@pytest.fixture
def form():
    smarig.use_plugin("my_surface_form")
    return surface_form("my_surface_form")


def test_the_slope_is_the_derivative(form):
    numeric = (form.value(X, ALPHA + H) - form.value(X, ALPHA - H)) / (2 * H)
    assert form.slope(X, ALPHA) == pytest.approx(numeric, rel=1e-6)


def test_the_jacobian_is_the_derivative_by_each_parameter(form):
    for k, column in enumerate(form.jacobian(X, ALPHA).T):
        up, down = (tuple(x + sign * H * (j == k) for j, x in enumerate(X)) for sign in (1, -1))
        assert column == pytest.approx((form.value(up, ALPHA) - form.value(down, ALPHA)) / (2 * H), rel=1e-6)


def test_a_model_is_identified_and_opens_when_the_form_is_named():
    levels = [0.0, 40.0, 90.0, 130.0, 170.0]
    smarig.run("first_order_descending", rig="one_wire_twin", out="f.run.sqlite", partition_K=levels)
    assert run(["identify", "f.run.sqlite", "--surface", "my_surface_form", "-o", "m.model.json"]) == 0
    assert run(["--plugin", "my_surface_form", "verify", "m.model.json", "f.run.sqlite"]) == 0
