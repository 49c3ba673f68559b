"""Finds the folders that ship with the package: bundled in a wheel, or at the root of a checkout."""

import sys
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]


def shipped(folder: str) -> Path:
    """Path of a shipped folder (``configs``, …) in a wheel or in a checkout.

    >>> shipped("configs").is_dir()
    True
    """
    bundled = _PACKAGE / "_bundled" / folder
    return bundled if bundled.is_dir() else _PACKAGE.parents[1] / folder


def make_importable(folder: str) -> Path:
    """Put the parent of a shipped code folder (``simulators``, ``benchmarks``) on ``sys.path`` and return it."""
    parent = shipped(folder).parent
    if str(parent) not in sys.path:
        sys.path.append(str(parent))
    return parent
