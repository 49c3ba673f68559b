"""An interval that is only the rounding of its computation is none, and gives a value no digits."""

import math
from types import SimpleNamespace

import pytest

from smarig.core import NAN
from smarig.report.components.numbers import interval_text, to_uncertainty
from smarig.report.transformation.transformation_tables import _card


def run_with(value, low, high):
    """Figures of a run whose stroke has these ends."""
    return SimpleNamespace(
        means={"stroke": SimpleNamespace(value=value, ci95=(low, high))},
        unit_of=lambda _name: "mm",
        degC=lambda _value: None,
        record=SimpleNamespace(input_unit="K"),
        gaps=[],
    )


@pytest.mark.parametrize(
    ("ends", "value", "interval"),
    [
        ((0.0120000000000000002, 0.0120000000000000037), "0.012 mm", ""),
        ((0.012, 0.012), "0.012 mm", ""),
        ((0.0118, 0.0122), "0.01200 mm", "95 %: 0.01180 to 0.01220 mm"),
    ],
)
def test_a_card_shows_the_digits_of_the_interval(ends, value, interval):
    _, shown, below = _card(run_with(0.012, *ends), "stroke")
    assert (shown, below) == (value, interval)


def test_a_small_value_has_digits_as_far_as_its_interval():
    assert to_uncertainty(1e-9, 1e-11) == "1.000 × 10⁻⁹"
    assert interval_text(-1e-15, 1e-15) == "−1.0 × 10⁻¹⁵ to 1.0 × 10⁻¹⁵"
    assert interval_text(NAN, NAN) == interval_text(-math.inf, math.inf) == "– to –"
