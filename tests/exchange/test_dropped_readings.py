"""A thermometer that drops out reads exactly 0 in the unit of the file, whatever that is in °C."""

import numpy as np
import pytest

from smarig.study import StudyOptions, study
from study.known_data import displacements, temperatures

U = temperatures(2, 200)
X = displacements(U, noise=0.003)
LOST = [30, 31, 32, 33, 34, 35, 90, 91, 300]
WRITTEN = {"K": U + 273.15, "°F": 32 + 1.8 * U, "°C": U, "": U + 273.15}


def written(tmp_path, unit, rows=LOST):
    u = WRITTEN[unit].copy()
    u[rows] = 0
    path = tmp_path / "cycles.csv"
    lines = [f"{k * 2},{a:.3f},{x:.5f}" for k, (a, x) in enumerate(zip(u, X))]
    path.write_text(
        "\n".join([f"Time [s],Temperature [{unit}],Stroke [mm]".replace(" []", ""), *lines]) + "\n"
    )
    return path


def found(tmp_path, unit, rows=LOST):
    result = study([written(tmp_path, unit, rows)], tmp_path / "out", StudyOptions(diagnose=False))
    return result, " ".join(result.tables[0].warnings)


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("unit", ["K", "°F", ""])
def test_drop_outs_are_masked_and_counted_in_the_unit_of_the_file(tmp_path, unit):
    result, texts = found(tmp_path, unit)
    shown = {"°F": "degF", "": "K"}.get(unit, unit)
    assert (
        f"reads exactly 0 {shown} in {len(LOST)} rows, far from the rows around them (first: line 32)"
        in texts
    )
    assert "clipped" not in texts
    read = result.tables[0].run["temperature_degC"]
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(read)), LOST)
    np.testing.assert_allclose(np.delete(read, LOST), np.delete(U, LOST), atol=0.01)


def test_in_degrees_celsius_the_zeros_stay_for_whatever_reads_the_run(tmp_path):
    result, texts = found(tmp_path, "°C")
    assert "They are masked" not in texts
    assert f"The input reads exactly 0 degC in {len(LOST)} rows" in texts
    assert (result.tables[0].run["temperature_degC"][LOST] == 0).all()


def test_a_temperature_that_passes_zero_drops_nowhere(tmp_path):
    u = np.round(3 * (U - 60))  # °F, through 0
    path = tmp_path / "cold.csv"
    lines = [f"{k * 2},{a:.0f},{x:.5f}" for k, (a, x) in enumerate(zip(u, X))]
    path.write_text("\n".join(["Time [s],Temperature [°F],Stroke [mm]", *lines]) + "\n")
    result = study([path], tmp_path / "out", StudyOptions(diagnose=False))
    assert (u == 0).any()
    assert np.isfinite(result.tables[0].run["temperature_degC"]).all()
