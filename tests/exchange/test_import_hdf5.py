"""HDF5 files: honest ones of every kind of storage arrive whole; what leads out of the file is refused by name."""

import io
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from extras import skip_without
from smarig.core.errors import DataError, UsageError
from smarig.exchange import find_tables, import_file

skip_without("h5py", extra="files")

from hostile import hdf5_files as crafted  # noqa: E402
from hostile.material import HDF5_MAPPING, SECRET, Material  # noqa: E402
from mutated.hdf5_files import COLUMNS, everything  # noqa: E402
from smarig.exchange.binary import hdf5_child, hdf5_process  # noqa: E402

posix = pytest.mark.skipif(os.name == "nt", reason="pipes, and limits of a process")


@pytest.fixture
def here(monkeypatch):
    """The child's work in this process, for what needs no limits."""

    class Child:
        def __init__(self, path, group):
            self.stdout = io.BytesIO()
            hdf5_child.answer(str(path), group, self.stdout)
            self.stdout.seek(0)

        kill = wait = lambda self: None

    monkeypatch.setattr(hdf5_child, "_open_nothing_else", lambda: None)
    monkeypatch.setattr(hdf5_process, "started", Child)


def make(path: Path, name: str) -> Path:
    crafted.HDF5[name](Material(path.parent), path)
    return path


@pytest.mark.parametrize("libver", ["earliest", "latest"])
def test_every_kind_of_storage_is_read_in_a_child_that_may_open_no_file(tmp_path, libver):
    path = tmp_path / "a.h5"
    path.write_bytes(everything(libver))
    tables = {table.name: table for table in find_tables(path)}
    assert set(tables) == {
        "vectors/run1",
        "packed",
        "table",
        "matrix",
        "odd",
        *(f"groups/cycle {k}/sub" for k in range(12)),
    }
    vectors = {c.name: c for c in tables["vectors/run1"].columns}
    for name, values in COLUMNS.items():
        np.testing.assert_array_equal(vectors[name].values, values)
    assert vectors["time"].unit == "s"
    assert tables["vectors/run1"].header == {"specimen": "A", "load": "3.0"}
    packed = {c.name: c.values for c in tables["packed"].columns}
    np.testing.assert_array_equal(packed["displacement"], COLUMNS["displacement"])
    np.testing.assert_array_equal(packed["scaled"], np.arange(60))
    assert tables["table"].names == ("table/t", "table/T", "table/x", "table/n")
    assert "data/T" in tables["matrix"].names
    assert {"x", "time", "half"} <= set(tables["odd"].names)


ELSEWHERE = {
    "data in /etc/passwd": "data set 'H2' keeps its values in another file, which is not followed",
    "data in a pipe": "data set 'H2' keeps its values in another file, which is not followed",
    "virtual data of a secret file": "data set 'H2' is virtual: its values come from other data sets",
    "filter of a plug-in": "data set 'H2' is packed by filter 32015, a plug-in, which is not loaded",
    "1 T values": "data set 'H2' has more than 50 million values",
    "48 GB of nothing": "it holds more than 50 million values",
    "a chunk of 3 GB": "data set 'H2' is stored in pieces of more than 400 MB",
    "damaged by its own filter": "is damaged or cut off",
    "noise 1": "is damaged or cut off",
}


@posix
@pytest.mark.parametrize("name", ELSEWHERE)
def test_what_is_not_in_the_file_is_refused_with_the_name_of_the_data_set(tmp_path, here, name):
    with pytest.raises(DataError) as refusal:
        find_tables(make(tmp_path / "a.h5", name))
    assert ELSEWHERE[name] in str(refusal.value)


UNCHECKED = """import sys
sys.path.insert(0, sys.argv[1])
import hdf5_child
hdf5_child._check = lambda *_: None
hdf5_child.limit()
hdf5_child.answer(sys.argv[2], "", sys.stdout.buffer)
"""


@posix
@pytest.mark.parametrize("name", ["data in a secret file", "data in a pipe", "virtual data of a secret file"])
def test_the_child_cannot_open_another_file_even_where_no_check_finds_it(tmp_path, name):
    path = make(tmp_path / "a.h5", name)
    words = [sys.executable, "-P", "-c", UNCHECKED, Path(hdf5_child.__file__).parent, path]
    said = subprocess.run(words, stdout=subprocess.PIPE, timeout=60, check=True).stdout
    assert b'"group"' in said
    assert SECRET.encode() not in said


@posix
def test_no_library_of_filters_is_loaded(tmp_path, monkeypatch):
    if not (compiler := shutil.which("cc")):
        pytest.skip("no C compiler")
    path = make(
        tmp_path / "a.h5", "filter of a plug-in"
    )  # before this process, which writes it, could load it
    mark = tmp_path / "executed"
    source = tmp_path / "plugin.c"
    source.write_text(
        f'#include <stdio.h>\n__attribute__((constructor)) void f(void) {{ fclose(fopen("{mark}", "w")); }}\n'
    )
    (tmp_path / "plugins").mkdir()
    subprocess.run([compiler, "-shared", "-fPIC", source, "-o", tmp_path / "plugins" / "libz.so"], check=True)
    monkeypatch.setenv("HDF5_PLUGIN_PATH", str(tmp_path / "plugins"))
    monkeypatch.setattr(hdf5_process, "_CHILD", tmp_path / "child.py")
    (tmp_path / "child.py").write_text(
        UNCHECKED.replace("sys.argv[1]", repr(str(Path(hdf5_child.__file__).parent))).replace(
            "argv[2]", "argv[1]"
        )
    )
    with pytest.raises(DataError, match="damaged"):
        find_tables(path)
    assert not mark.exists()


def test_a_link_or_references_that_a_mapping_names_are_refused_by_name(tmp_path, here):
    mapping = tmp_path / "m.toml"
    for name, used, said in (
        ("link to another file", "H2", "data set 'H2', the position, is a link, which is not followed"),
        ("references", "links", "data set 'links', the position, holds references to other objects"),
    ):
        path = make(tmp_path / f"{used}.h5", name)
        mapping.write_text(HDF5_MAPPING.replace('"B"', f'"{used}"'), encoding="utf-8")
        with pytest.raises(DataError, match=said):
            import_file(path, format="hdf5", mapping=str(mapping), out=tmp_path / "a.run.sqlite")


@pytest.mark.parametrize("group", ["/nope", "/H", "/other/x", "round"])
def test_a_missing_group_and_a_link_to_one_are_named(tmp_path, here, group):
    import h5py

    path = make(tmp_path / "a.h5", "soft links")
    with h5py.File(path, "a") as file:
        file["other"] = h5py.ExternalLink("elsewhere.h5", "/")
    mapping = tmp_path / "m.toml"
    mapping.write_text(HDF5_MAPPING.replace("[hdf5]", f'[hdf5]\ngroup = "{group}"'), encoding="utf-8")
    with pytest.raises(DataError, match=f"there is no group '{group}' in it"):
        import_file(path, format="hdf5", mapping=str(mapping), out=tmp_path / "a.run.sqlite")


def test_a_group_within_itself_is_read_once_and_odd_names_are_read(tmp_path, here):
    assert len(find_tables(make(tmp_path / "a.h5", "a group within itself"))) == 1
    (table,) = find_tables(make(tmp_path / "b.h5", "odd names"))
    assert "\ufffd\ufffd" in table.names
    assert {"H", "B"} < set(table.names)
    (table,) = find_tables(make(tmp_path / "c.h5", "long texts"))
    assert {c.name: len(c.unit) for c in table.columns} == {"B": 0, "H": 200}


@pytest.mark.parametrize("kept", [0, 30, 200, -3])
def test_a_child_that_dies_is_a_damaged_file(tmp_path, here, monkeypatch, kept):
    whole = hdf5_process.started

    def dying(path, group):
        child = whole(path, group)
        child.stdout = io.BytesIO(child.stdout.getvalue()[:kept])
        return child

    monkeypatch.setattr(hdf5_process, "started", dying)
    with pytest.raises(DataError, match="is damaged: the HDF5 library failed on it"):
        find_tables(make(tmp_path / "a.h5", "soft links"))


@posix
def test_a_child_that_computes_or_allocates_without_end_is_ended(tmp_path):
    """The limits hold in the child itself."""
    program = UNCHECKED.split("hdf5_child._check")[0] + (
        "hdf5_child.CPU_S = 1\nhdf5_child.limit()\n"
        "try:\n    bytes(5_000_000_000)\nexcept MemoryError:\n    print('bounded', flush=True)\n"
        "while True:\n    pass\n"
    )
    words = [sys.executable, "-P", "-c", program, Path(hdf5_child.__file__).parent]
    ended = subprocess.run(words, stdout=subprocess.PIPE, timeout=60, check=False)
    assert ended.stdout == b"bounded\n"
    assert ended.returncode < 0


def test_without_a_process_the_sentence_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "none"))
    with pytest.raises(UsageError, match="no process can be started"):
        find_tables(make(tmp_path / "a.h5", "soft links"))
