"""Imports a package of an extra, or says in one sentence how to install it."""

import importlib
import importlib.util
from pathlib import Path
from types import ModuleType

from smarig.core import MissingExtra

_EXTRAS = {"openpyxl": "files", "h5py": "files", "pyarrow.parquet": "parquet", "nptdms": "tdms"}


def needed_package(name: str, path: Path, kind: str) -> ModuleType:
    """The package that reads files of this kind; MissingExtra names the extra if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise MissingExtra(f"{path}: {kind}", _EXTRAS[name]) from None


def check_package(name: str, path: Path, kind: str) -> None:
    """Raise MissingExtra unless the package that reads files of this kind is installed."""
    if importlib.util.find_spec(name) is None:
        raise MissingExtra(f"{path}: {kind}", _EXTRAS[name])
