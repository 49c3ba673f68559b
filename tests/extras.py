"""Which extras of smarig this environment lacks."""

from importlib.metadata import PackageNotFoundError, requires, version

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


def _installed(name: str) -> bool:
    try:
        return bool(version(name))
    except PackageNotFoundError:
        return False
