"""What `smarig transformation` says of the readings of a loop, a study says beside its temperatures."""

import numpy as np

from report.pages import Page
from smarig.study import StudyOptions, study
from study.known_data import csv_text
from transformation.known_loops import known_loop


def test_readings_that_are_missing_on_the_steep_part_are_said(tmp_path):
    loop = known_loop(5, kind="logistic", noise=0.001, drift=0.0)
    steep = np.abs(loop.u - (loop.truth["A_s"] + loop.truth["A_f"]) / 2) < 0.2 * loop.span
    kept = ~(steep & (np.arange(loop.u.size) < np.argmax(loop.u)))
    path = tmp_path / "loop.csv"
    path.write_text(csv_text(np.arange(kept.sum()) * 1.0, loop.u[kept], 100 * loop.y[kept]), encoding="utf-8")
    found = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    said = "of the output lies between two readings at"
    assert any(said in line for line in found.transformation.lines())
    page = Page((tmp_path / "out" / "index.html").read_text(encoding="utf-8")).visible
    assert said in page
    assert "As and Af would differ" in page  # with subscripts
