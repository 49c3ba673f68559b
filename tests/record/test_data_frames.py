"""Runs as data frames and data sets: every known column over time, with units."""

import importlib

import numpy as np
import pytest

from report.pages import run_of
from smarig.core import UsageError

COLUMNS = {"t_s": [0.0, 0.1, 0.3], "current_A": [0.0, 1.0, np.nan], "position": [1.0, 2.0, 3.0]}
META = {"output": {"unit": "mm"}, "input": {"unit": "K"}, "rig": "one_wire_twin", "wire": "w"}


def test_a_frame_has_the_known_columns_over_time():
    pytest.importorskip("pandas")
    frame = run_of(COLUMNS, **META).to_pandas()
    assert frame.index.name == "t_s"
    assert frame.index.tolist() == COLUMNS["t_s"]
    np.testing.assert_array_equal(frame["current_A"], COLUMNS["current_A"])
    assert "voltage_V" not in frame
    assert (frame.attrs["output_unit"], frame.attrs["rig"]) == ("mm", "one_wire_twin")


def test_a_run_without_time_has_its_ticks_as_index():
    pytest.importorskip("pandas")
    frame = run_of({"position": [5.0, 6.0]}, **META).to_pandas()
    assert frame.index.name == "tick"
    assert frame["position"].tolist() == [5.0, 6.0]


@pytest.mark.long("takes two seconds")
def test_a_data_set_has_units():
    pytest.importorskip("xarray")
    data = run_of(COLUMNS, **META).to_xarray()
    assert data["position"].attrs["units"] == "mm"
    np.testing.assert_array_equal(data["position"].sel(t_s=0.1), 2.0)


@pytest.mark.parametrize(("method", "library"), [("to_pandas", "pandas"), ("to_xarray", "xarray")])
def test_without_the_library_it_says_what_to_install(monkeypatch, method, library):
    real = importlib.import_module

    def missing(name, *more):
        if name == library:
            raise ImportError(name)
        return real(name, *more)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(UsageError, match=f"pip install {library}"):
        getattr(run_of(COLUMNS, **META), method)()
