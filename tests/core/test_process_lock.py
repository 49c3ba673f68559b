"""Locks between processes: their holder is told. Only one's own regular files are written, links are not followed."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from smarig.core.errors import InUse, UsageError
from smarig.core.process_lock import check_free, lock_folder, process_lock, try_lock

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX links and users")


def lock(key="w", **options):
    return process_lock(key, f"Wire '{key}' is in use", "Wait.", **options)


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / "locks"))
    with lock():
        pass
    return tmp_path / "locks"


def only_file(folder: Path) -> Path:
    (file,) = folder.iterdir()
    return file


def test_a_lock_is_private_and_empty_when_released(folder):
    file = only_file(folder)
    assert file.read_text() == ""
    assert file.stat().st_mode & 0o022 == 0
    with lock():
        assert file.read_text().startswith(f"process {os.getpid()} since 2")


def test_the_holder_is_told_with_its_number_its_start_and_its_command(folder, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/a/smarig/__main__.py", "run", "my rig.toml", "--notify", "secret"])
    since = r"since \d{4}-\d\d-\d\d [\d:]{8} UTC"
    told = rf"^Wire 'w' is in use by process {os.getpid()} {since} \(smarig run 'my rig.toml'\). Wait.$"
    with lock(), pytest.raises(InUse, match=told), lock():
        pytest.fail("two holders")
    with lock():
        pass


@pytest.mark.parametrize("lasting", [True, False])
def test_who_looks_whether_a_lock_is_free_keeps_nobody_from_it(folder, lasting):
    with only_file(folder).open() as looker:
        import fcntl

        fcntl.flock(looker, fcntl.LOCK_SH)  # looks longer than ever
        done = threading.Timer(0.2, looker.close)
        done.start()
        with lock(lasting=lasting):
            done.join()
            with only_file(folder).open() as other:
                assert not try_lock(other)


def test_those_who_look_keep_each_other_from_nothing(folder):
    with only_file(folder).open() as looker:
        import fcntl

        fcntl.flock(looker, fcntl.LOCK_SH)
        check_free("w", "Wire 'w' is in use", "Wait.")


def test_what_a_lock_says_cannot_write_to_the_terminal(folder):
    only_file(folder).write_text("process 1 \x1b[2J" + "x" * 1000)
    with only_file(folder).open() as held:
        import fcntl

        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(InUse, match=r"by process 1 \[2Jx{100,200}\. Wait") as refused, lock():
            pass
    assert "\x1b" not in str(refused.value)


def test_a_key_that_does_not_come_back_leaves_no_file(folder):
    with lock("run a", lasting=False):
        assert len(list(folder.iterdir())) == 2
        with pytest.raises(InUse), lock("run a", lasting=False):
            pass
    assert len(list(folder.iterdir())) == 1
    with lock("run a", lasting=False):
        pass


def test_a_lock_whose_file_was_removed_meanwhile_is_taken_on_the_new_file(folder, monkeypatch):
    """Between opening and locking, the last holder ended and removed the file that this process opened."""
    module, file = sys.modules["smarig.core.process_lock"], only_file(folder)
    original = module.try_lock

    def after_the_holder_has_gone(opened):
        monkeypatch.undo()
        monkeypatch.setenv("SMARIG_LOCK_DIR", str(folder))
        file.unlink()
        return original(opened)

    monkeypatch.setattr(module, "try_lock", after_the_holder_has_gone)
    with lock(), pytest.raises(InUse), lock():
        pytest.fail("one of them locked a file that nobody else finds")


HOLDER = """
import sys
from smarig.core import process_lock
with process_lock("w", "", ""):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_looking_takes_nothing(folder):
    """It leaves one's own lock alone, sees that of another process, and no file appears."""
    with lock():
        check_free("w", "Wire 'w' is in use", "Wait.")
        with pytest.raises(InUse), lock():
            pass
    check_free("unheard", "", "")
    assert len(list(folder.iterdir())) == 1
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-c", HOLDER]
    with subprocess.Popen(command, env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        other.stdout.readline()
        with pytest.raises(InUse, match=rf"by process {other.pid} since .* \(-c\)\. Wait"):
            check_free("w", "Wire 'w' is in use", "Wait.")
        other.stdin.close()
    check_free("w", "Wire 'w' is in use", "Wait.")


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_link_is_refused_and_what_it_points_to_stays(folder, tmp_path, link):
    victim, file = tmp_path / "victim", only_file(folder)
    victim.write_text("measurements of months")
    victim.chmod(0o600)
    file.unlink()
    link(victim, file)
    with pytest.raises(UsageError, match="SMARIG_LOCK_DIR"), lock():
        pass
    assert victim.read_text() == "measurements of months"
    assert victim.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("make", [os.mkdir, os.mkfifo])
def test_a_folder_or_a_pipe_is_refused(folder, make):
    file = only_file(folder)
    file.unlink()
    make(file)
    with pytest.raises(UsageError, match="SMARIG_LOCK_DIR"), lock():
        pass


def test_each_user_has_a_folder(monkeypatch, tmp_path):
    monkeypatch.delenv("SMARIG_LOCK_DIR")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert lock_folder() == tmp_path / "smarig-locks"
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    assert str(os.getuid()) in lock_folder().name


def test_a_folder_that_another_user_made_is_refused(monkeypatch, tmp_path):
    """Who owns it could take the locks away."""
    monkeypatch.delenv("SMARIG_LOCK_DIR")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "smarig-locks").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(UsageError, match="belongs to another user"), lock():
        pass
    assert not list((tmp_path / "elsewhere").iterdir())


AS_NOBODY = """
import fcntl, os
from smarig.core import process_lock
os.setgid(65534); os.setuid(65534)  # nobody
with process_lock("w", "Wire 'w' is in use", ""):
    print("held")
"""


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="needs two users (root)")
def test_users_who_share_a_folder_exclude_each_other_without_changing_files(monkeypatch):
    folder = Path("/tmp") / f"smarig-shared-{os.getpid()}"
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(folder))
    env = {**os.environ, "PYTHONPATH": str(ROOT / "src")}

    def nobody() -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, "-c", AS_NOBODY],
            env=env,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    try:
        with lock():
            folder.chmod(0o755)
            refused = nobody()
        assert "in use by process" in refused.stderr
        assert InUse.__name__ in refused.stderr
        allowed = nobody()
        assert allowed.stdout == "held\n", allowed.stderr
        assert only_file(folder).stat().st_uid == 0
    finally:
        only_file(folder).unlink()
        folder.rmdir()
