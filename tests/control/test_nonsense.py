"""Non-finite numbers and overflow: no theorem is applied to them, and no inequality is reported as
satisfied."""

import math
from typing import Any

import numpy as np
import pytest

from smarig.certificate.position_assumptions import supply_while_held
from smarig.certificate.position_supply_rate import SupplyRate
from smarig.certificate.velocity import inequalities, k_e, stability, violating_signal
from smarig.certificate.velocity.stability import sharp_bound
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.controllers.lead_lag import lead_lag
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface

GAIN = constant_gain(4.0)
SEEN = inequalities(GAIN, [1.0, -2.0], 0.1)


@pytest.mark.parametrize("controller", [GAIN, lead_lag(2.0, zero_s=4.0, pole_s=1.0)])
@pytest.mark.parametrize("dt_s", [math.nan, math.inf, -1.0, 0.0, "0.1"])
def test_signals_need_a_time_that_goes_on(controller, dt_s):
    with pytest.raises(UsageError, match="dt_s must be a"):
        inequalities(controller, [1.0, 2.0], dt_s)


@pytest.mark.parametrize("size", [1e200, 1e160])
def test_sums_that_overflow_decide_nothing(size):
    with pytest.raises(UsageError, match="overflow the computation"):
        inequalities(GAIN, [size, size], 0.1)


@pytest.mark.parametrize("ask", [SEEN.strictly_passive, SEEN.finite_gain])
@pytest.mark.parametrize("index", [math.nan, math.inf, "4"])
def test_an_index_that_is_no_number_is_no_index(ask, index):
    with pytest.raises(UsageError, match="must be a finite number"):
        ask(index)


def test_an_index_that_overflows_decides_nothing():
    with pytest.raises(UsageError, match="overflow the computation"):
        SEEN.finite_gain(1e200)
    with pytest.raises(UsageError, match="overflow the computation"):
        inequalities(GAIN, [1e3], 0.1).strictly_passive(1e305)


def test_a_gain_is_not_negative_and_an_index_may_be():
    with pytest.raises(UsageError, match="gamma must not be negative, got -4"):
        SEEN.finite_gain(-4.0)
    assert SEEN.strictly_passive(-4.0)
    assert SEEN.strictly_passive(4.0)
    assert not SEEN.strictly_passive(4.1)
    assert not SEEN.finite_gain(0.0)
    assert SEEN.finite_gain(4.0)


def test_an_index_is_delta_or_gamma():
    nonsense: Any = "foo"
    for ask in (lambda: violating_signal(GAIN, 0.1, nonsense), lambda: SEEN.violated_at(nonsense, 4.0)):
        with pytest.raises(UsageError, match="Unknown index 'foo'"):
            ask()
    assert violating_signal(GAIN, 0.1, "delta").size


@pytest.mark.parametrize("hold_s", [-1e6, math.nan, math.inf])
def test_no_supply_over_a_time_that_is_none(hold_s):
    with pytest.raises(UsageError, match="hold_s must"):
        supply_while_held(thesis_surface("two_c"), 60.0, hold_s, 0.1)


def test_no_supply_of_what_is_no_number():
    with pytest.raises(UsageError, match="u must be a finite number"):
        supply_while_held(thesis_surface("two_c"), math.nan, 1.0, 0.1)
    with pytest.raises(UsageError, match="b must be a finite number"):
        supply_while_held(thesis_surface("two_c"), 60.0, 1.0, math.nan)
    with pytest.raises(UsageError, match="The supply must be a finite number"):
        supply_while_held(thesis_surface("two_c"), 60.0, 1.0, 1e200)


@pytest.mark.parametrize(
    ("rate", "offset"), [(-1.0, 0.0), (0.0, -1.0), (math.nan, 0.0), ([0.0, math.nan], 0.0)]
)
def test_no_bound_from_what_is_no_norm(rate, offset):
    with pytest.raises(UsageError, match="A norm of the rate or of the offset is negative"):
        sharp_bound(GAIN, rate, offset)


def test_no_bound_where_the_stored_energy_is_not_decided():
    with pytest.raises(UsageError, match="could not be determined"):
        sharp_bound(GAIN, 1.0, 0.0, math.nan)
    assert sharp_bound(GAIN, 1.0, 0.0, math.inf) == np.inf


@pytest.mark.parametrize("name", ["a", "b", "c"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0])
def test_a_supply_rate_has_constants_from_0_on(name, value):
    with pytest.raises(UsageError, match=f"{name} must"):
        SupplyRate(**{name: value})


@pytest.mark.parametrize("gain", [5e-324, 1e308])
def test_a_bound_that_overflows_is_a_hypothesis_that_fails(gain):
    controller = constant_gain(gain)
    found = stability(thesis_surface("one_e"), controller)
    assert k_e(controller) == math.inf
    assert found.holds is False
    assert "k_e overflows with" in found.text
    assert stability(thesis_surface("one_e"), constant_gain(1e-300)).holds


@pytest.mark.parametrize("gain", ["3", None, math.nan, -1.0])
def test_a_gain_that_is_no_positive_number_is_refused(gain):
    with pytest.raises(UsageError, match="gain must be a"):
        constant_gain(gain)
