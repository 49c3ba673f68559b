"""Stress over strain: the roles and their reason are stated; a strain in equal steps was set: it is the input."""

import numpy as np
import pytest

from smarig.study.mapping_draft import mapping_draft
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

STRAIN = 3 - 3 * np.cos(np.linspace(0, 12, 240))
RAMP = np.interp(np.arange(240), [0, 60, 120, 180, 240], [0, 6, 0, 6, 0])


def guess_of(tmp_path, strain, names="Time (s),Strain (%),Stress (MPa)"):
    lag = np.where(np.gradient(strain) > 0, 0.4, -0.4)
    stress = 200 * np.tanh(strain / 2 + lag) + 20 * strain
    path = tmp_path / "pull.csv"
    rows = (f"{0.5 * k},{e:.6f},{s:.3f}" for k, (e, s) in enumerate(zip(strain, stress)))
    path.write_text("\n".join([names, *rows]) + "\n")
    (guess,) = understand([path], StudyOptions()).guesses
    return guess


@pytest.mark.parametrize("names", ["Time (s),Strain (%),Stress (MPa)", "Time (s),Extension (mm),Force (N)"])
def test_a_load_is_the_input_and_the_other_way_round_is_stated(tmp_path, names):
    guess = guess_of(tmp_path, STRAIN, names)
    length, load = names.split(",")[1:]
    assert (guess.first("input").name, guess.first("output").name) == (load, length)
    assert f"--input '{length}' --output '{load}'" in guess.roles[length].reason
    assert "the other way round" in mapping_draft(guess, "m")


def test_a_strain_in_equal_steps_is_the_input(tmp_path):
    guess = guess_of(tmp_path, RAMP)
    assert (guess.first("input").name, guess.first("output").name) == ("Strain (%)", "Stress (MPa)")
    assert "the test is controlled by strain" in guess.roles["Stress (MPa)"].reason
