"""Temperatures of one specimen at several rates: a lag moves those of heating and of cooling apart, or together."""

import json
import re

import numpy as np
import pytest

from smarig.study import StudyOptions, study_each
from smarig.study.temperatures_over_rates import rate_trend, readings_of
from study.known_data import csv_text

pytestmark = pytest.mark.usefixtures("drawings")
AT_ZERO = {"A_s": 51.0, "A_f": 63.0, "M_s": 44.0, "M_f": 31.0}


def cycles(rates, lag_min, shift=0.0):
    """Cycles of a study of heat flow, as JSON."""
    found = []
    for k, rate in enumerate(rates):
        figures = {}
        for name, value in AT_ZERO.items():
            at = value + (lag_min if name[0] == "A" else -lag_min) * rate + shift * k + 0.02 * (-1) ** k
            figures[name] = {"value": at, "ci95": [at - 0.1, at + 0.1], "unit": "degC"}
        found.append({"figures": figures, "rates_K_per_min": {"heating": rate, "cooling": rate}})
    return {"calorimetry": {"cycles": found}, "transformation": None}


def sentence(found):
    trend = rate_trend(readings_of(found, []))
    assert trend is not None
    return trend.sentence()


@pytest.mark.parametrize("lag_min", [0.25, -0.15])
def test_three_rates_give_the_temperatures_at_rate_zero_with_intervals(lag_min):
    text = sentence(cycles([4.0, 8.0, 8.1, 16.0], lag_min))
    late = "specimen that follows its thermometer" if lag_min > 0 else "thermometer that follows the specimen"
    assert f"{late} {60 * abs(lag_min):.0f}" in text
    assert "(4, 8.05, 16 K/min)" in text
    for name, value in AT_ZERO.items():
        low, high = text.split(f"{name} ")[-1].split("(")[1].split(")")[0].split(" to ")
        assert float(low) < value < float(high)


def test_two_rates_give_them_without_an_interval():
    text = sentence(cycles([3.0, 12.0], 0.2))
    assert "a third rate would give their intervals" in text


@pytest.mark.parametrize(
    ("rates", "lag", "shift"), [([8.0, 8.4], 0.2, 0), ([4.0, 9.0], 0.0, 2.0), ([4.0, 9.0], 0.0, 0)]
)
def test_one_rate_another_specimen_or_no_lag_says_nothing(rates, lag, shift):
    assert rate_trend(readings_of(cycles(rates, lag, shift), [])) is None


def test_files_of_a_folder_are_compared(tmp_path):
    folder = tmp_path / "data"
    folder.mkdir()
    for rate in (0.05, 0.4):
        way = np.arange(20, 100, 0.4)
        u = np.concatenate([way, way[::-1]] * 2)
        t = np.arange(u.size) * 0.4 / rate
        centre = np.where(np.gradient(u) > 0, 62.0, 48.0)
        late = np.where(np.gradient(u) > 0, 1, -1) * 10 * rate
        y = 3 * np.tanh((u - centre - late) / 4) + np.random.default_rng(1).normal(0, 0.005, u.size)
        (folder / f"{rate}.csv").write_text(csv_text(t, u, y), encoding="utf-8")
    study_each([folder], tmp_path / "out", StudyOptions(diagnose=False), workers=1)
    (text,) = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))["over_rates"].values()
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    assert "Transformation temperatures against the rate." in page
    row = page.split("0 (by the lines)")[1].split("</tr>")[0]
    for shown in re.findall(r"[AM]_[sf] (\d+\.?\d*)", text.split("rate zero: ")[1]):
        assert f"<b>{shown}</b>" in row
    late = float(text.split(" s late")[0].split()[-1])
    assert late == pytest.approx(10, abs=1)
