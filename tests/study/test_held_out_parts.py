"""A verdict covers every branch of the held-out data, and says where the model fails and what it does not predict."""

from types import SimpleNamespace

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from smarig.study.held_out_parts import branch_errors, unpredicted_share, worst_place
from study.known_data import csv_text, displacements

QUICK = StudyOptions(diagnose=False)


def _verified(u, measured, predicted):
    counted = np.isfinite(predicted)
    return SimpleNamespace(run="a", input=u, measured=measured, predicted=predicted, counted=counted)


def test_a_branch_passed_quickly_counts_as_much_as_a_slow_one():
    u = np.concatenate([np.linspace(100, 0, 1000), np.linspace(0, 100, 50)])
    measured = u / 100
    predicted = measured.copy()
    predicted[1020:] += 0.5  # the last 60 % of the fast branch
    heating, cooling = branch_errors([_verified(u, measured, predicted)])
    assert (heating.direction, cooling.direction) == (1, -1)
    assert heating.rms == pytest.approx(0.5 * np.sqrt(0.6), rel=0.1), (
        "7 % of the rows, but 60 % of the branch"
    )
    assert cooling.rms < 1e-3
    place = worst_place([heating, cooling])
    assert place.worst == pytest.approx(0.5, rel=0.1)
    assert (place.start, place.end) == (pytest.approx(40, abs=9), pytest.approx(100))


def test_points_without_a_prediction_are_counted():
    u = np.linspace(0, 1, 100)
    predicted = np.where(u < 0.25, np.nan, u)
    assert unpredicted_share([_verified(u, u, predicted)]) == pytest.approx(0.25)


def test_a_quick_branch_that_goes_wrong_is_excepted_from_the_verdict(tmp_path):
    """A slow cooling and a quick heating, whose end lies off: it does not close."""
    u = np.concatenate([np.linspace(120, 25, 400), np.linspace(25, 120, 60)])
    x = displacements(u)
    x[-8:] += 1.0
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, x), encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.nrmse < 0.03, "on average it is good"
    assert result.verdict == "fair"
    assert "fair, except on the heating branch" in result.sentences()[0]
    assert any(s.startswith("The error is largest on the heating branch") for s in result.reasons)


def test_a_record_with_an_unknown_beginning_is_not_judged_as_a_whole(tmp_path):
    u = 70 - 45 * np.cos(np.linspace(np.pi / 2, 2.5 * np.pi, 240))  # from the middle, through one loop
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(u.size) * 0.5, u, displacements(u)), encoding="utf-8")
    result = study([path], tmp_path / "out", QUICK)
    assert result.unpredicted > 0.1
    assert result.verdict != "good"
    assert "nothing of the rest" in result.sentences()[0]
    assert "without a prediction" in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
