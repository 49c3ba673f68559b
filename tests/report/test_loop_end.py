"""The end of a held loop, on columns with a known answer, and its sentences."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.report.closed_loop.closed_loop_text import hold_end_text, offset_text, unsteady_text
from smarig.report.closed_loop.hold_end import hold_end

COUNT = 0.05
T = np.arange(1, 4001) * 0.1  # 400 s
NOISE = np.random.default_rng(5).normal(0.0, 0.5 * COUNT, T.size)
NOISE -= NOISE[T > 340.0].mean()
CURRENT = 0.4 + 0.1 * np.sin(T)


def ended(error, **more):
    return hold_end(T, error, CURRENT, COUNT, **more)


def test_count_noise_rests():
    end = ended(NOISE)
    assert end.seconds == pytest.approx(60.0)
    assert abs(end.mean) < 0.1 * COUNT
    assert end.std == pytest.approx(0.5 * COUNT, rel=0.1)
    assert end.verdict == "rests"
    assert unsteady_text(end, "mm") == ""


def test_a_loop_that_rests_elsewhere_is_reported_off_with_its_side():
    end = ended(NOISE - 13 * COUNT)
    assert end.verdict == "rests off"
    assert "The position settled 0.6" in unsteady_text(end, "mm")
    assert "13.0 counts) from the set-point" in unsteady_text(end, "mm")
    assert "(−13.0 counts), standard deviation" in hold_end_text(end, "mm")


@pytest.mark.parametrize(
    ("sign", "words"), [(1, "raises the current, from 0.9"), (-1, "lowers the current, from 0.8")]
)
def test_a_controller_that_is_still_at_work_has_not_settled(sign, words):
    end = hold_end(
        T, NOISE - 6 * COUNT, 0.85 + sign * 0.05 * (T - T[-1] + 60) / 60 + 0.001 * np.sin(T), COUNT
    )
    assert end.verdict == "rests off"
    assert unsteady_text(end, "mm").startswith("The position stands 0.3")
    assert "from the set-point while the controller still " + words[:11] in unsteady_text(end, "mm")


def test_a_limit_cycle_swings_whatever_its_phase_at_the_end():
    """Its last reading is near the set-point; its mean and spread are those of a sine of four counts."""
    wave = 4 * COUNT * np.sin(2 * np.pi * (T - T[-1]) / 12.0)
    assert wave[-1] == pytest.approx(0.0)
    end = ended(wave)
    assert end.verdict == "swings"
    assert end.std == pytest.approx(4 * COUNT / np.sqrt(2), rel=0.01)
    assert end.peak_to_peak == pytest.approx(8 * COUNT, rel=0.01)
    assert unsteady_text(end, "mm") == (
        "The position oscillates at the end of the hold: 0.4 mm (8.0 counts) peak to peak; "
        "the current is between 0.3 A and 0.5 A."
    )


def test_a_loop_that_creeps_does_not_swing():
    end = ended(NOISE + T / 60.0 * 6 * COUNT)
    assert end.verdict == "moves"
    assert "still moves" in unsteady_text(end, "mm")


def test_a_disturbance_is_no_end_and_too_little_after_it_is_no_verdict():
    pushed = NOISE + np.where(T < 390.0, 20 * COUNT, 0.0)
    assert ended(pushed).mean > 10 * COUNT
    after = ended(pushed, quiet_s=390.0)
    assert abs(after.mean) < COUNT
    assert after.seconds == pytest.approx(10.0)
    assert ended(NOISE + COUNT * 9, quiet_s=398.0).verdict == ""
    assert ended(NOISE, quiet_s=400.0) is None


def test_a_short_hold_is_evaluated_by_its_last_quarter():
    short = T <= 80.0
    early = np.where(T < 59.0, 30 * COUNT, 0.0)
    end = hold_end(T[short], early[short], CURRENT[short], COUNT)
    assert (end.mean, end.seconds) == (0.0, pytest.approx(20.0))


def test_without_a_count_there_is_no_verdict_and_without_readings_no_end():
    assert hold_end(T, NOISE + 1, CURRENT, 0.0).verdict == ""
    assert hold_end(T, np.full(T.size, np.nan), CURRENT, COUNT) is None
    gap = ended(np.where(T > 399.0, np.nan, NOISE))
    assert np.isfinite([gap.mean, gap.std, gap.peak_to_peak]).all()


def test_currents_are_reported_to_a_milliampere():
    end = replace(ended(NOISE), current_A=(-7.07e-4, 0.48123))
    assert hold_end_text(end, "mm").endswith("; current −0.001 to 0.481 A.")


def test_zero_has_no_sign():
    end = replace(ended(NOISE), mean=-1e-4 * COUNT)
    assert "mean error 0 mm (0.0 counts)," in hold_end_text(end, "mm")
    assert offset_text(-0.0, "mm", 0.0) == "0 mm"
    assert offset_text(0.3, "deg", 0.1) == "+0.3 deg (+3.0 counts)"
