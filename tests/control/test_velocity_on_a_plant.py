"""Velocity feedback as a protocol on the full twin: satisfied hypotheses of the theorem, and a list of
violated ones."""

import numpy as np
import pytest

from control.driven import drive
from smarig.app.velocity_loop import velocity_factory
from smarig.certificate.certify_hysteresis import certificate
from smarig.certificate.rig_assessment import RigAssessment
from smarig.certificate.velocity import k_e, velocity_loop
from smarig.control.tracking import Reference
from smarig.control.velocity.controllers.constant_gain import constant_gain
from smarig.control.velocity.velocity_protocol import (
    reference_rates,
    running_ratio,
    velocity_feedback,
    with_lead_in,
)
from smarig.core.command import Drive, Hold, Mark
from smarig.core.errors import UsageError
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.protocols._setup import Setup
from smarig.rig.twin import Twin

RATE = 0.6 * np.sin(np.arange(600) / 30)
GENTLE = constant_gain(30.0)


def measured(rig: str, *args, noise: bool = False, **more):
    return drive(velocity_feedback(Setup.of(rig), *args, **more), Twin.named(rig, seed=1, noise=noise))


def assessed(rig: str, model: str, gain: float) -> RigAssessment:
    (proved,) = certificate(thesis_surface(model), {"constant_gain": {"gain": gain}}).controllers
    return RigAssessment(proved, Setup.of(rig), 1.0)


def test_gentle_feedback_on_the_twin_is_the_loop_with_its_lag():
    setup = Setup.of("two_wire_twin")
    ran = measured("two_wire_twin", GENTLE, RATE.tolist())
    loop = velocity_loop(
        thesis_surface("two_e"), GENTLE, RATE, dt_s=setup.period_s, initial="anhysteretic", lag_s=setup.tau_s
    )
    assert np.ptp(ran.position) > 0.5
    assert ran.ratio == pytest.approx(loop.final_ratio, rel=0.05)
    assert ran.ratio <= k_e(GENTLE)
    assert ran.clipped_share == 0.0


def test_the_ratios_are_those_of_its_signals():
    ran = measured("two_wire_twin", GENTLE, RATE.tolist(), 5.0)
    error, rate = np.linalg.norm(RATE - ran.velocity), np.linalg.norm(RATE)
    offset = np.linalg.norm(np.full(RATE.size, 5.0))
    assert ran.ratio == pytest.approx(error / (rate + offset))
    assert ran.rest_ratio == pytest.approx(rate / (rate + offset))
    assert ran.bound_share == pytest.approx(30.0 * error / (60.0 * rate + offset))
    assert running_ratio(ran.rate, ran.velocity, ran.offset)[-1] == pytest.approx(ran.ratio)
    assert ran.commanded_K[0] == pytest.approx(30.0 * RATE[0] + 5.0), "u = ũ + u_o from the first tick"


def test_the_assessment_lists_the_hypotheses_that_the_rig_violates():
    hot = measured("one_wire_twin", constant_gain(3000.0), [0.1] * 100 + [-0.1] * 100)
    assessment = assessed("one_wire_twin", "one_e", 3000.0)
    failing = [h.name for h in assessment.hypotheses(hot.clipped_share) if not h.holds]
    assert failing == ["input as commanded", "no delay", "exact velocity"]
    assert hot.clipped_share > 0.2
    assert hot.applied_K.min() >= 0.0
    (clipped,) = [h for h in assessment.hypotheses(hot.clipped_share) if h.name == "input as commanded"]
    assert "cooling no faster" in clipped.why
    assert f"{100 * hot.clipped_share:.1f} %" in clipped.why
    assert [h.holds for h in assessment.hypotheses(0.0) if h.name == clipped.name] == [True]
    assert [h.holds for h in assessment.hypotheses(None) if h.name == clipped.name] == [None]


@pytest.mark.long("takes three seconds")
def test_a_model_that_thm_8_2_does_not_cover_has_no_k_e():
    plain = assessed("two_wire_twin", "two_p", 30.0).to_json(0.0)
    assert plain["k_e"] is None
    assert plain["coverage"] == "not covered: passive, output follows input fail"
    holds = {h["name"]: h["holds"] for h in plain["hypotheses"]}
    assert holds["supply rate at the current"] is False, (
        "the lag only adds where the output follows the input"
    )
    assert assessed("two_wire_twin", "two_e", 30.0).to_json(0.0)["k_e"] == 2.0


def test_noise_alone_takes_the_ratio_beyond_the_bound():
    law = constant_gain(3000.0)
    quiet, noisy = (measured("one_wire_twin", law, [0.001] * 400, noise=noise) for noise in (False, True))
    assert quiet.ratio <= k_e(law) < noisy.ratio


@pytest.mark.long("takes two seconds")
def test_it_records_its_result_and_initialises_first_if_requested():
    setup = Setup.of("two_wire_twin")
    commands = velocity_feedback(setup, GENTLE, [0.1], initialise="planned")
    first = [next(commands), commands.send(None)]
    assert isinstance(first[0], Mark)
    assert isinstance(first[1], Hold)
    yielded = []
    assessment = assessed("two_wire_twin", "two_e", 30.0)
    drive(
        velocity_feedback(setup, GENTLE, [0.1, 0.1], assess=assessment.to_json),
        Twin.named("two_wire_twin"),
        yielded,
    )
    assert [type(c) for c in yielded] == [Mark, Drive, Drive, Mark]
    assert "ratio" not in yielded[0].data, "nothing is measured at the beginning"
    assert yielded[0].data["k_e"] == yielded[-1].data["k_e"] == 2.0
    assert yielded[-1].data["clipped_share"] == 0.0


@pytest.mark.parametrize("rate", [[], [np.nan]])
def test_a_reference_that_is_none_is_refused(rate):
    with pytest.raises(UsageError, match="finite rate"):
        next(velocity_feedback(Setup.of("one_wire_twin"), GENTLE, rate))


def test_a_filter_from_the_future_is_refused():
    with pytest.raises(UsageError, match="filter_s must not be negative"):
        next(velocity_feedback(Setup.of("one_wire_twin"), GENTLE, [0.1], filter_s=-1.0))


def test_rates_are_what_the_reference_moves_in_each_tick():
    wanted = with_lead_in(Reference("r", (0.0, 10.0), (4.0, 5.0)))
    rates = reference_rates(wanted, 0.1)
    assert wanted.duration_s == 30.0
    assert rates == pytest.approx([0.2] * 200 + [0.1] * 100)
    at_rest = Reference("r", (0.0, 10.0), (0.0, 5.0))
    assert with_lead_in(at_rest) is at_rest, "it begins where the encoder is"


def test_every_loop_of_a_factory_starts_from_rest():
    """A preview must leave no memory in the controller of the run."""
    from control.model_files import model_of

    setup = Setup.of("one_wire_twin")
    wanted = Reference("r", (0.0, 3.0), (0.0, 1.0))
    numbers = {"gain": 100.0, "integral_per_s": 30.0, "leak_per_s": 0.1}
    make = velocity_factory(model_of("one_e"), setup, "leaky_pi", numbers, wanted)
    once, again = ([c for c in _driven(make(setup)) if isinstance(c, Drive)] for _ in range(2))
    assert once == again
    assert max(c.current_A for c in once) > 0.1


def _driven(protocol):
    """The commands of a protocol on a noise-free twin without holds: the initialisation gets empty results."""
    yielded = []
    drive(protocol, Twin.named("one_wire_twin", noise=False), yielded)
    return yielded
