"""A record in one direction shows no loop, however noisy its input is: that is no function of the input either."""

import numpy as np
import pytest

from smarig.study import StudyOptions, study


@pytest.mark.long("one of each kind", one_of_each=True)
@pytest.mark.parametrize("noise_K", [0.0, 0.15])
@pytest.mark.parametrize("falls", [False, True])
def test_a_branch_alone_is_told_as_one_way(tmp_path, noise_K, falls):
    rng = np.random.default_rng(6)
    u = np.concatenate([np.full(400, 30.0), np.linspace(30, 110, 900)])
    u = 140 - u if falls else u
    x = 3 - 2.5 / (1 + np.exp(-(u - 72) / 4)) + rng.normal(0, 0.01, u.size)
    u = u + rng.normal(0, noise_K, u.size)
    lines = [f"{k},{a:.2f},{b:.4f}" for k, (a, b) in enumerate(zip(u, x))]
    (tmp_path / "a.csv").write_text("time [s],wire [degC],stroke [mm]\n" + "\n".join(lines) + "\n")
    result = study([tmp_path / "a.csv"], tmp_path / "out", StudyOptions(diagnose=False))
    assert result.function is None
    assert result.verdict == "fair"
    assert "no loop to judge it by" in result.sentences()[0]
    assert any("goes one way only" in reason for reason in result.reasons)
    assert "no hysteresis" not in " ".join(result.sentences())
