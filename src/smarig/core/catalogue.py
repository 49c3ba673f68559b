"""Catalogues: the modules of a folder, found by file name. File name = name in configurations = command-line name.

New files need no registration. A user's own file, given by its path, and a plug-in, given by its name, join their
catalogue while the command runs (``resolve_name``). This executes them, so only those that the user names are loaded.
Names stored in runs and models go through ``catalogue_entry``, which loads neither.
"""

import ast
import importlib
import pkgutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from smarig.core.errors import UnknownEntry, UsageError
from smarig.core.gate import passed
from smarig.core.own_file import OwnFile, check_own_name, load_own_file, read_own_file
from smarig.core.plugin import (
    PluginOffer,
    check_single,
    import_plugin,
    offered_names,
    offers_of_name,
    plugin_offers,
)
from smarig.core.shown_text import printable, shown

_OWN: dict[tuple[str, str], OwnFile] = {}


def catalogue_names(package: str) -> list[str]:
    """Sorted names in a catalogue package: its public modules, and the own files and plug-ins in use.

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
        hint = plugin_hint(package, name)
        known = sorted({*known, *offered_names(package)})
        if hint:
            raise UsageError(hint)
        raise UnknownEntry(f"No {catalogue_kind(package)} {shown(name)}{suggestion(name, known)}.")
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
    listed = ", ".join(printable(each, 80) for each in known)
    return (f"; did you mean {printable(near[0], 80)}?" if near else ".") + " There are: " + listed


def catalogue_kind(package: str) -> str:
    """The kind of a catalogue's entries, in one word.

    >>> catalogue_kind("smarig.plant.effects")
    'effect'
    """
    return package.rsplit(".", 1)[-1].rstrip("s")


def _shipped(package: str) -> list[str]:
    folders = importlib.import_module(package).__path__
    return [name for folder in folders for name in _public_modules(folder, _changed_ns(folder))]


@lru_cache
def _public_modules(folder: str, changed_ns: int) -> tuple[str, ...]:
    """The modules of a folder, searched again when it has changed: a list of 500 rigs asks 2000 times."""
    del changed_ns
    return tuple(m.name for m in pkgutil.iter_modules([folder]) if not m.name.startswith("_"))


def _changed_ns(folder: str) -> int:
    try:
        return Path(folder).stat().st_mtime_ns
    except OSError:  # in an archive, which stays as it is
        return 0


# --- own files and plug-ins -----------------------------------------------------------------------------------------


def is_path(name: str) -> bool:
    """Whether the user gives an own file by its path, and not a name.

    >>> is_path("./mine.py"), is_path("validation")
    (True, False)
    """
    return name.endswith(".py")


def resolve_name(package: str, name: str) -> str:
    """The catalogue name for a name or path that the user gave. A file or a plug-in is executed and added.

    Use it only for names that the user typed or wrote for this command. An unknown name is returned as it is. Raises
    UsageError, with file and line or with the distribution, if the file or the plug-in is missing or wrong, or if it
    defines no object of its own name that the catalogue can use.
    """
    name = passed(name, _shipped(package))
    if not is_path(name):
        if not ((package, name) in _OWN or _is_loaded(package, name) or name in _shipped(package)):
            offers = offers_of_name(package, name)
            if offers:
                _add_plugin(check_single(offers))
        return name
    path = Path(name)
    data, place, before = read_own_file(path), path.resolve(), _OWN.get((package, path.stem))
    if before is not None and before.place != place:
        raise UsageError(f"{path} and {before.path} have the same name: rename one of them.")
    if before is None or before.data != data:
        kind = catalogue_kind(package)
        check_own_name(path, kind, _shipped(package))
        found = load_own_file(package, kind, path, data)
        _OWN[package, path.stem] = OwnFile(path.stem, path, place, data, found)
    return path.stem


def use_plugin(name: str) -> list[str]:
    """Import the plug-ins of this name, so that models and runs that need them can be opened. Returns their catalogues.

    Raises UsageError if no installed distribution offers the name, or if smarig has an entry of this name.
    """
    named = [offer for offer in plugin_offers()[0] if offer.name == name and offer.package]
    if not named:
        known = sorted({offer.name for offer in plugin_offers()[0] if offer.package})
        there = suggestion(name, known) if known else "; no distribution offers any"
        raise UsageError(f"No installed distribution offers a plug-in '{name}'{there}.")
    packages = sorted({offer.package for offer in named if name not in _shipped(offer.package)})
    if not packages:
        raise UsageError(
            f"The plug-in '{name}' of {named[0].origin} cannot be used: {shipped_fault(named[0])}."
        )
    for package in packages:
        resolve_name(package, name)
    return packages


def plugins_in_use() -> list[str]:
    """The names of the plug-ins that were imported, for ``use_plugin`` in another process."""
    return sorted({file.name for file in _OWN.values() if file.offer is not None})


def shipped_fault(offer: PluginOffer) -> str:
    """A sentence without its full stop if smarig itself has an entry of a plug-in's name; otherwise ""."""
    taken = bool(offer.package) and offer.name in _shipped(offer.package)
    return f"'{offer.name}' is the name of a shipped {offer.kind}" if taken else ""


def plugin_hint(package: str, name: str) -> str:
    """For a name that is only stored in a file: which distribution offers it, and how to allow it; "" if none does."""
    offers = offers_of_name(package, name)
    if not offers:
        return ""
    origins = " and ".join(offer.origin for offer in offers)
    return (
        f"The {offers[0].kind} '{name}' is a plug-in of {origins}, which is imported only if you name it: "
        f"smarig --plugin {name} COMMAND …, or smarig.use_plugin('{name}') in Python."
    )


def _add_plugin(offer: PluginOffer) -> None:
    found, path = import_plugin(offer)
    data = path.read_bytes() if path.is_file() else b""
    _OWN[offer.package, offer.name] = OwnFile(offer.name, path, path.resolve(), data, found, offer)


def own_entries(package: str) -> dict[str, OwnFile]:
    """The own files and plug-ins in use in a catalogue, by name."""
    return {name: file for (where, name), file in _OWN.items() if where == package}


@contextmanager
def own_files() -> Iterator[None]:
    """Start without own files and plug-ins and restore the previous ones at the end, so that commands share none."""
    before = dict(_OWN)
    _OWN.clear()
    try:
        yield
    finally:
        _OWN.clear()
        _OWN.update(before)


def own_file_error(error: BaseException, package: str = "") -> str:
    """A sentence with file and line if the error was raised in an own file or plug-in of a catalogue; otherwise ""."""
    files = [file for (where, _), file in _OWN.items() if package in ("", where)]
    return next((sentence for file in files if (sentence := file.blamed(error))), "")
