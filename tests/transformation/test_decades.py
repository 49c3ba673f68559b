"""Transformation temperatures of an output over decades are those of its logarithm, and the text says so."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.report.transformation.tangent_figures import tangent_figure
from smarig.transformation import TEMPERATURES, transformation_temperatures
from transformation.known_loops import known_loop, run_of


def over_decades(seed, decades, quantity="resistance", unit="ohm"):
    """A known loop as the logarithm of an output, which falls or rises by some decades from about 10^4."""
    loop = known_loop(seed, noise=0.002)
    y = 10 ** (4 + decades * loop.y / np.ptp(loop.y))
    run = run_of(loop.u, y)
    meta = {**run.meta, "output": {"quantity": quantity, "unit": unit}}
    return loop, replace(run, meta=meta)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("decades", "quantity", "unit"), [(3.4, "resistance", "ohm"), (2.0, "resistivity", "ohm m")]
)
def test_the_temperatures_are_those_of_the_logarithm(seed, decades, quantity, unit):
    loop, run = over_decades(seed, decades, quantity, unit)
    (found,) = transformation_temperatures(run).runs
    for name in TEMPERATURES:
        assert found.means[name].value == pytest.approx(loop.truth[name], abs=0.12 * loop.span)
    assert found.unit_of("stroke") == "decade"
    assert abs(found.means["stroke"].value) == pytest.approx(decades, rel=0.3)
    assert any(f"The {quantity} spans" in note and "logarithm" in note for note in found.notes)
    assert "Logarithm" in str(tangent_figure(found).panels[0].layout["yaxis"])


@pytest.mark.parametrize(
    ("decades", "quantity", "unit"), [(1.0, "resistance", "ohm"), (3.0, "displacement", "mm")]
)
def test_other_outputs_stay_as_they_are(decades, quantity, unit):
    _, run = over_decades(1, decades, quantity, unit)
    (found,) = transformation_temperatures(run).runs
    assert found.unit_of("stroke") == unit
    assert not any("logarithm" in note for note in found.notes)
