"""A surface fitted to outputs after any histories: it finds the one that made them."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.made_memories import prediction_for_inputs
from smarig.identification import Observations, surface_through_states
from smarig.preisach import FodSurface, Initial

TRUE = FodSurface(
    form="exponential",
    x=(0.045, -47.0, 0.111, 390.0, 0.086, -24.0),
    lower=0.0,
    upper=174.1,
    y_lower=0.2,
    y_upper=12.7,
    unit="mm",
)
NEAR = replace(TRUE, x=(0.05, -43.0, 0.105, 360.0, 0.084, -22.0), y_lower=0.0, y_upper=12.0)


def rows(initial: Initial = "negative", zero=None):
    """Outputs after 150 random turns of the input, computed by the operator."""
    random = np.random.default_rng(3)
    inputs = np.concatenate(
        [[0.0], random.uniform(5.0, 174.1, 75), [0.0, 174.1], random.uniform(0.0, 170.0, 75)]
    )
    made = prediction_for_inputs(TRUE, inputs, initial=initial)
    found = Observations.of_states(
        made.states, made.output, np.zeros(inputs.size, dtype=np.int64), (TRUE.lower, TRUE.upper), "mm"
    )
    return found if zero is None else replace(found, y=found.y + 0.7 * zero, zero=zero - 1)


def error(found):
    a, b = np.meshgrid(np.linspace(0, 174.1, 40), np.linspace(0, 174.1, 40), indexing="ij")
    return float(np.abs(found.y(a[a >= b], b[a >= b]) - TRUE.y(a[a >= b], b[a >= b])).max())


def test_the_surface_that_made_the_outputs_is_found():
    assert error(NEAR) > 0.5
    assert error(surface_through_states(rows(), NEAR)) < 1e-6


def test_another_zero_of_a_later_session_does_not_bend_it():
    later = (np.arange(len(rows())) >= 80).astype(np.int64)
    assert error(surface_through_states(rows(zero=later), NEAR)) < 1e-6


def test_an_output_that_falls_is_fitted_by_a_surface_that_falls():
    mirrored = replace(rows(), y=-rows().y)
    start = replace(NEAR, y_lower=-0.0, y_upper=-12.0)
    found = surface_through_states(mirrored, start)
    assert found is not None
    assert error(replace(found, y_lower=-found.y_lower, y_upper=-found.y_upper)) < 1e-6


@pytest.mark.parametrize(
    "unusable",
    [
        rows().where(np.arange(len(rows())) < 8),
        rows(initial="anhysteretic"),
        replace(rows(), y=rows().y * np.nan),
    ],
    ids=["fewer than parameters", "from a diagonal state", "no numbers"],
)
def test_what_cannot_be_fitted_gives_no_surface(unusable):
    assert surface_through_states(unusable, NEAR) is None


def test_a_surface_in_the_opposite_direction_is_none():
    assert surface_through_states(rows(), replace(NEAR, y_lower=0.0, y_upper=-12.0)) is None
