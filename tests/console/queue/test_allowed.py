"""Only what a person has queued or started here is started; nothing that came with a folder runs by itself."""

import shutil
import sqlite3
import struct

import pytest

from console.queue.entries import opened, request, worker
from gate.watch import looks_seen, watched
from smarig.console import Library
from smarig.console.own_code import own_code_digest, own_code_of_experiment, own_code_of_rig
from smarig.console.queue import worker as worker_module
from smarig.console.queue.allowed_entries import own_code_of_request
from smarig.console.queue.queue_entry import EntryState
from smarig.core import DataError, UsageError

WAITING = EntryState.WAITING


@pytest.fixture
def started(monkeypatch):
    """The entries that a worker would start; none is."""
    found = []

    class Process:
        pid = 4711

        def poll(self):
            return 0

    def start(entry, _folder):
        found.append(entry.request)
        return Process()

    monkeypatch.setattr(worker_module, "start_process", start)
    return found


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """What is queued meanwhile is queued by somebody else: another account, or another computer."""
    from contextlib import contextmanager

    @contextmanager
    def context():
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("SMARIG_STATE_DIR", str(tmp_path / "state of somebody else"))
            yield

    return context


@pytest.fixture
def folder(tmp_path):
    found = tmp_path / "runs"
    found.mkdir()
    (found / "evil.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\n")
    yield found
    assert not (tmp_path / "executed").exists()


def work(folder):
    """Let a worker do all it would do."""
    with worker(folder) as one:
        while one.step():
            pass
        assert not one.has_work()


def test_what_was_queued_here_goes_on_by_itself(folder, started):
    with opened(folder) as queue:
        queue.add(request("a"))
        queue.add(request("b", experiment="./evil.py", settings={}))
        assert queue.held() == []
    work(folder)
    assert [each.out for each in started] == ["a.run.sqlite", "b.run.sqlite"]


def test_a_queue_that_came_with_the_folder_starts_nothing(folder, started, elsewhere):
    with elsewhere(), opened(folder) as queue:
        queue.add(request("a"))
        queue.add(request("b", experiment="./evil.py", settings={}))
    with opened(folder) as queue:
        queue.add(request("c"))  # that of the person herself keeps its place behind them
        work(folder)
        assert started == []
        plain, own = queue.held()
        assert [code.text for code in plain.code] == []
        assert [code.text for code in own.code] == ["protocol evil.py"]
        queue.allow(plain.entry.id, plain.mark)
        work(folder)
        assert [each.out for each in started] == ["a.run.sqlite"]
        queue.allow(own.entry.id, own.mark)
        work(folder)
        assert [each.out for each in started] == ["a.run.sqlite", "b.run.sqlite", "c.run.sqlite"]


def test_a_click_allows_what_was_shown_and_nothing_else(folder, started, elsewhere):
    with elsewhere(), opened(folder) as queue:
        queue.add(request("a", experiment="./evil.py", settings={}))
        queue.add(request("b"))
    with opened(folder) as queue:
        first, second = queue.held()
        for mark in ("", "x", second.mark):
            with pytest.raises(UsageError, match="has changed since it was shown"):
                queue.allow(first.entry.id, mark)
        with (folder / "evil.py").open("a") as file:
            file.write("# worse\n")
        with pytest.raises(UsageError, match="has changed since it was shown"):
            queue.allow(first.entry.id, first.mark)
    work(folder)
    assert started == []


def test_own_code_that_changes_after_it_was_queued_waits_for_a_click(folder, started):
    with opened(folder) as queue:
        queue.add(request(experiment="./evil.py", settings={}))
        (folder / "evil.py").write_text("open('/dev/null')\n")
        work(folder)
        assert started == []
        assert len(queue.held()) == 1


def test_an_entry_is_started_once_whatever_becomes_of_the_file(folder, started):
    """Its run may have ended with a trip; whoever can write into the folder must not start it again."""
    with opened(folder) as queue:
        queue.add(request())
    work(folder)
    _change(folder, "UPDATE entry SET state = 'waiting'")
    _change(folder, "DELETE FROM queue")
    work(folder)
    assert len(started) == 1


@pytest.mark.parametrize("column", ["request = replace(request, '3', '4')", "id = 7"])
def test_an_entry_that_was_altered_waits(folder, started, column):
    with opened(folder) as queue:
        queue.add(request())
    _change(folder, f"UPDATE entry SET {column}")
    work(folder)
    assert started == []


def test_a_copy_of_the_folder_waits(folder, started, tmp_path):
    with opened(folder) as queue:
        queue.add(request())
    shutil.copytree(folder, tmp_path / "copy")
    work(tmp_path / "copy")
    assert started == []
    folder.rename(tmp_path / "old")
    (tmp_path / "runs").symlink_to(tmp_path / "old")
    work(tmp_path / "runs")
    assert started == []
    (tmp_path / "runs").unlink()
    (tmp_path / "old").rename(folder)
    work(folder)
    assert len(started) == 1


def test_an_edited_entry_is_that_of_the_person(folder, started, elsewhere):
    with elsewhere(), opened(folder) as queue:
        number = queue.add(request("a"))
    with opened(folder) as queue:
        queue.edit(number, request("mine"))
    work(folder)
    assert [each.out for each in started] == ["mine.run.sqlite"]


@pytest.mark.parametrize("out", ["../x.run.sqlite", "/tmp/x.run.sqlite", "queue.sqlite", "library.sqlite"])
def test_an_entry_that_writes_elsewhere_is_not_allowed(folder, started, elsewhere, out):
    with elsewhere(), opened(folder) as queue:
        queue.add(request("a"))
    _change(folder, f"UPDATE entry SET request = replace(request, 'a.run.sqlite', '{out}')")
    with opened(folder) as queue:
        (asking,) = queue.held()
        with pytest.raises(UsageError):
            queue.allow(asking.entry.id, asking.mark)
        _change(folder, "UPDATE entry SET state = 'interrupted'")
        with pytest.raises(UsageError):
            queue.continue_interrupted(asking.entry.id)
    work(folder)
    assert started == []


def test_a_queue_with_triggers_is_none_of_smarig(folder):
    with opened(folder):
        pass
    _change(folder, "CREATE TRIGGER t AFTER UPDATE ON entry BEGIN UPDATE entry SET request = ''; END")
    with pytest.raises(DataError, match="are not those of a queue"):
        opened(folder)


def test_logs_that_are_a_link_are_refused(folder, tmp_path):
    (tmp_path / "other").mkdir()
    (folder / "queue.logs").symlink_to(tmp_path / "other")
    with pytest.raises(UsageError, match="is a link"):
        worker_module.work(folder, idle_s=0.0)


def _change(folder, statement):
    with sqlite3.connect(folder / "queue.sqlite") as db:
        db.execute(statement)
    db.close()


RIG = 'name = "own"\nbase = "one_wire_serial"\n'
NAMED = {
    "driver": (
        "own.toml",
        RIG + '[links.amplifier]\ndriver = "./evil.py"\n',
        "driver of the amplifier evil.py",
    ),
    "library": ("own.toml", RIG + '[simulator]\nlibrary = "./evil.py"\n', "firmware library evil.py"),
    "trace": (
        "own.toml",
        RIG + '[simulator]\ntrace = "victim.csv"\n',
        "new file that is written, victim.csv",
    ),
    "base": (
        "own.toml",
        'name = "own"\nbase = "./base.toml"\n',
        "driver of the encoder daq evil.py",
    ),
}


@pytest.mark.parametrize("name", NAMED)
def test_own_code_of_a_rig_is_found_before_it_runs(folder, name):
    rig, text, words = NAMED[name]
    (folder / rig).write_text(text)
    (folder / "base.toml").write_text(
        'name = "base"\nbase = "one_wire_serial"\n[links.encoder_daq]\ndriver = "./evil.py"\n'
    )
    found = own_code_of_rig(rig, folder)
    assert words in " ".join(code.text for code in found)


def test_a_file_with_the_name_of_a_rig_of_smarig_is_never_that_rig(folder):
    (folder / "one_wire_twin").write_text(RIG + '[links.amplifier]\ndriver = "./evil.py"\n')
    assert own_code_of_rig("one_wire_twin", folder) == ()
    assert own_code_of_rig("./one_wire_twin", folder)


def test_own_code_of_a_campaign_an_effect_and_a_setting_is_found(folder):
    (folder / "c.toml").write_text('name = "c"\nsummary = "s"\n[[step]]\nprotocol = "./evil.py"\n')
    assert [code.role for code in own_code_of_experiment("c.toml", folder)] == ["protocol"]
    asked = request(effects=("./evil.py=3", "settling=2"), settings={"controller": "evil.py", "points": "3"})
    assert [code.text for code in own_code_of_request(asked, folder)] == [
        "effect evil.py",
        "controller evil.py",
    ]


def test_what_smarig_brings_is_no_own_code(folder):
    for rig in (
        "one_wire_twin",
        "one_wire_serial",
        "labjack_one_wire",
        "absent",
        "x" * 5000,
        "a\0b",
        ".",
    ):
        assert own_code_of_rig(rig, folder) == (), rig
    assert own_code_of_request(request(effects=("settling=2",)), folder) == ()
    assert own_code_digest(()) == ""


@pytest.fixture
def outside(tmp_path):
    """A folder beside that of the queue: a base with a driver of its own, and a campaign."""
    found = tmp_path / "outside"
    found.mkdir()
    (found / "evil.py").write_text("")
    link = '[links.amplifier]\ndriver = "./evil.py"\n'
    (found / "base.toml").write_text(f'name = "b"\nbase = "one_wire_serial"\n{link}')
    (found / "c.toml").write_text('name = "c"\nsummary = "s"\n[[step]]\nprotocol = "./evil.py"\n')
    return found


def test_entries_that_lead_out_of_the_folder_are_listed_without_a_look_outside(folder, elsewhere, outside):
    rig = 'name = "own"\nbase = "one_wire_twin"\nactuator = "../outside/a.toml"\n'
    (folder / "own.toml").write_text(rig)
    asked = (
        request("a", rig="own.toml"),
        request("b", rig=str(outside / "base.toml")),
        request("c", experiment=str(outside / "evil.py"), settings={}),
        request("d", kind="campaign", experiment=str(outside / "c.toml"), settings={}),
        request("e", effects=("../outside/evil.py=3",)),
    )
    with elsewhere(), opened(folder) as queue:
        for each in asked:
            queue.add(each)
    with opened(folder) as queue, watched(outside) as watch, looks_seen():
        held = queue.held()
    assert watch.seen == []
    roles = [code.role for each in held for code in each.code]
    assert roles == ["actuator file", "rig file", "protocol", "campaign", "effect"]
    assert all("outside/" in code.name and not code.sha256 for each in held for code in each.code)


def test_code_behind_a_file_outside_is_shown_before_it_runs(folder, started, elsewhere, outside):
    (folder / "own.toml").write_text('name = "own"\nbase = "../outside/base.toml"\n')
    with elsewhere(), opened(folder) as queue:
        queue.add(request("a", rig="own.toml"))
    with opened(folder) as queue:
        (first,) = queue.held()
        assert [code.role for code in first.code] == ["rig file"]
        with pytest.raises(UsageError, match="Entry 1 also runs driver of the amplifier .*evil.py"):
            queue.allow(first.entry.id, first.mark)
        work(folder)
        assert started == []
        (second,) = queue.held()
        assert [code.role for code in second.code] == ["driver of the amplifier"]
        queue.allow(second.entry.id, second.mark)
    (outside / "evil.py").write_text("# worse\n")
    work(folder)
    assert started == [], "it has changed since"
    (outside / "evil.py").write_text("")
    work(folder)
    assert [each.rig for each in started] == ["own.toml"]


@pytest.mark.parametrize("name", ["queue.sqlite", "library.sqlite"])
def test_a_journal_that_names_another_file_deletes_nothing(folder, tmp_path, name):
    """SQLite would delete the file that a journal of several databases names."""
    victim = tmp_path / "victim.txt"
    victim.write_text("precious")
    opened(folder).close()
    Library.open(folder).refresh()
    place, text = struct.pack(">I", 0x40000000 // 4096 + 1), str(victim).encode()
    magic = bytes.fromhex("d9d505f920a163d7")
    head = (magic + struct.pack(">IIIII", 0, 0, 1, 512, 4096)).ljust(512, b"\0")
    tail = struct.pack(">II", len(text), sum(text)) + magic
    (folder / f"{name}-journal").write_bytes(head + place + text + tail)
    with pytest.raises(DataError, match="belongs to several databases"):
        opened(folder) if name == "queue.sqlite" else Library.open(folder).search("")
    assert victim.read_text() == "precious"


def test_a_link_in_place_of_the_queue_is_refused(folder, tmp_path):
    (folder / "queue.sqlite").symlink_to(tmp_path / "created.sqlite")
    with pytest.raises(DataError, match="is a link"):
        opened(folder)
    assert not (tmp_path / "created.sqlite").exists()


def test_computed_columns_are_no_queue(folder):
    opened(folder).close()
    _change(folder, "ALTER TABLE queue ADD COLUMN x TEXT AS (hex(zeroblob(400000000)))")
    with pytest.raises(DataError, match="are not those of a queue"):
        opened(folder)
