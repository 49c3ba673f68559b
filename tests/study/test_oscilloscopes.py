"""Oscilloscopes state the units of their axes in a preamble; channels that nothing tells apart are one question."""

import numpy as np
import pytest

from smarig.exchange import find_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import UnsureError, understand

PHASE = np.linspace(0, 6 * np.pi, 300)
H = np.sin(PHASE)
B = np.tanh(2 * (H - 0.3 * np.cos(PHASE)))
PREAMBLE = ["Model,TDS2024C", "Sample Interval,0.01", "Horizontal Units,s", "Horizontal Scale,0.5"]


def file_of(tmp_path, channels, units="Vertical Units,V"):
    names = ",".join(["TIME", *(f"CH{k}" for k in range(1, len(channels) + 1))])
    rows = (",".join(f"{x:.5f}" for x in (0.01 * k, *(c[k] for c in channels))) for k in range(300))
    path = tmp_path / "scope.csv"
    path.write_text("\n".join([*PREAMBLE, units, names, *rows]) + "\n")
    return path


@pytest.mark.parametrize("units", ["Vertical Units,V", "Vertical Units,V,V"])
def test_each_axis_has_its_unit(tmp_path, units):
    path = file_of(tmp_path, [H, B], units)
    (table,) = find_tables(path)
    assert [c.unit for c in table.columns] == ["s", "V", "V"]
    (guess,) = understand([path], StudyOptions()).guesses
    roles = [guess.first(role).name for role in ("time", "input", "output")]
    assert roles == ["TIME", "CH1", "CH2"]


def test_keys_with_values_are_no_rows_left_out(tmp_path):
    path = file_of(
        tmp_path, [H, B], "Vertical Offset,0,0\nVertical Scale,1,1\nVertical Position,0,0\n\nUnits,V"
    )
    assert not understand([path], StudyOptions(accept=True)).left_out


def test_channels_that_nothing_tells_apart_are_one_question_with_its_answers(tmp_path):
    path = file_of(tmp_path, [H, B, 0.5 * B + 0.1 * H**2])
    with pytest.raises(UnsureError) as question:
        understand([path], StudyOptions())
    for output in ("CH2", "CH3"):
        assert f"smarig study {path} --input CH1 --output {output} -o scope" in str(question.value)
        (guess,) = understand([path], StudyOptions(input="CH1", output=output)).guesses
        assert not guess.doubts
