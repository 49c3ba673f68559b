"""A part of the output that is proportional to the input, against the transformation: no positive measure has it.

The wires are relays with noise; what is added is a line, as thermal expansion or the temperature coefficient of a
resistance would be.
"""

import numpy as np
import pytest

from smarig.replay import load_model
from smarig.study import study
from smarig.study.candidate_models import PROPORTIONAL_PART
from smarig.study.study_files import STUDY_MODEL
from smarig.study.study_options import StudyOptions
from smarig.study.study_sentences import proportional_sentence
from study.test_undetermined_states import path

pytestmark = pytest.mark.usefixtures("few_readings")
TURNS = (25, 95, 25, 95, 40, 90, 50, 85, 30, 95, 25, 80, 45, 95, 25, 95, 40, 90, 50, 80, 25)


def wire(u, seed):
    """Shares (n,) of 600 relays that are on."""
    rng = np.random.default_rng(seed)
    up = rng.normal(67, 5, 600)
    down = up - rng.gamma(6, 2.2, 600)
    on, y = np.zeros(600, dtype=bool), []
    for v in u:
        on = np.where(v > up, True, np.where(v < down, False, on))
        y.append(on.mean())
    return np.array(y)


def studied(folder, u, y, output, noise):
    file = folder / "loop.csv"
    noisy = y + noise * np.random.default_rng(1).standard_normal(u.size)
    rows = np.column_stack([0.5 * np.arange(u.size), u, noisy])
    np.savetxt(file, rows, delimiter=",", header=f"time_s,temperature_C,{output}", comments="", fmt="%.7f")
    return study([file], folder / "out", StudyOptions())


CASES = [
    pytest.param(-3.0, 0.006, "displacement_mm", "as thermal expansion would be", id="a wire that lengthens"),
    pytest.param(
        3.0, -0.009, "displacement_mm", "as thermal expansion would be", id="an actuator that moves up"
    ),
    pytest.param(
        -0.6,
        0.002,
        "resistance_ohm",
        "as the temperature coefficient of resistance would be",
        id="a resistance",
    ),
]


@pytest.mark.parametrize(
    ("slope", "unit", "compared"),
    [(0.0081, "%", False), (9e-4, "%", True), (9e-6, "mm/mm", True), (0.0081, "mm", True)],
)
def test_a_strain_is_compared_with_thermal_expansion_if_its_size_is(slope, unit, compared):
    assert ("thermal expansion" in proportional_sentence(slope, unit, "degC")) is compared


@pytest.mark.long("take ten seconds each", cases=("an actuator that moves up", "a resistance"))
@pytest.mark.parametrize(("stroke", "slope", "output", "words"), CASES)
def test_the_model_gets_it_and_predicts_better(tmp_path, stroke, slope, output, words):
    u = path(TURNS, rows=30)
    result = studied(tmp_path, u, stroke * wire(u, 4) + slope * u, output, 0.001 * abs(stroke))
    best, plain = result.evaluation.best, result.evaluation.plain
    assert best.name == PROPORTIONAL_PART
    assert best.rms < 0.5 * plain.rms
    said = result.sentences()[0]
    assert "A part of it is proportional to the input, about" in said
    assert words in said
    assert not any("goes back" in reason for reason in result.reasons)  # the model does so, too
    (fitted,) = load_model(tmp_path / "out" / STUDY_MODEL).measurement["amplitudes"]
    assert fitted == pytest.approx(slope, rel=0.35)  # a steeper one is balanced by more of the measure


@pytest.mark.long("takes seven seconds")
def test_a_wire_without_it_gets_none(tmp_path):
    u = path(TURNS, rows=30)
    result = studied(tmp_path, u, -3.0 * wire(u, 4), "displacement_mm", 0.003)
    assert result.evaluation.best.name == "positive measure"
    assert "proportional" not in " ".join(result.sentences())


@pytest.mark.long("takes ten seconds")
def test_one_with_the_sign_of_the_transformation_is_in_the_measure(tmp_path):
    u = path(TURNS, rows=30)
    result = studied(tmp_path, u, -3.0 * wire(u, 4) - 0.006 * u, "displacement_mm", 0.003)
    assert "proportional" not in " ".join(result.sentences())
