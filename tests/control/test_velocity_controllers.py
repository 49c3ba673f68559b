"""δ and γ of each sampled controller: both inequalities on any signal, tight to one per cent."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.measures import controllers, signals
from smarig.certificate.velocity import inequalities, violating_signal
from smarig.certificate.velocity.passivity_indices import response
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.controllers.lead_lag import lead_lag
from smarig.control.velocity.controllers.leaky_pi import leaky_pi
from smarig.control.velocity.controllers.saturating_gain import saturating_gain
from smarig.control.velocity.controllers.scheduled_gain import scheduled_gain
from smarig.core import catalogue
from smarig.core.errors import UsageError

DT_S = 0.1
LINEAR = {
    "lead": (lead_lag(20.0, 4.0, 1.0), lambda s: 20 * (1 + 4 * s) / (1 + s)),
    "lag": (lead_lag(20.0, 0.5, 2.0), lambda s: 20 * (1 + 0.5 * s) / (1 + 2 * s)),
    "leaky PI": (leaky_pi(20.0, 6.0, 0.1), lambda s: 20 + 6 / (s + 0.1)),
}
ALL = {name: made for name, (made, _) in LINEAR.items()} | {
    "constant": constant_gain(7.0),
    "saturating": saturating_gain(10.0, 60.0, 0.1),
    "scheduled": scheduled_gain(10.0, 60.0, lambda k: 60.0 if k % 7 < 3 else 10.0),
}


@given(controllers(), signals(), st.sampled_from([0.01, 0.1, 3.0]))
def test_both_inequalities_hold_at_every_time(controller, errors, dt_s):
    sums = inequalities(controller, errors[0], dt_s)
    assert sums.strictly_passive(controller.delta)
    assert sums.finite_gain(controller.gamma)


@pytest.mark.parametrize("dt_s", [0.02, 0.1, 5.0])
@pytest.mark.parametrize("name", ALL)
def test_a_signal_violates_one_per_cent_more(name: str, dt_s: float):
    controller = ALL[name]
    errors = violating_signal(controller, dt_s, "delta")
    control = response(controller, errors, dt_s)
    assert errors @ control < 1.01 * controller.delta * (errors @ errors)
    errors = violating_signal(controller, dt_s, "gamma")
    control = response(controller, errors, dt_s)
    assert np.linalg.norm(control) > controller.gamma / 1.01 * np.linalg.norm(errors)


@pytest.mark.parametrize("name", LINEAR)
def test_indices_are_those_of_the_sampled_frequency_response(name: str):
    """H on the unit circle, from the impulse response that runs; and H on the imaginary axis."""
    controller, transfer = LINEAR[name]
    impulse = response(controller, np.eye(1, 1 << 14)[0], DT_S)
    sampled, continuous = np.fft.rfft(impulse), transfer(1j * np.geomspace(1e-5, 1e5, 4001))
    for values in (sampled, continuous):
        assert values.real.min() == pytest.approx(controller.delta, rel=1e-6)
        assert np.abs(values).max() == pytest.approx(controller.gamma, rel=1e-6)


def test_the_sampled_controller_answers_slow_signals_like_the_continuous_one():
    controller, transfer = LINEAR["leaky PI"]
    t = DT_S * np.arange(4000)
    answer = response(controller, np.sin(0.3 * t), DT_S)
    steady = np.imag(transfer(0.3j) * np.exp(0.3j * t))
    assert np.abs(answer - steady)[2000:].max() < 0.002 * np.abs(steady).max()


def test_an_index_cannot_be_broken_at_itself():
    with pytest.raises(UsageError, match="above 1"):
        violating_signal(constant_gain(1.0), DT_S, "delta", by=1.0)


def test_the_catalogue_is_the_folder():
    package = "smarig.control.velocity.controllers"
    assert catalogue.catalogue_names(package) == [
        "constant_gain",
        "lead_lag",
        "leaky_pi",
        "saturating_gain",
        "scheduled_gain",
    ]
    assert all(catalogue.catalogue_summary(package, name) for name in catalogue.catalogue_names(package))


@pytest.mark.parametrize("gain", [0.0, -1.0, np.nan, np.inf])
def test_a_gain_that_is_not_positive_is_refused(gain: float):
    with pytest.raises(UsageError, match="positive number"):
        constant_gain(gain)
