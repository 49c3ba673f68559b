"""Catalogues: the modules of a folder, found by file name. File name = name in configurations = command-line name.

New files need no registration. A user's own file, given by its path, joins its catalogue while the command runs
(``resolve_name``). This executes the file, so only files that the user names are loaded. Names stored in runs and
models go through ``catalogue_entry``, which accepts no paths.
"""

import ast
import hashlib
import importlib
import pkgutil
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from types import ModuleType
from typing import Any

from smarig.core.errors import UsageError
from smarig.core.former_names import answer_former_names

_OWN: dict[tuple[str, str], "OwnFile"] = {}


@dataclass(frozen=True)
class OwnFile:
    """A user's own file: its path as given and as resolved, the executed bytes, and the object that it defines."""

    name: str
    path: Path
    place: Path
    data: bytes
    found: Any

    @property
    def text(self) -> str:
        """Its text."""
        return self.data.decode("utf-8-sig")

    @property
    def sha256(self) -> str:
        """SHA-256 hash of its bytes."""
        return hashlib.sha256(self.data).hexdigest()


def catalogue_names(package: str) -> list[str]:
    """Sorted names in a catalogue package: its public modules and the own files that were loaded.

    >>> "first_order_descending" in catalogue_names("smarig.protocols")
    True
    """
    return sorted({*_shipped(package), *own_entries(package)})


def catalogue_entry(package: str, name: str) -> Any:
    """The object called ``name`` in the module ``package.name``. UsageError suggests the nearest name."""
    own_file = _OWN.get((package, name))
    if own_file is not None:
        return own_file.found
    if not _is_loaded(package, name) and name not in (known := catalogue_names(package)):
        raise UsageError(f"No {catalogue_kind(package)} '{name}'{suggestion(name, known)}.")
    return getattr(importlib.import_module(f"{package}.{name}"), name)


def _is_loaded(package: str, name: str) -> bool:
    """Whether the folder was searched for this name before: searching it each time is slow."""
    return not name.startswith("_") and f"{package}.{name}" in sys.modules


def catalogue_summary(package: str, name: str) -> str:
    """First line of the docstring of a catalogue entry.

    That of a function or class is read from the source, because importing a whole catalogue for its help takes long.
    """
    if (package, name) in _OWN or _is_loaded(package, name) or name not in catalogue_names(package):
        return docstring_summary(catalogue_entry(package, name))
    return _first_line(_written_docstring(package, name)) or docstring_summary(catalogue_entry(package, name))


def _written_docstring(package: str, name: str) -> str:
    """The docstring of the function or class ``name`` in the source of ``package.name``; "" where there is none."""
    loader: Any = getattr(find_spec(f"{package}.{name}"), "loader", None)
    source = loader.get_source(f"{package}.{name}") if hasattr(loader, "get_source") else None
    for node in ast.parse(source or "").body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == name:
            return ast.get_docstring(node) or ""
    return ""


def docstring_summary(documented: Any) -> str:
    """First line of a docstring; "(no docstring)" where there is none, as under ``python -OO``."""
    return _first_line(documented.__doc__) or "(no docstring)"


def _first_line(text: str | None) -> str:
    return next(iter((text or "").strip().splitlines()), "")


def suggestion(name: str, known: list[str]) -> str:
    """The end of an error message: '; did you mean X? There are: …'.

    >>> suggestion("one_c", ["one_e", "two_c"])
    '; did you mean one_e? There are: one_e, two_c'
    """
    near = get_close_matches(name, known, n=1)
    return (f"; did you mean {near[0]}?" if near else ".") + " There are: " + ", ".join(known)


def catalogue_kind(package: str) -> str:
    """The kind of a catalogue's entries, in one word.

    >>> catalogue_kind("smarig.plant.effects")
    'effect'
    """
    return package.rsplit(".", 1)[-1].rstrip("s")


def _shipped(package: str) -> list[str]:
    path = importlib.import_module(package).__path__
    return [m.name for m in pkgutil.iter_modules(path) if not m.name.startswith("_")]


# --- own files ------------------------------------------------------------------------------------------------------


def is_path(name: str) -> bool:
    """Whether the user gives an own file by its path, and not a name.

    >>> is_path("./mine.py"), is_path("validation")
    (True, False)
    """
    return name.endswith(".py")


def resolve_name(package: str, name: str) -> str:
    """The catalogue name for a name or path that the user gave. The file of a path is executed and added.

    Use it only for names that the user typed or wrote for this command. Raises UsageError, with file and line, if the
    file is missing or wrong, or if it defines no object of its own name that the catalogue can use.
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


def own_entries(package: str) -> dict[str, OwnFile]:
    """The own files in a catalogue, by name."""
    return {name: file for (where, name), file in _OWN.items() if where == package}


@contextmanager
def own_files() -> Iterator[None]:
    """Start without own files and restore the previous ones at the end, so that commands share none."""
    before = dict(_OWN)
    _OWN.clear()
    try:
        yield
    finally:
        _OWN.clear()
        _OWN.update(before)


def own_file_error(error: BaseException) -> str:
    """A sentence with file and line if the error was raised in an own file; otherwise ""."""
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
        raise UsageError(f"{path} is not a UTF-8 text file.") from None


def _check_name(package: str, path: Path) -> None:
    kind = catalogue_kind(package)
    if not path.stem.isidentifier() or iskeyword(path.stem):
        raise UsageError(
            f"{path}: '{path.stem}' is not a valid Python name. Rename the file; use letters, digits and _."
        )
    if path.stem in _shipped(package):
        raise UsageError(
            f"{path}: '{path.stem}' is the name of a shipped {kind}. Rename the file and the {kind} in it."
        )


def _load_own_file(package: str, path: Path, data: bytes) -> Any:
    """The object that the file defines under its own name, checked for the catalogue."""
    kind, name = catalogue_kind(package), path.stem
    module = ModuleType(f"_own_{kind}_{name}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses look up their module there
    answer_former_names()
    try:
        exec(compile(data, str(path), "exec"), module.__dict__)
    except SyntaxError as error:  # in this file or in a file that it imports
        raise UsageError(f"{error.filename or path}, line {error.lineno or 1}: {error.msg}.") from None
    except (Exception, SystemExit) as error:  # older Pythons raise ValueError without a line for null bytes
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
    """The last line of the file in the traceback, with the error's message; "" if the file is not in it."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == path]
    message = f"{type(error).__name__}: {error}".rstrip(".: ")
    return f"{path}, line {lines[-1]}: {message}." if lines else ""
