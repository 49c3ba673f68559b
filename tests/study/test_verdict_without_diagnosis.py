"""The verdict on a model is that of its errors: without a diagnosis, neighbouring readings tell their noise."""

from dataclasses import replace

import numpy as np
import pytest

from smarig.study import StudyOptions, study, study_result

pytestmark = pytest.mark.usefixtures("few_readings")
K = np.arange(1600)
U = 70 - 50 * np.cos(K * np.pi / 200)  # four full loops
LOOPS = 1 + np.tanh((U - 67 - 8 * np.sign(np.sin(K * np.pi / 200))) / 14)
NOISE_MM = 0.004


def studied(tmp_path, change, *, diagnose, every=1):
    """A study of a record whose last part has another stroke by a share ``change``."""
    y = np.where(K < 1000, 1.0, 1.0 + change) * LOOPS + NOISE_MM * np.random.default_rng(5).standard_normal(
        K.size
    )
    path = tmp_path / "wire.csv"
    rows = np.column_stack([0.5 * K, U, y])
    np.savetxt(path, rows[::every], delimiter=",", header="time_s,T_degC,stroke_mm", comments="", fmt="%.5f")
    return study([path], tmp_path / "out", StudyOptions(split="time", diagnose=diagnose))


@pytest.mark.parametrize(("change", "told"), [(0.0, False), (0.006, True), (0.02, True)])
def test_neighbouring_readings_tell_what_repeated_ones_do(tmp_path, monkeypatch, change, told):
    known = studied(tmp_path, change, diagnose=False)
    assert known.noise == pytest.approx(NOISE_MM, rel=0.2)
    monkeypatch.setattr(study_result, "noise_of_repeats", lambda runs: None)
    found = replace(known)
    assert found.verdict == known.verdict
    assert (found.noise is not None) == told
    if found.noise is not None:
        assert found.noise == pytest.approx(NOISE_MM, rel=0.5)


@pytest.mark.long("takes ten seconds")
def test_the_verdict_does_not_depend_on_the_diagnosis(tmp_path, monkeypatch):
    monkeypatch.setattr(study_result, "noise_of_repeats", lambda runs: None)
    found = studied(tmp_path, 0.02, diagnose=True)
    assert replace(found, diagnosis=None).verdict == found.verdict


def test_rows_far_apart_tell_no_noise(tmp_path, monkeypatch):
    monkeypatch.setattr(study_result, "noise_of_repeats", lambda runs: None)
    found = studied(tmp_path, 0.02, diagnose=False, every=25)
    assert found.noise is None
