"""Single numbers of an HDF5 file, as NeXus has them, are conditions of the record."""

import numpy as np
import pytest

from extras import skip_without
from smarig.study.imported_runs import import_tables
from smarig.study.study_options import StudyOptions
from smarig.study.understanding import understand

U = 70 - 50 * np.cos(np.linspace(0, 12, 120))
Y = 4 - np.tanh((U - 70) / 9)

skip_without("h5py", extra="files")


def file_of(tmp_path, scalars, entries=("entry",)):
    import h5py

    path = tmp_path / "a.nxs"
    with h5py.File(path, "w") as file:
        for k, entry in enumerate(entries):
            data = file.create_group(f"{entry}/data")
            for name, values, unit in (
                ("time", 0.5 * np.arange(120), "s"),
                ("temperature", U, "degC"),
                ("strain", Y, "%"),
            ):
                data[name] = values
                data[name].attrs["units"] = unit
            for name, (value, unit) in scalars.items():
                file[f"{entry}/{name}"] = value + 100.0 * k
                file[f"{entry}/{name}"].attrs["units"] = unit
    return path


def conditions(path, tmp_path):
    found = understand([path], StudyOptions())
    tables, _ = import_tables(found.guesses, tmp_path / "out", None, "a")
    return [table.run.info.conditions for table in tables]


@pytest.mark.long("one of many cases", but_first=True)
@pytest.mark.parametrize("place", ["stress", "sample/stress", "data/stress", "sample/applied_stress"])
def test_a_single_number_is_a_condition(tmp_path, place):
    (found,) = conditions(file_of(tmp_path, {place: (150.0, "MPa")}), tmp_path)
    assert (found["stress"]["mean"], found["stress"]["unit"]) == (150.0, "MPa")


def test_other_single_numbers_are_none(tmp_path):
    scalars = {"stress_limit": (900.0, "MPa"), "stress": (3.0, "V"), "gain": (5.0, "")}
    assert conditions(file_of(tmp_path, scalars), tmp_path) == [{}]


def test_each_entry_has_its_own(tmp_path):
    path = file_of(tmp_path, {"sample/stress": (100.0, "MPa")}, ("first", "second"))
    import h5py

    with h5py.File(path, "a") as file:
        file["second/data/strain"][...] = 1.5 * Y
    assert [found["stress"]["mean"] for found in conditions(path, tmp_path)] == [100.0, 200.0]
