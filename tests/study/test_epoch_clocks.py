"""A clock without a unit that counts from 1970 counts the parts of a second in which its times are dates."""

import numpy as np
import pytest

from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

U = 70 - 50 * np.cos(np.linspace(0, 12, 120))


@pytest.mark.parametrize(("parts", "unit"), [(1, "s"), (10**3, "ms"), (10**6, "us"), (10**9, "ns")])
def test_rows_half_a_second_apart_are_so_in_the_run(tmp_path, parts, unit):
    rows = (
        f"{1_700_000_000 * parts + k * parts // 2},{u:.3f},{np.tanh((u - 70) / 9):.4f}"
        for k, u in enumerate(U)
    )
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["timestamp,T (degC),stroke (mm)", *rows]) + "\n")
    (guess,) = understand([path], StudyOptions()).guesses
    assert guess.first("time").unit == unit
    (table,), _ = import_tables([guess], tmp_path / "out", None, "a")
    assert np.ptp(table.run["t_s"]) == pytest.approx(59, abs=1)
