"""A part of the corpus in this process: each command ends with a sentence or a result, and does nothing else.

All of it, with limits of time and memory, is the campaign of ``.ci/long`` (``python -m hostile.campaign``).
"""

import os

import pytest

from hostile.hostile_files import COMMANDS, CORPUS, Case
from hostile.judgement import objections
from hostile.material import Material, make_material
from smarig.cli import run

pytestmark = [
    pytest.mark.skipif(os.name == "nt", reason="pipes, links and devices of POSIX"),
    pytest.mark.filterwarnings("ignore::RuntimeWarning"),  # of numbers beyond all measure
]
EVERY = 3  # of the files
SLOW_FILES = ("MB", "000", "endless", "large", "deep", "diagnose")
SLOW_COMMANDS = (
    "diagnose",
    "view",
    "report of a folder",
    "resume",
    "identify",
    "certify",
    "calibrate",
    "track",
    "study",
)


def _chosen() -> list[Case]:
    """Every third file, each before one of the fast commands in turn."""
    found = []
    for kind, files in CORPUS.items():
        commands = [name for name in COMMANDS[kind] if name not in SLOW_COMMANDS]
        small = [name for name in files if not any(word in name for word in SLOW_FILES)]
        found += [
            Case(kind, name, commands[k % len(commands)]) for k, name in enumerate(sorted(small)[::EVERY])
        ]
    return found


SLOW = (
    "numbers 'temperature_degC is 3': diagnose trained on it",
    "numbers 'every step void': identify a table",
)
LONG = pytest.mark.long("takes up to half a minute")


@pytest.fixture(scope="module")
def material(tmp_path_factory) -> Material:
    return make_material(tmp_path_factory.mktemp("honest"))


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=LONG if str(case) in SLOW else []) for case in _chosen()], ids=str
)
def test_a_hostile_file_ends_a_command_properly(capfd, tmp_path, material, case):
    if case.kind == "hdf5":
        pytest.importorskip("h5py", reason="needs h5py (extra 'files')")
    out = tmp_path / "out"
    out.mkdir()
    status = run(case.words(material, case.make(material, tmp_path / "in"), out))
    said, err = capfd.readouterr()
    assert not objections(material, status, said, err, out)


NAMED = [
    Case("run", "secret as a profile", "resume"),
    Case("run", "secret as rig", "resume"),
    Case("run", "own protocol", "resume"),
    Case("run", "own effect", "resume"),
    Case("run", "trigger empties", "resume"),
    Case("run", "no samples", "simulate"),
    Case("run", "journal that deletes", "report"),
    Case("run", "infinite positions", "report of a folder"),
    Case("run", "huge positions", "report of a folder"),
    Case("run", "formula as unit", "export csv"),
    Case("model", "secret as rig", "simulate on its rig"),
    Case("model", "deep mirrors", "certify"),
    Case("hdf5", "data in a pipe", "import hdf5"),
    Case("hdf5", "odd names", "import hdf5"),
    Case("numbers", "input is 1e308 of both signs", "report"),
    Case("numbers", "position is 1e308 of both signs", "verify"),
    Case("numbers", "one position is 9e999", "verify"),
    Case("numbers", "one position is NULL", "identify positive"),
    Case("toml", "deep lists", "check"),
    Case("toml", "an endless integer", "import"),
]


@pytest.mark.parametrize("case", NAMED, ids=str)
def test_what_once_went_wrong(capfd, tmp_path, material, case):
    test_a_hostile_file_ends_a_command_properly(capfd, tmp_path, material, case)


def test_the_corpus_is_large_and_has_every_kind():
    assert {kind: len(files) >= 20 for kind, files in CORPUS.items()} == dict.fromkeys(CORPUS, True)
    assert set(COMMANDS) == set(CORPUS)


HONEST = [
    ("run", "report"),
    ("run", "export csv"),
    ("run", "verify"),
    ("run", "identify"),
    ("run", "simulate"),
    pytest.param("run", "diagnose", marks=LONG),
    ("run", "resume"),
    ("table", "import csv"),
    ("toml", "check"),
    ("model", "verify"),
    ("model", "simulate on its rig"),
    ("matlab", "import mat"),
    ("hdf5", "import hdf5"),
]


@pytest.mark.parametrize(("kind", "command"), HONEST)
def test_the_honest_files_are_accepted(capfd, tmp_path, material, kind, command):
    """Otherwise every hostile one would be refused for another reason than its own."""
    honest = {"table": "good.csv", "toml": "rig.toml", "model": "m.model.json", "matlab": "good.mat"}
    if kind == "hdf5":
        pytest.importorskip("h5py", reason="needs h5py (extra 'files')")
    honest |= {"hdf5": "good.h5"}
    path = material.folder / honest[kind] if kind != "run" else tmp_path / "killed.run.sqlite"
    if kind == "run":
        path.write_bytes(material.killed.read_bytes())
    assert run([str(word) for word in COMMANDS[kind][command](material, path, tmp_path)]) == 0


def test_a_held_out_run_without_settled_steps_is_told(capfd, tmp_path, material):
    case = Case("numbers", "position is nothing", "diagnose")
    assert run(case.words(material, case.make(material, tmp_path / "in"), tmp_path)) == 4
    assert "The held-out runs contain no settled steps." in capfd.readouterr().err
