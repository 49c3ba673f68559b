"""Outputs that are a function of the input, and outputs with a loop that is narrower than it seems."""

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from smarig.study.function_of_input import curve_through
from study.known_data import temperatures

FUNCTIONS = {
    "tanh": lambda u: 4 * np.tanh((u - 60) / 9),
    "polynomial": lambda u: 1e-5 * (u - 30) * (u - 70) * (u - 110) + 0.01 * u,
    "two values": lambda u: np.where(u < 62, 1.0, 5.0),
}
FIELD_CASES = [f"field_cases/memoryless_called_lag/flat_{k}.csv" for k in ("exact", "n0002")]


def play(u, half_width):
    state, out = u[0], []
    for value in u:
        state = min(max(state, value - half_width), value + half_width)
        out.append(state)
    return np.array(out)


def studied(folder, u, y, noise, more="", *, diagnose=True):
    """The study of a record with noise (mm), with the causes of errors looked for unless not to ``diagnose``."""
    path = folder / "data.csv"
    y = y + np.random.default_rng(2).normal(0, noise, u.size)
    rows = "\n".join(f"{k / 2:.1f},{a:.4f},{b:.6f}{more}" for k, (a, b) in enumerate(zip(u, y)))
    path.write_text(f"time (s),temperature [°C],stroke [mm]\n{rows}\n", encoding="utf-8")
    return study([path], folder / "out", StudyOptions(diagnose=diagnose))


@pytest.mark.long(
    "takes half a minute",
    cases=(
        "tanh-0.002",
        "tanh-0.02",
        "polynomial-0.0",
        "polynomial-0.002",
        "two values-0.0",
        "two values-0.002",
    ),
)
@pytest.mark.parametrize("noise", [0.0, 0.002, 0.02])
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_of_the_input_is_called_one_without_a_cause(tmp_path, name, noise):
    u = temperatures(3, 120)
    result = studied(tmp_path, u, FUNCTIONS[name](u), noise)
    assert result.sentences()[0] == "The output is a function of the input; these data show no hysteresis."
    assert result.diagnosis is None
    assert result.reasons == []
    assert result.function.rms < max(1.5 * noise, 0.005 * 8)
    plain = np.interp(u, result.function.u, result.function.y) - FUNCTIONS[name](u)
    assert np.median(np.abs(plain)) < max(2 * noise, 1e-3)
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    first = page[page.index("<main>") : page.index('id="section-2"')]
    assert "Drawn: measured, curve" in first


@pytest.mark.long("takes half a minute", cases=("5.0-0.0", "5.0-0.002", "5.0-0.02", "0.5-0.002"))
@pytest.mark.parametrize("noise", [0.0, 0.002, 0.02])
@pytest.mark.parametrize("half_width", [0.5, 5.0])
def test_a_loop_is_no_function(tmp_path, half_width, noise):
    """Also one of 1 K, whose open part is about twice the largest noise."""
    u = temperatures(3, 120)
    result = studied(tmp_path, u, FUNCTIONS["tanh"](play(u, half_width)), noise, diagnose=False)
    assert result.function is None
    assert "no hysteresis" not in result.sentences()[0]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("cycles", [1, 3])
def test_an_output_that_also_drifts_is_no_function(tmp_path, cycles):
    u = temperatures(cycles, 300)
    result = studied(tmp_path, u, FUNCTIONS["tanh"](u) + np.linspace(0, 2, u.size), 0.002, diagnose=False)
    assert result.function is None


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("file", FIELD_CASES)
def test_the_field_cases_have_no_cause(shared_data, file, tmp_path):
    if not (shared_data / file).is_file():
        pytest.skip(f"{file} is not in {shared_data}")
    result = study([shared_data / file], tmp_path / "out", StudyOptions())
    assert result.function is not None
    assert result.diagnosis is None


@pytest.mark.parametrize("count", [5, 40])
def test_the_curve_reaches_the_ends_of_a_steep_function(count):
    """The mean of the outermost interval is not the value at its end, where a hold has most of the readings."""
    u = np.concatenate([np.full(60, 22.0), np.linspace(22, 88, 400)])
    curve = curve_through(u, -3 * u, count)
    np.testing.assert_allclose(np.interp(u, *curve), -3 * u, atol=1e-9)


def heated_at_two_rates(rates=(0.5, 2.0, 4.0)):
    """Times (s) and temperatures of a triangle at each rate (K/s) with a hold at both ends."""
    u = [np.full(40, 20.0)]
    for rate in rates:
        steps = int(90 / rate)
        u += [np.linspace(20, 110, steps), np.full(60, 110.0), np.linspace(110, 20, steps), np.full(60, 20.0)]
    return np.concatenate(u)


def late(u, lag):
    v = [u[0]]
    for a in u[1:]:
        v.append(v[-1] + (a - v[-1]) * (1 - np.exp(-1 / lag)))
    return np.array(v)


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("lag", [6.0, 9.0])
def test_a_function_of_a_late_input_shows_no_hysteresis_but_the_lag(tmp_path, lag):
    u = heated_at_two_rates()
    v = late(u, 2 * lag)  # half a second between the rows
    result = studied(tmp_path, u, 0.02 * v + 5e-5 * v**2, 0.002)
    assert "these data show no hysteresis" in result.sentences()[0]
    low, high = result.function.lag_ci95
    assert low < lag < high
    assert high - low < 0.2 * lag + 1


def test_a_loop_that_is_late_keeps_its_hysteresis(tmp_path):
    u = heated_at_two_rates()
    v = late(u, 12)
    result = studied(tmp_path, u, 4 * np.tanh((play(v, 8.0) - 60) / 15), 0.01, diagnose=False)
    assert result.function is None


@pytest.mark.long("takes four seconds")
def test_a_wide_loop_beside_a_late_thermometer_is_no_function(tmp_path):
    """The lag that would make a curve of the fitted part is so long that nothing of the held-out part has settled."""
    ends = [25, 105, 25, 105, 25, 105, 60, 90, 40]
    rates = [0.25, 0.25, 0.075, 0.075, *[0.125] * 4]
    legs = [np.linspace(a, b, int(abs(b - a) / r)) for a, b, r in zip(ends, ends[1:], rates)]
    u = np.concatenate([np.full(20, 25.0), *legs])
    wire = 3 / (1 + np.exp(-(play(u, 20.0) - 65) / 3))
    result = studied(tmp_path, late(u, 14), wire, 0.004, diagnose=False)
    assert result.function is None
