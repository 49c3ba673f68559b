"""Where the shipped folders are: beside the package in the wheel, at the root of a checkout.

Refuses to know what is in them.
"""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def shipped(folder: str) -> Path:
    """Path of a shipped folder (``configs``, …), in a wheel or in a checkout.

    >>> shipped("configs").is_dir()
    True
    """
    bundled = _PACKAGE / "_bundled" / folder
    return bundled if bundled.is_dir() else _PACKAGE.parents[1] / folder
