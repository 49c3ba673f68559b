"""Locks of wires: only one's own regular files are written, links are not followed, other users' files not changed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from smarig.core import RigFault, UsageError
from smarig.runner.lock import lock_folder, wire_lock

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX links and users")


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("SMARIG_LOCK_DIR", str(tmp_path / "locks"))
    with wire_lock("w"):
        pass
    return tmp_path / "locks"


def only_file(folder: Path) -> Path:
    (file,) = folder.iterdir()
    return file


def test_a_lock_is_private_and_empty_when_released(folder):
    file = only_file(folder)
    assert file.read_text() == ""
    assert file.stat().st_mode & 0o022 == 0
    with wire_lock("w"):
        assert file.read_text() == f"process {os.getpid()}"


@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_link_is_refused_and_what_it_points_to_stays(folder, tmp_path, link):
    victim, file = tmp_path / "victim", only_file(folder)
    victim.write_text("measurements of months")
    victim.chmod(0o600)
    file.unlink()
    link(victim, file)
    with pytest.raises(UsageError, match="SMARIG_LOCK_DIR"), wire_lock("w"):
        pass
    assert victim.read_text() == "measurements of months"
    assert victim.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("make", [os.mkdir, os.mkfifo])
def test_a_folder_or_a_pipe_is_refused(folder, make):
    file = only_file(folder)
    file.unlink()
    make(file)
    with pytest.raises(UsageError, match="SMARIG_LOCK_DIR"), wire_lock("w"):
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
    with pytest.raises(UsageError, match="belongs to another user"), wire_lock("w"):
        pass
    assert not list((tmp_path / "elsewhere").iterdir())


AS_NOBODY = """
import fcntl, os
from smarig.core import RigFault, UsageError
from smarig.runner.lock import wire_lock
os.setgid(65534); os.setuid(65534)  # nobody
with wire_lock("w"):
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
        with wire_lock("w"):
            folder.chmod(0o755)
            refused = nobody()
        assert "in use by process" in refused.stderr
        assert RigFault.__name__ in refused.stderr
        allowed = nobody()
        assert allowed.stdout == "held\n", allowed.stderr
        assert only_file(folder).stat().st_uid == 0
    finally:
        only_file(folder).unlink()
        folder.rmdir()
