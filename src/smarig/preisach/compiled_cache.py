"""Compiled loops on disk, so that the first call in a process loads in place of compiling.

numba's own cache identifies a function by its file and cannot see a change of the functions that it calls. Here the
key is a hash of the whole source of every function and of Python's version; numba adds its own and the processor. The
files are in the user's cache folder, not beside the package, which may be read-only. They hold machine code, so they
are used only from a folder that nobody else can write. Where that folder cannot be made, or a file is damaged, the loop
is compiled as if there were no cache.
"""

import hashlib
import inspect
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any


def cache_folder() -> Path:
    """The folder of the compiled loops: $SMARIG_CACHE_DIR, or the user's cache folder."""
    override = os.environ.get("SMARIG_CACHE_DIR")
    caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(override) if override else Path(caches) / "smarig" / "compiled"


def source_key(functions: Sequence[Callable[..., Any]]) -> str:
    """A hash of all modules that define these functions. OSError or TypeError if a source is not available."""
    files = sorted({str(inspect.getsourcefile(f)) for f in functions})
    texts = [Path(file).read_bytes() for file in files]
    names = [f"{f.__module__}.{f.__qualname__}" for f in functions]
    parts = [sys.version.encode(), *(name.encode() for name in names), *texts]
    return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()


def cached_on_disk(compiled: Any, functions: Sequence[Callable[..., Any]]) -> Any:
    """The numba function with a cache on disk; without it where that is impossible. ``functions``: all that it runs."""
    try:
        key, folder = source_key([compiled.py_func, *functions]), _private_folder()
        # As numba's enable_caching does, with a key of its own. Nothing public allows a choice of the key.
        compiled._cache = _cache_class()(compiled.py_func, key, folder)
    except Exception:
        return compiled  # no folder, no source, or a numba that works otherwise: compile in each process
    return compiled


def _private_folder() -> Path:
    """The folder, made if need be. PermissionError if others can write to it, since its files are executed."""
    folder = cache_folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if hasattr(os, "getuid"):
        state = folder.stat()
        if state.st_uid != os.getuid() or state.st_mode & 0o022:
            raise PermissionError(f"{folder} can be written by others.")
    return folder


def _cache_class() -> Any:
    from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile

    class _Locator:
        """Where the files are, and what they are valid for."""

        def __init__(self, key: str, folder: Path) -> None:
            self._key, self._folder = key, folder

        def get_cache_path(self) -> str:
            return str(self._folder)

        def ensure_cache_path(self) -> None:
            self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)

        def get_source_stamp(self) -> str:
            return self._key

    class _Files(CompileResultCacheImpl):
        def __init__(self, key: str, folder: Path) -> None:
            self._locator = _Locator(key, folder)
            self._filename_base = f"loop-{key[:32]}"

    class _SourceCache(FunctionCache):
        """numba's cache of a function under the hash of its source; what cannot be read or written is no error."""

        def __init__(self, py_func: Any, key: str, folder: Path) -> None:
            self._name, self._py_func, self._key = repr(py_func), py_func, key
            self._impl = _Files(key, folder)
            self._cache_path = str(folder)
            self._cache_file = IndexDataCacheFile(str(folder), self._impl.filename_base, key)
            self.enable()

        def _index_key(self, sig: Any, codegen: Any) -> tuple[Any, ...]:
            return sig, codegen.magic_tuple(), self._key

        def load_overload(self, sig: Any, target_context: Any) -> Any:
            try:
                return super().load_overload(sig, target_context)
            except Exception:
                return None  # damaged, or written halfway: compile

        def save_overload(self, sig: Any, data: Any) -> None:
            try:
                super().save_overload(sig, data)
            except Exception:
                self.disable()  # a full or read-only disk

    return _SourceCache
