"""Workbooks, HDF5 and Parquet: what independent writers wrote is found, imported through the draft, and bounded."""

import sys
import zipfile
from datetime import datetime, timedelta

import numpy as np
import pytest

from smarig.core import DataError, UsageError
from smarig.exchange import find_tables, import_file
from smarig.record import load_run

ROWS = 30
T_S = np.arange(ROWS) * 0.5
U = 60 - 35 * np.cos(2 * np.pi * T_S / T_S[-1])
X = np.tanh((U - 60) / 15)


@pytest.fixture
def workbook(tmp_path):
    """Two sheets: the second has a title, a blank row, names, units, and clock times."""
    openpyxl = pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    book = openpyxl.Workbook()
    book.active.title = "Info"
    book.active.append(["Operator", "Meier"])
    sheet = book.create_sheet("Messung 1")
    for row in (["Probe A7"], [], ["Zeit", "Temperatur", "Weg", "Kommentar"], ["", "°C", "mm", ""]):
        sheet.append(row)
    start = datetime(2024, 3, 1, 23, 59, 50)
    for k in range(ROWS):
        sheet.append([start + timedelta(seconds=float(T_S[k])), U[k], X[k], "ok" if k == 3 else None])
    path = tmp_path / "messung.xlsx"
    book.save(path)
    return path


def test_a_sheet_with_title_units_and_dates(workbook):
    (table,) = find_tables(workbook)
    assert table.names == ("Zeit", "Temperatur", "Weg", "Kommentar")
    assert [c.unit for c in table.columns] == ["", "°C", "mm", ""]
    np.testing.assert_allclose(table.columns[0].values, T_S, atol=1e-6)
    np.testing.assert_allclose(table.columns[1].values, U)


MAPPING = """
name = "m"
summary = "s"
source = "o"
[{layout}]
{entries}
[time]
column = "{time}"
{unit}
[columns]
temperature_degC = {{ column = "{u}", unit = "degC" }}
position = {{ column = "{x}", unit = "mm" }}
[input]
channel = "temperature_degC"
quantity = "temperature"
unit = "degC"
[output]
quantity = "displacement"
unit = "mm"
{rest}
"""


def imported(path, tmp_path, **words):
    mapping = tmp_path / "m.toml"
    mapping.write_text(MAPPING.format(**words), encoding="utf-8")
    out = tmp_path / "x.run.sqlite"
    (table,) = find_tables(path)
    import_file(path, format=table.format, mapping=str(mapping), out=out)
    return load_run(out)


def test_a_sheet_is_imported_through_a_mapping(workbook, tmp_path):
    run = imported(
        workbook,
        tmp_path,
        layout="workbook",
        entries='sheet = "Messung 1"\nheader_row = 3\nunits_rows = 1',
        time="Zeit",
        unit='written = "clock"',
        u="Temperatur",
        x="Weg",
        rest='[ignore]\n"Kommentar" = "words"',
    )
    np.testing.assert_allclose(run["t_s"], T_S, atol=1e-6)
    np.testing.assert_allclose(run["position"], X)


def test_a_missing_sheet_is_named(workbook, tmp_path):
    with pytest.raises(UsageError, match="no sheet 'Nope'. Its sheets are: Info, Messung 1"):
        imported(
            workbook,
            tmp_path,
            layout="workbook",
            entries='sheet = "Nope"',
            time="Zeit",
            unit='unit = "s"',
            u="Temperatur",
            x="Weg",
            rest="",
        )


@pytest.fixture
def hdf5(tmp_path):
    h5py = pytest.importorskip("h5py", reason="needs h5py (extra 'files')")
    path = tmp_path / "data.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("run1")
        for name, unit, values in (("time", "s", T_S), ("temperature", "degC", U), ("displacement", "mm", X)):
            group[name] = values
            group[name].attrs["units"] = unit
        group["scalar"] = 3.0
        file["elsewhere"] = h5py.ExternalLink("/etc/hostname", "/")
        file["round"] = h5py.SoftLink("/")
    return path


def test_a_group_of_an_hdf5_file(hdf5, tmp_path):
    (table,) = find_tables(hdf5)
    assert {c.name: c.unit for c in table.columns} == {
        "time": "s",
        "temperature": "degC",
        "displacement": "mm",
    }
    run = imported(
        hdf5,
        tmp_path,
        layout="hdf5",
        entries='group = "/run1"',
        time="time",
        unit='unit = "s"',
        u="temperature",
        x="displacement",
        rest="",
    )
    np.testing.assert_array_equal(run["position"], X)


def test_a_parquet_file(tmp_path):
    pytest.importorskip("pyarrow", reason="needs pyarrow (extra 'parquet')")
    import pyarrow as pa
    from pyarrow import parquet

    path = tmp_path / "data.parquet"
    fields = [
        pa.field("when", pa.timestamp("ms")),
        pa.field("T", pa.float32(), metadata={b"unit": b"degC"}),
        pa.field("x_mm", pa.float64()),
        pa.field("note", pa.string()),
    ]
    when = pa.array((T_S * 1000).astype("int64"), pa.timestamp("ms"))
    columns = [when, pa.array(U.astype("f4")), pa.array(X), pa.array(["a"] * ROWS)]
    parquet.write_table(pa.table(columns, schema=pa.schema(fields)), path)
    (table,) = find_tables(path)
    assert [(c.name, c.unit) for c in table.columns] == [("when", "s"), ("T", "degC"), ("x_mm", "")]
    np.testing.assert_allclose(table.columns[0].values, T_S)
    run = imported(
        path, tmp_path, layout="parquet", entries="", time="when", unit='unit = "s"', u="T", x="x_mm", rest=""
    )
    np.testing.assert_allclose(run["position"], X)


@pytest.mark.parametrize(
    ("name", "package", "head"),
    [
        ("a.xlsx", "openpyxl", b"PK\x03\x04"),
        ("a.h5", "h5py", b"\x89HDF\r\n\x1a\n"),
        ("a.parquet", "pyarrow.parquet", b"PAR1"),
    ],
)
def test_a_missing_package_is_named_with_its_extra(write, monkeypatch, name, package, head):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(UsageError, match=r"needs the extra '\w+': pip install 'smarig\[\w+\]'"):
        find_tables(write(head + b"\x00" * 100, name))


@pytest.mark.long("takes two seconds")
def test_a_workbook_that_unpacks_to_more_than_the_memory_is_refused(tmp_path):
    pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    path = tmp_path / "bomb.xlsx"
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as parts,
        parts.open("xl/a.xml", "w", force_zip64=True) as part,
    ):
        for _ in range(410):
            part.write(b"\x00" * 10**6)
    assert path.stat().st_size < 10**6
    with pytest.raises(DataError, match="unpacks to 410 MB"):
        find_tables(path)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.xlsx", b"PK\x03\x04 and no more", "no workbook"),
        ("a.h5", b"\x89HDF\r\n\x1a\n and no more", "no HDF5 file"),
        ("a.parquet", b"PAR1 and no more", "no Parquet file"),
        ("a.mat", b"MATLAB 5.0 and no more", "damaged or cut off"),
        ("a.pdf", b"%PDF-1.4\n1 0 obj", "a PDF document"),
        ("a.csv.gz", b"\x1f\x8b\x08\x00", "unpack it"),
    ],
)
def test_damaged_and_other_files_are_refused_in_one_sentence(write, name, content, said):
    for package in ("openpyxl", "h5py", "pyarrow.parquet"):
        pytest.importorskip(package, reason=f"needs {package}")
    with pytest.raises(DataError, match=said) as caught:
        find_tables(write(content, name))
    assert "\n" not in str(caught.value)


def test_a_zip_that_is_no_workbook_is_told_apart(tmp_path):
    pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as parts:
        parts.writestr("data.csv", "a,b\n1,2\n")
    with pytest.raises(DataError, match="a ZIP file, but no Excel workbook"):
        find_tables(tmp_path / "x.zip")


def test_a_part_whose_name_is_no_utf_8_is_damage(tmp_path):
    """Found by mutation 3794 of the campaign."""
    pytest.importorskip("openpyxl", reason="needs openpyxl (extra 'files')")
    path = tmp_path / "x.xlsx"
    with zipfile.ZipFile(path, "w") as parts:
        parts.writestr("xl/é.xml", "<a/>")  # a name in UTF-8, marked as such
    path.write_bytes(path.read_bytes().replace("é".encode(), b"\xff\xfe"))
    with pytest.raises(DataError, match="is no workbook .*, or is damaged"):
        find_tables(path)
