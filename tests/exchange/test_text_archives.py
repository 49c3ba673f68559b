"""Archives of exported tables: their texts are unpacked into one folder, within limits, and nothing else is."""

import io
import re
import zipfile

import numpy as np
import pytest

from smarig.core import DataError, StorageError, UsageError
from smarig.exchange import is_text_archive, unpack_texts
from smarig.exchange.binary import text_archive
from smarig.study import find_files, study_each
from smarig.study.study_options import StudyOptions

TABLE = "t [s];field [mT];strain [ppm]\n" + "".join(f"{k};{k % 7};{k % 5}\n" for k in range(40))


def archive(tmp_path, parts, name="export.zip"):
    path = tmp_path / name
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for part, content in parts.items():
            file.writestr(part, content)
    return path


@pytest.mark.parametrize(
    "name", ["../../outside.csv", "/etc/outside.csv", "..\\..\\outside.csv", "a/b/../../../outside.csv"]
)
def test_no_part_leaves_the_folder(tmp_path, name):
    path = archive(tmp_path, {name: TABLE})
    (file,) = unpack_texts(path, tmp_path / "in" / "here")
    assert file.parent == tmp_path / "in" / "here"
    assert file.read_text(encoding="utf-8") == TABLE
    assert sorted(p.name for p in tmp_path.iterdir()) == ["export.zip", "in"]


def test_only_texts_are_unpacked_and_none_replaces_another(tmp_path):
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w") as file:
        file.writestr("deep.csv", TABLE)
    parts = {"a/b.csv": TABLE, "a_b.csv": TABLE + "1;2;3\n", "inner.zip": inner.getvalue()}
    parts |= {"photo.raw": b"\xff\xd8\0\1", "__MACOSX/._a.csv": "x", ".cache/c.csv": TABLE, "empty.csv": ""}
    parts |= {"wide.txt": TABLE.encode("utf-16")}
    files = unpack_texts(archive(tmp_path, parts), tmp_path / "out")
    assert len({file.name for file in files}) == len(files) == 3
    kept = [parts["a/b.csv"].encode(), parts["a_b.csv"].encode(), parts["wide.txt"]]
    assert {file.read_bytes() for file in files} == set(kept)


def test_a_large_archive_is_refused(tmp_path, monkeypatch):
    path = archive(tmp_path, {"zeros.csv": "0;" * 100_000})
    monkeypatch.setattr(text_archive, "MAX_UNPACKED", 150_000)
    assert not is_text_archive(path)
    with pytest.raises(DataError, match="unpacks to 0 MB"):
        unpack_texts(path, tmp_path / "out")
    monkeypatch.setattr(text_archive, "MAX_PARTS", 0)
    monkeypatch.setattr(text_archive, "MAX_UNPACKED", 10**9)
    with pytest.raises(DataError, match="holds 1 files"):
        unpack_texts(path, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_damaged_archive_is_none(tmp_path):
    path = archive(tmp_path, {"a.csv": TABLE})
    path.write_bytes(path.read_bytes()[:-30])
    assert not is_text_archive(path)


def test_an_archive_that_is_not_read_is_named(tmp_path):
    path = archive(tmp_path, {"inner.zip": b"PK\3\4"})
    with pytest.raises(UsageError, match=f"Unpack {re.escape(str(path))}"):
        find_files([tmp_path])


def test_a_full_disk_is_no_damaged_archive(tmp_path, monkeypatch):
    path = archive(tmp_path, {"a.csv": TABLE})

    def full(*_, **__):
        raise StorageError("The disk is full.")

    monkeypatch.setattr(text_archive, "atomic_file", full)
    with pytest.raises(StorageError, match="The disk is full"):
        unpack_texts(path, tmp_path / "out")


def test_the_tables_of_an_archive_in_a_folder_are_studied(tmp_path):
    u = np.tile(np.r_[0:60, 60:0:-1], 2) + 20
    x = np.convolve(np.r_[np.full(9, u[0]), u], np.ones(10) / 10, "valid")
    rows = "".join(f"{k},{a},{b:.4f}\n" for k, (a, b) in enumerate(zip(u, x, strict=True)))
    table = f"s,temperature [degC],stroke [mm]\n{rows}"
    folder = tmp_path / "in"
    folder.mkdir()
    archive(folder, {"run/loop.csv": table, "readme.txt": "Nothing else.", "main.c": "int main(void);"})
    archive(folder, {"picture.bin": b"\0\1\2"}, "pictures.zip")
    assert [file.name for file in find_files([folder]).data] == ["export.zip"]
    outcomes = study_each([folder], tmp_path / "out", StudyOptions(diagnose=False), workers=1)
    studied = [outcome for outcome in outcomes if not outcome.left_out]
    assert [(o.failure, o.file.endswith("run_loop.csv")) for o in studied] == [("", True)]
    assert [outcome.file.endswith("pictures.zip") for outcome in outcomes if outcome.left_out] == [True]
