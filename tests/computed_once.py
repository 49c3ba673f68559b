"""What many tests need and is dear to compute: computed once by all workers of a session, and kept in a folder."""

import contextlib
import hashlib
import marshal
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from functools import cache, wraps
from importlib import import_module
from pathlib import Path
from tempfile import mkdtemp
from types import CellType, FunctionType

VARIABLE = "SMARIG_COMPUTED_DIR"  # the folder of the session, for all its processes


def computed_once(function: Callable) -> Callable:
    """The function; its result for the same arguments, which their text must tell, is a file that all workers read."""

    @wraps(function)
    def found(*given, **named):
        path = folder() / name_of(function, given, named)
        with alone(path.with_suffix(".lock")):
            if path.is_file():
                with path.open("rb") as file:  # its bytes take as much memory as what they hold
                    return pickle.load(file)
            result = function(*given, **named)
            write_whole(path, result)
        return result

    return cache(found)


def folder() -> Path:
    """Where the session keeps what it computed."""
    if VARIABLE not in os.environ:  # a test module imported by itself
        os.environ[VARIABLE] = mkdtemp()
    return Path(os.environ[VARIABLE])


def name_of(function: Callable, given: tuple, named: dict) -> str:
    """A file name for a call."""
    text = f"{function.__module__} {function.__qualname__} {given!r} {sorted(named.items())!r}"
    return f"{function.__name__}_{hashlib.sha256(text.encode()).hexdigest()[:16]}.pickle"


@contextlib.contextmanager
def alone(lock: Path) -> Iterator[None]:
    """One process at a time; the others wait."""
    with lock.open("w") as file:
        if sys.platform == "win32":
            import msvcrt

            waiting = True
            while waiting:  # each attempt lasts ten seconds
                with contextlib.suppress(OSError):
                    msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
                    waiting = False
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def write_whole(path: Path, result: object) -> None:
    """Pickle an object into a file that is whole, or not there."""
    started = path.with_suffix(f".{os.getpid()}")
    with started.open("wb") as file:
        _Pickler(file).dump(result)
    started.replace(path)


class _Pickler(pickle.Pickler):
    """Also takes functions made by functions, which solvers keep: their code and the values that they enclose."""

    def reducer_override(self, obj):
        """How to make the object again; NotImplemented where pickle knows."""
        if not isinstance(obj, FunctionType) or obj.__qualname__.isidentifier():
            return NotImplemented
        enclosed = tuple(cell.cell_contents for cell in obj.__closure__ or ())
        return _function, (marshal.dumps(obj.__code__), obj.__module__, obj.__defaults__, enclosed)


def _function(code: bytes, module: str, defaults: tuple | None, enclosed: tuple) -> FunctionType:
    cells = tuple(CellType(value) for value in enclosed)
    names = vars(import_module(module))
    return FunctionType(marshal.loads(code), names, None, defaults, cells)
