"""Compiled loops on disk: loaded by the next process, never for another source, and never needed."""

import importlib.util
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from smarig.preisach import compiled
from smarig.preisach.compiled_cache import cache_folder, source_key
from smarig.preisach.compiled_loop import rank
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach

pytestmark = pytest.mark.skipif(
    not compiled.compiled_available(), reason="numba (extra `fast`) is not installed"
)
SURFACE = thesis_surface("two_c")
INPUTS = 180.0 * np.sin(np.arange(200.0))


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("SMARIG_CACHE_DIR", str(tmp_path / "compiled"))
    return tmp_path / "compiled"


def _fresh_call():
    """The loop as a new process has it, after a call whose outputs were compared with plain Python."""
    compiled.compiled_loop.cache_clear()
    y = Preisach(SURFACE, compiled=True).simulate(INPUTS)
    np.testing.assert_allclose(y, Preisach(SURFACE, compiled=False).simulate(INPUTS), rtol=0, atol=1e-12 * 35)
    keys = SURFACE.keyed.compiled_keys
    assert keys is not None
    loop: Any = compiled.compiled_loop(SURFACE.keyed.between, keys)
    compiled.compiled_loop.cache_clear()
    return loop.stats


def test_the_second_call_loads_what_the_first_compiled(folder):
    assert not _fresh_call().cache_hits
    assert sorted(path.suffix for path in folder.iterdir()) == [".nbc", ".nbi"]
    assert sum(_fresh_call().cache_hits.values()) == 1


def test_a_damaged_file_is_compiled_again(folder):
    _fresh_call()
    for path in folder.iterdir():
        path.write_bytes(b"damaged" + path.read_bytes()[: path.stat().st_size // 2])
    assert not _fresh_call().cache_hits


def test_where_no_folder_can_be_it_is_compiled_without(folder):
    folder.write_text("a file in the place of the folder", encoding="utf-8")
    assert not _fresh_call().cache_hits
    assert folder.is_file()


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_a_folder_that_others_can_write_is_not_used(folder):
    """Its files would be executed."""
    folder.mkdir()
    folder.chmod(0o777)
    assert not _fresh_call().cache_hits
    assert not list(folder.iterdir())


def _function(path: Path, text: str):
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("written", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.between


def test_another_source_has_another_key(tmp_path):
    """Also where only a function has changed that the named one calls, in a file of the same size and time."""
    text = "def half(x):\n    return x / 2\n\n\ndef between(p, a, b):\n    return half(a - b)\n"
    path, keys = tmp_path / "written.py", []
    for version in (text, text.replace("/ 2", "/ 3"), text):
        function = _function(path, version)
        os.utime(path, (1e9, 1e9))
        keys.append(source_key([function, rank]))
    assert keys[0] == keys[2] != keys[1]


def test_the_folder_is_the_users(monkeypatch, tmp_path):
    monkeypatch.delenv("SMARIG_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "smarig" / "compiled"
