"""File name = configuration name = command-line name. The only magic of the project.

A folder is a catalogue: nothing is registered, a new file is found. A person's own file, given by its path, joins its
catalogue while the command runs (``resolve_name``). It is executed then, so only what a person has named is
loaded: names that stand in runs and models go through ``find``, which knows no paths. Refuses to know what it finds.
"""

import hashlib
import importlib
import pkgutil
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from keyword import iskeyword
from pathlib import Path
from types import ModuleType
from typing import Any

from smarig.core.errors import UsageError
from smarig.core.former_names import answer_former_names

_OWN: dict[tuple[str, str], "OwnFile"] = {}


@dataclass(frozen=True)
class OwnFile:
    """A person's own file: the path it was given by, where that is, the bytes that were executed, what they define."""

    name: str
    path: Path
    place: Path
    data: bytes
    found: Any

    @property
    def text(self) -> str:
        """What stands in it."""
        return self.data.decode("utf-8-sig")

    @property
    def sha256(self) -> str:
        """Of its bytes."""
        return hashlib.sha256(self.data).hexdigest()


def names(package: str) -> list[str]:
    """Names in a catalogue package: its public modules, and own files that were chosen; sorted.

    >>> "first_order_descending" in names("smarig.protocols")
    True
    """
    return sorted({*_shipped(package), *own(package)})


def find(package: str, name: str) -> Any:
    """The object called ``name`` in the module ``package.name``; raises UsageError with the nearest name."""
    own_file = _OWN.get((package, name))
    if own_file is not None:
        return own_file.found
    loaded = not name.startswith("_") and f"{package}.{name}" in sys.modules
    if not loaded and name not in (
        known := names(package)
    ):  # a folder is looked through once a name, not each time
        raise UsageError(f"No {catalogue_kind(package)} '{name}'{suggestion(name, known)}.")
    return getattr(importlib.import_module(f"{package}.{name}"), name)


def summary(package: str, name: str) -> str:
    """First line of the catalogue entry's docstring."""
    return next(iter((find(package, name).__doc__ or "").strip().splitlines()), "(it has no docstring)")


def suggestion(name: str, known: list[str]) -> str:
    """'; did you mean X? There are: …' for an error message.

    >>> suggestion("one_c", ["one_e", "two_c"])
    '; did you mean one_e? There are: one_e, two_c'
    """
    near = get_close_matches(name, known, n=1)
    return (f"; did you mean {near[0]}?" if near else ".") + " There are: " + ", ".join(known)


def catalogue_kind(package: str) -> str:
    """What a catalogue holds, in one word.

    >>> catalogue_kind("smarig.plant.effects")
    'effect'
    """
    return package.rsplit(".", 1)[-1].rstrip("s")


def _shipped(package: str) -> list[str]:
    path = importlib.import_module(package).__path__
    return [m.name for m in pkgutil.iter_modules(path) if not m.name.startswith("_")]


# --- own files ------------------------------------------------------------------------------------------------------


def is_path(name: str) -> bool:
    """Whether a person means an own file and not a name.

    >>> is_path("./mine.py"), is_path("validation")
    (True, False)
    """
    return name.endswith(".py")


def resolve_name(package: str, name: str) -> str:
    """What a person asked for, as a name of the catalogue: a path's file is executed and joins it.

    Only for what a person has typed or written for this command. Raises UsageError, one sentence with file and line,
    where the file is missing, wrong, or holds nothing of its own name that the catalogue could use.
    """
    if not is_path(name):
        return name
    path = Path(name)
    data, place, before = _read(path), path.resolve(), _OWN.get((package, path.stem))
    if before is not None and before.place != place:
        raise UsageError(f"{path} and {before.path} have the same name: rename one of them.")
    if before is None or before.data != data:
        _check_name(package, path)
        _OWN[package, path.stem] = OwnFile(path.stem, path, place, data, _load_own_file(package, path, data))
    return path.stem


def own(package: str) -> dict[str, OwnFile]:
    """The own files in a catalogue, by name."""
    return {name: file for (where, name), file in _OWN.items() if where == package}


@contextmanager
def own_files() -> Iterator[None]:
    """Begin with none, and end as it was before: a command knows those that it was given, and no others."""
    before = dict(_OWN)
    _OWN.clear()
    try:
        yield
    finally:
        _OWN.clear()
        _OWN.update(before)


def own_file_error(error: BaseException) -> str:
    """A sentence with file and line where an error comes out of an own file; "" otherwise."""
    own_file = {str(file.path) for file in _OWN.values()}
    return next((s for path in own_file if (s := _line_of(error, path))), "")


def _read(path: Path) -> bytes:
    try:
        data = path.read_bytes()
        data.decode("utf-8-sig")
        return data
    except FileNotFoundError:
        raise UsageError(f"There is no file {path}.") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path} is not a text in UTF-8.") from None


def _check_name(package: str, path: Path) -> None:
    kind = catalogue_kind(package)
    if not path.stem.isidentifier() or iskeyword(path.stem):
        raise UsageError(
            f"{path}: '{path.stem}' is no name in Python; rename the file, letters, digits and _."
        )
    if path.stem in _shipped(package):
        raise UsageError(
            f"{path}: '{path.stem}' is one of the {kind}s that ship; rename the file and what it defines."
        )


def _load_own_file(package: str, path: Path, data: bytes) -> Any:
    """What the file defines under its own name, fit for the catalogue."""
    kind, name = catalogue_kind(package), path.stem
    module = ModuleType(f"_own_{kind}_{name}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses look there
    answer_former_names()
    try:
        exec(compile(data, str(path), "exec"), module.__dict__)
    except SyntaxError as error:  # its own, or of a file that it imports
        raise UsageError(f"{error.filename or path}, line {error.lineno or 1}: {error.msg}.") from None
    except (Exception, SystemExit) as error:  # ValueError without a line: null bytes, in older Pythons
        raise UsageError(_line_of(error, str(path)) or f"{path} cannot be loaded: {error}.") from None
    if name not in vars(module):
        raise UsageError(f"{path} defines no '{name}': the {kind} must have the file's name.")
    found = vars(module)[name]
    misfit = getattr(importlib.import_module(package), "misfit", None)
    reason = misfit(name, found) if misfit else ""
    if reason:
        raise UsageError(f"{path}: {reason}.")
    return found


def _line_of(error: BaseException, path: str) -> str:
    """The last line of a file that an error came through, and what it says; "" where it did not."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == path]
    message = f"{type(error).__name__}: {error}".rstrip(".: ")
    return f"{path}, line {lines[-1]}: {message}." if lines else ""
