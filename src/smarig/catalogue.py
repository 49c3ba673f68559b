"""File name = configuration name = command-line name. The only magic of the project.

A folder is a catalogue: nothing is registered, a new file is found. Refuses to know what it finds.
"""

import importlib
import pkgutil
from difflib import get_close_matches
from typing import Any

from smarig.errors import UsageError


def names(package: str) -> list[str]:
    """Names in a catalogue package: its public modules, sorted.

    >>> "first_order_descending" in names("smarig.protocols")
    True
    """
    path = importlib.import_module(package).__path__
    return sorted(m.name for m in pkgutil.iter_modules(path) if not m.name.startswith("_"))


def find(package: str, name: str) -> Any:
    """The object called ``name`` in the module ``package.name``; raises UsageError with the nearest name."""
    known = names(package)
    if name not in known:
        kind = package.rsplit(".", 1)[-1].rstrip("s")
        raise UsageError(f"No {kind} '{name}'{suggestion(name, known)}.")
    return getattr(importlib.import_module(f"{package}.{name}"), name)


def summary(package: str, name: str) -> str:
    """First line of the catalogue entry's docstring."""
    return (find(package, name).__doc__ or "").strip().splitlines()[0]


def suggestion(name: str, known: list[str]) -> str:
    """'; did you mean X? There are: …' for an error message.

    >>> suggestion("one_c", ["one_e", "two_c"])
    '; did you mean one_e? There are: one_e, two_c'
    """
    near = get_close_matches(name, known, n=1)
    return (f"; did you mean {near[0]}?" if near else ".") + " There are: " + ", ".join(known)
