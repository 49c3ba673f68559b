"""Stress over strain: the load is the input where it leads the strain, which no output of a hysteresis does."""

import numpy as np
import pytest

from smarig.study import study
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

STRAIN = 3 - 3 * np.cos(np.linspace(0, 12, 240))
RAMP = np.interp(np.arange(240), [0, 60, 120, 180, 240], [0, 6, 0, 6, 0])


def file_of(tmp_path, strain, names, *, ahead=0.4, noise=0.0):
    stress = 200 * np.tanh(strain / 2 + np.where(np.gradient(strain) > 0, ahead, -ahead)) + 20 * strain
    read = strain + noise * np.random.default_rng(3).standard_normal(strain.size)
    path = tmp_path / "pull.csv"
    rows = (f"{0.5 * k},{e:.6f},{s:.3f}" for k, (e, s) in enumerate(zip(read, stress)))
    path.write_text("\n".join([names, *rows]) + "\n")
    return path


NAMES = ["Time (s),Strain (%),Stress (MPa)", "Time (s),Extension (mm),Force (N)"]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize(("strain", "noise"), [(STRAIN, 0.0), (RAMP, 0.0), (RAMP, 0.01)])
def test_a_load_that_leads_is_the_input_and_no_swap_is_offered(tmp_path, names, strain, noise):
    path = file_of(tmp_path, strain, names, noise=noise)
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    (guess,) = result.understood.guesses
    length, load = names.split(",")[1:]
    assert (guess.first("input").name, guess.first("output").name) == (load, length)
    assert "--input" not in " ".join(role.reason for role in guess.roles.values())
    ramped = f"although the machine ramps '{length}'"
    (hint,) = [text for text in result.hints() if "counts as the input" in text]
    assert (ramped in hint) == (strain is RAMP) or noise
    assert not any("leads its input" in reason for reason in result.reasons)


@pytest.mark.parametrize("names", NAMES)
def test_the_swap_is_offered_where_the_load_does_not_lead(tmp_path, names):
    (guess,) = understand([file_of(tmp_path, STRAIN, names, ahead=-0.4)], StudyOptions()).guesses
    length, load = names.split(",")[1:]
    assert f"--input '{length}' --output '{load}'" in guess.roles[length].reason


@pytest.mark.parametrize("ahead", [0.0, -0.3])
def test_a_strain_in_equal_steps_is_the_input_where_a_model_can_follow(tmp_path, ahead):
    (guess,) = understand([file_of(tmp_path, RAMP, NAMES[0], ahead=ahead)], StudyOptions()).guesses
    assert (guess.first("input").name, guess.first("output").name) == ("Strain (%)", "Stress (MPa)")
    assert "the test is controlled by strain" in guess.roles["Stress (MPa)"].reason
