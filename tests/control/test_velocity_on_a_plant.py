"""Velocity feedback as a protocol on the full twin: the theorem's loop where it can be, honest where not."""

import numpy as np
import pytest

from control.driven import drive
from smarig.certify.velocity import velocity_feedback, velocity_loop
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.core.command import Drive, Hold, Mark
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import surface
from smarig.protocols._setup import Setup
from smarig.rig.twin import Twin

RATE = 0.6 * np.sin(np.arange(600) / 30)
GENTLE = constant_gain(30.0)


def outcome(rig: str, *args, noise: bool = False, **more):
    return drive(velocity_feedback(Setup.of(rig), *args, **more), Twin.named(rig, seed=1, noise=noise))


def test_gentle_feedback_on_the_twin_is_the_loop_with_its_lag():
    setup = Setup.of("two_wire_twin")
    ran = outcome("two_wire_twin", GENTLE, RATE.tolist(), model=surface("two_e"))
    loop = velocity_loop(
        surface("two_e"), GENTLE, RATE, dt_s=setup.period_s, initial="anhysteretic", lag_s=setup.tau_s
    )
    assert np.ptp(ran.position) > 0.5
    assert ran.ratio == pytest.approx(loop.final_ratio, rel=0.05)
    assert ran.ratio <= ran.k_e
    assert ran.clipped_share == 0.0


def test_the_ratio_is_that_of_its_signals():
    ran = outcome("two_wire_twin", GENTLE, RATE.tolist(), 5.0)
    driven = np.linalg.norm(RATE) + np.linalg.norm(np.full(RATE.size, 5.0))
    assert ran.ratio == pytest.approx(np.linalg.norm(RATE - ran.velocity) / driven)
    assert ran.commanded_K[0] == pytest.approx(30.0 * RATE[0] + 5.0), "u = ũ + u_o from the first tick"


def test_the_result_lists_the_hypotheses_that_the_rig_violates():
    hot = outcome("one_wire_twin", constant_gain(3000.0), [0.1] * 100 + [-0.1] * 100, model=surface("one_e"))
    failing = [h.name for h in hot.hypotheses if not h.holds]
    assert failing == ["input as asked for", "no delay", "velocity as it is"]
    assert hot.clipped_share > 0.2
    assert hot.applied_K.min() >= 0.0
    assert "cooling no faster" in hot.text
    assert "not for this rig" in hot.text
    assert "no model was given" in outcome("one_wire_twin", GENTLE, [0.1]).text


def test_noise_alone_takes_the_ratio_beyond_the_bound():
    quiet, noisy = (
        outcome("one_wire_twin", constant_gain(3000.0), [0.001] * 400, noise=noise) for noise in (False, True)
    )
    assert quiet.ratio <= quiet.k_e < noisy.ratio


def test_it_records_its_result_and_initialises_first_if_requested():
    setup = Setup.of("two_wire_twin")
    commands = velocity_feedback(setup, GENTLE, [0.1], initialise="planned")
    first = [next(commands), commands.send(None)]
    assert isinstance(first[0], Mark)
    assert isinstance(first[1], Hold)
    yielded = []
    drive(velocity_feedback(setup, GENTLE, [0.1, 0.1]), Twin.named("two_wire_twin"), yielded)
    assert [type(c) for c in yielded] == [Mark, Drive, Drive, Mark]
    assert yielded[-1].data["k_e"] == 2.0


@pytest.mark.parametrize("rate", [[], [np.nan]])
def test_a_reference_that_is_none_is_refused(rate):
    with pytest.raises(UsageError, match="finite rate"):
        next(velocity_feedback(Setup.of("one_wire_twin"), GENTLE, rate))
