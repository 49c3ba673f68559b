"""Every key of the gate's table in crafted files before the commands: nothing executed, nothing outside touched."""

import contextlib
import importlib
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from gate.canaries import Canaries, fill
from gate.commands import COMMANDS, ENDINGS, FAST
from gate.crafted import CRAFTED, ELSEWHERE
from gate.watch import watched
from hostile.judgement import objections
from hostile.material import Material, make_material
from smarig.cli import run as cli
from smarig.core import GATED_KEYS
from smarig.study.data_files import find_files

pytestmark = [
    pytest.mark.skipif(os.name == "nt", reason="pipes, links and devices of POSIX"),
    pytest.mark.filterwarnings("ignore::RuntimeWarning"),
]
FILES_A_ROW = 3  # all of them with SMARIG_LONG=1
Case = tuple[str, str, str]  # row of the table, crafted file, command


@pytest.fixture(scope="module")
def material(tmp_path_factory) -> Material:
    return make_material(tmp_path_factory.mktemp("gate") / "honest")


@pytest.fixture(scope="module")
def canaries(tmp_path_factory, material) -> Iterator[Canaries]:
    with pytest.MonkeyPatch.context() as patch:
        # matplotlib's list of fonts: read here once, and by the workers of a study, which would write it to their HOME
        patch.setenv("MPLCONFIGDIR", str(tmp_path_factory.mktemp("matplotlib")))
        with contextlib.suppress(ImportError):
            importlib.import_module("matplotlib.font_manager")
        yield fill(tmp_path_factory.mktemp("elsewhere") / "outside", material)


def _walk() -> Iterator[Case]:
    """The first files of every row, each before a fast command in turn, and the first run before ``resume``."""
    turn = 0
    for row, files in CRAFTED.items():
        for k, (name, crafted) in enumerate(list(files.items())[:FILES_A_ROW]):
            fast = FAST.get(crafted.kind, tuple(COMMANDS[crafted.kind]))
            turn += 1
            yield row, name, "resume" if crafted.kind == "run" and not k else fast[turn % len(fast)]


def _objections(
    capfd, place: Path, monkeypatch, material: Material, canaries: Canaries, case: Case
) -> list[str]:
    """Carry out a command on a crafted file in a folder; what it did that it must not."""
    row, name, command = case
    crafted = CRAFTED[row][name]
    inside, out = place / "in", place / "out"
    inside.mkdir()
    out.mkdir()
    file = inside / (re.sub(r"\W+", "_", f"{name[:40]}") + ENDINGS[crafted.kind])
    crafted.make(material, canaries, file)
    words = [str(word) for word in COMMANDS[crafted.kind][command](material, file, out)]
    monkeypatch.chdir(canaries.folder)
    monkeypatch.setenv("HOME", canaries.path("home"))
    with watched(canaries.folder) as watch:
        status = cli(words)
    said, err = capfd.readouterr()
    changes = canaries.changes()
    canaries.restore()
    return [*watch.seen, *changes, *objections(material, status, said, err, out)]


@pytest.mark.parametrize("case", list(_walk()), ids=" | ".join)
def test_nothing_that_a_file_names_is_touched(capfd, tmp_path, monkeypatch, material, canaries, case):
    assert not _objections(capfd, tmp_path, monkeypatch, material, canaries, case)


@pytest.mark.long("every crafted file before every command, in two to five minutes")
def test_the_whole_walk(capfd, tmp_path, monkeypatch, material, canaries):
    wrong, count = [], 0
    for row, files in CRAFTED.items():
        for name, crafted in files.items():
            for command in COMMANDS[crafted.kind]:
                count += 1
                place = tmp_path / str(count)
                place.mkdir()
                with monkeypatch.context() as patch:
                    found = _objections(capfd, place, patch, material, canaries, (row, name, command))
                wrong += [f"{row} | {name} | {command}: {one}" for one in found]
                shutil.rmtree(place)
    print(f"{sum(map(len, CRAFTED.values()))} files, {count} cases, {len(wrong)} wrong")
    assert not wrong


def test_every_key_of_the_table_has_crafted_files():
    assert CRAFTED.keys() | ELSEWHERE.keys() == GATED_KEYS.keys()
    assert not CRAFTED.keys() & ELSEWHERE.keys()
    root = Path(__file__).parents[2]
    for file, test in (place.split("::") for place in ELSEWHERE.values()):
        assert f"def {test}(" in (root / file).read_text(encoding="utf-8")
    assert sum(map(len, CRAFTED.values())) >= 100


def test_a_study_leaves_out_links_that_lead_out_of_its_folder(tmp_path, material, canaries):
    folder = tmp_path / "data"
    CRAFTED["folder of data or runs: symbolic link"]["{'x__csv': 'data.csv'}"].make(
        material, canaries, folder
    )
    (folder / "own.csv").symlink_to("good.csv")
    found = find_files([folder])
    assert [file.name for file in found.data] == ["good.csv", "good.run.sqlite", "own.csv"]
    assert [file.name for file in found.left_out] == ["x.csv"]
    assert find_files([folder / "x.csv"]).data, "a link that the user names"


# --- the watch sees what the user's own word allows: otherwise it would see nothing at all -------------------------


@pytest.mark.parametrize(
    ("key", "sees"),
    [
        ("rig: base", "base.toml"),
        ("rig: actuator", "actuator.toml"),
        ("rig: load.file", "load.csv"),
        ("rig: links.DEVICE.driver", "exec"),
        ("rig: links.DEVICE.url", "socket."),
        ("rig: simulator.library", "evil.so"),
    ],
)
def test_what_a_rig_names_is_used_when_the_user_names_the_rig(
    capfd, tmp_path, monkeypatch, canaries, key, sees
):
    monkeypatch.chdir(tmp_path)
    with watched(canaries.folder) as watch:
        cli(["run", "initialise", "--rig", canaries.rig(key), "-o", "r.run.sqlite", "--quiet"])
    capfd.readouterr()
    assert any(sees in one for one in watch.seen if canaries.rig(key) not in one), watch.seen
    canaries.restore()


@pytest.mark.parametrize("key", ["rig: simulator.trace", "rig: links.DEVICE.url with file="])
def test_no_file_is_overwritten_even_for_the_user(capfd, tmp_path, monkeypatch, canaries, key):
    monkeypatch.chdir(tmp_path)
    status = cli(["run", "initialise", "--rig", canaries.rig(key), "-o", "r.run.sqlite", "--quiet"])
    err = capfd.readouterr().err
    assert status == 2
    assert "is not overwritten" in err or "would write a file" in err
    assert not canaries.changes()
