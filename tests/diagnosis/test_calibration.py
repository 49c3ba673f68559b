"""p and the threshold of an alarm: those of wires without an effect, whatever the scale of the gains."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from smarig.diagnosis.critique.calibration import (
    CALIBRATED_P,
    EXCESS,
    LEAST_P,
    calibrated_p,
    calibrated_threshold,
)

from benchmarks.boxes import draw_box, write_box
from smarig.identification import identify
from smarig.record import load_run

NULLS = np.random.default_rng(5).gamma(2.0, 1.0, 400)


@pytest.mark.parametrize("alpha", [0.005, 0.02, 0.03, 0.1, 0.3])
def test_what_lies_at_the_threshold_has_p_alpha(alpha):
    assert calibrated_p(calibrated_threshold(alpha, NULLS), NULLS) == pytest.approx(alpha, rel=1e-6)


def test_p_falls_as_more_stands_out_and_stays_in_its_range():
    p = [calibrated_p(x, NULLS) for x in np.linspace(-20.0, 200.0, 300)]
    assert p[0] == 1.0
    assert p[-1] == pytest.approx(LEAST_P)
    assert np.all(np.diff(p) <= 0)
    assert list(EXCESS) == sorted(EXCESS)
    assert list(CALIBRATED_P) == sorted(CALIBRATED_P, reverse=True)


@pytest.mark.parametrize(("scale", "shift"), [(10.0, 0.0), (1.0, 7.0), (0.1, -3.0)])
def test_scale_and_shift_of_all_gains_change_nothing(scale, shift):
    for largest in (0.0, 2.0, 8.0, 20.0):
        moved = calibrated_p(scale * largest + shift, scale * NULLS + shift)
        assert moved == pytest.approx(calibrated_p(largest, NULLS))


def test_null_data_alone_would_give_more_alarms():
    """At 3 %: boxes without an effect exceed the 97 % point of null data in one of seven cases."""
    assert calibrated_threshold(0.03, NULLS) > 2 * np.quantile(NULLS, 0.97)
    assert 0.08 < calibrated_p(float(np.quantile(NULLS, 0.97)), NULLS) < 0.25


@pytest.mark.long("takes ten minutes")
def test_p_is_uniform_on_boxes_of_another_seed():
    from smarig.diagnosis import diagnose

    p = []
    for number in range(60):
        with tempfile.TemporaryDirectory() as folder:
            train = [load_run(run) for run in write_box(draw_box(93, number, hidden={}), Path(folder)).train]
            p.append(diagnose(identify(train, "positive").model, train, nulls=200).first.p_value)
    for share in (0.1, 0.25, 0.5, 0.75):
        assert np.mean(np.array(p) <= share) == pytest.approx(
            share, abs=3 * np.sqrt(share * (1 - share) / 60)
        )
