"""A folder is a catalogue: a new file is found, and a wrong name gives the nearest correct one."""

import os
import pkgutil
import sys

import pytest

from smarig.core import catalogue
from smarig.core.errors import UsageError


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """A package ``shelf.moves`` with two public files and a private one."""
    folder = tmp_path / "shelf" / "moves"
    folder.mkdir(parents=True)
    (folder.parent / "__init__.py").write_text("")
    (folder / "__init__.py").write_text("")
    (folder / "rise.py").write_text('def rise():\n    """Go up.\n\n    Slowly.\n    """\n')
    (folder / "fall.py").write_text("def fall():\n    pass\n")
    (folder / "_shared.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    yield folder
    for name in [m for m in sys.modules if m.split(".")[0] == "shelf"]:
        del sys.modules[name]


def test_public_files_are_the_names(shelf):
    assert catalogue.catalogue_names("shelf.moves") == ["fall", "rise"]


def test_a_new_file_is_found(shelf):
    (shelf / "hover.py").write_text("hover = 'still'\n")
    assert catalogue.catalogue_names("shelf.moves") == ["fall", "hover", "rise"]
    assert catalogue.catalogue_entry("shelf.moves", "hover") == "still"


def test_find_gives_the_object_of_the_file(shelf):
    assert catalogue.catalogue_entry("shelf.moves", "rise").__name__ == "rise"
    assert catalogue.catalogue_summary("shelf.moves", "rise") == "Go up."


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("rize", r"^No move 'rize'; did you mean rise\? There are: fall, rise\.$"),
        ("xyzzy", r"^No move 'xyzzy'\. There are: fall, rise\.$"),
        ("_shared", r"^No move '_shared'"),
        ("", r"^No move ''\. There are: fall, rise\.$"),
        ("rise.__class__", r"^No move 'rise.__class__'"),
    ],
)
def test_a_wrong_name_is_answered_with_the_nearest(shelf, name: str, sentence: str):
    with pytest.raises(UsageError, match=sentence) as refusal:
        catalogue.catalogue_entry("shelf.moves", name)
    assert refusal.value.exit_status == 2


def test_the_protocols_that_ship():
    names = catalogue.catalogue_names("smarig.protocols")
    assert {"initialise", "wiping_out", "congruency", "first_order_descending"} <= set(names)
    for name in names:
        assert catalogue.catalogue_entry("smarig.protocols", name).__name__ == name
        assert catalogue.catalogue_summary("smarig.protocols", name)
    with pytest.raises(UsageError, match=r"No protocol 'wipeing_out'; did you mean wiping_out\?"):
        catalogue.catalogue_entry("smarig.protocols", "wipeing_out")


def test_a_folder_is_searched_once_and_again_after_a_change(shelf, monkeypatch):
    searched, search = [], pkgutil.iter_modules

    def counted(folders):
        searched.extend(folders)
        return search(folders)

    monkeypatch.setattr("smarig.core.catalogue.pkgutil.iter_modules", counted)
    for _ in range(3):
        assert catalogue.catalogue_names("shelf.moves") == ["fall", "rise"]
    assert len(searched) == 1
    (shelf / "turn.py").touch()
    os.utime(shelf, ns=(0, 10**18))  # whatever the resolution of the clock of the disk
    assert catalogue.catalogue_names("shelf.moves") == ["fall", "rise", "turn"]
