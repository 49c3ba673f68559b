"""Which extras of smarig this environment lacks."""

from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec

import pytest
from packaging.requirements import Requirement


def lacks(extra: str) -> bool:
    """Whether a package that the extra adds is not installed."""
    needs = map(Requirement, requires("smarig") or ())
    added = [
        n
        for n in needs
        if n.marker and n.marker.evaluate({"extra": extra}) and n.marker.evaluate({"extra": ""}) is False
    ]
    return not all(_installed(need.name) for need in added)


def skip_without(package: str, *, extra: str) -> None:
    """Skip the module that calls it if a package is not there, without importing it as ``importorskip`` does."""
    if find_spec(package) is None:
        pytest.skip(f"needs {package} (extra '{extra}')", allow_module_level=True)


def _installed(name: str) -> bool:
    try:
        return bool(version(name))
    except PackageNotFoundError:
        return False
