"""Files made by an attacker: each is an entry, and nothing of it is executed, leaked or written."""

import os

import pytest

from console.library.folders import contents, make_run
from hostile.hostile_files import CORPUS, Case
from hostile.material import SECRET, Material, make_material
from smarig.console import Library

pytestmark = [
    pytest.mark.skipif(os.name == "nt", reason="pipes, links and devices of POSIX"),
    pytest.mark.filterwarnings("ignore::RuntimeWarning"),  # of numbers beyond all measure
]
EVERY = 1 if os.environ.get("SMARIG_LONG") else 3  # of the files
SLOW = ("MB", "000", "endless", "large", "deep")  # as in tests/hostile


@pytest.fixture(scope="module")
def material(tmp_path_factory) -> Material:
    return make_material(tmp_path_factory.mktemp("honest"))


def test_hostile_runs_and_models_are_entries(tmp_path, material):
    made = 0
    for kind in ("run", "model"):
        fast = [name for name in sorted(CORPUS[kind]) if not any(word in name for word in SLOW)]
        for k, name in enumerate(fast[::EVERY]):
            Case(kind, name, "").make(material, tmp_path / f"{kind} {k}")
            made += 1
    honest = make_run(tmp_path / "honest.run.sqlite")
    before = {file: file.lstat().st_size for file in tmp_path.rglob("*") if file.is_file()}
    library = Library.open(tmp_path)
    found = library.refresh()
    assert made > 40
    assert not found.problems
    assert library.search("honest.run").entries[0].verdict == "good"
    every = library.search(limit=1000)
    assert every.total > 0.8 * made  # some are pipes, folders, or nothing
    for entry in every.entries:
        assert entry.place.isprintable()
        assert entry.sentence.isprintable()
        assert entry.error.isprintable()
        assert SECRET not in repr(entry)
    once = contents(library)
    library.rebuild()
    assert contents(library) == once
    assert honest.is_file()
    after = {file: file.lstat().st_size for file in before if file.exists()}
    assert after == before
    assert not material.executed
    assert material.precious.exists()
