"""The order in which people list files: numbers in names count as numbers."""

import re

_NUMBER = re.compile(r"(\d+(?:\.\d+)?)")


def natural_key(name: str) -> tuple[tuple[int, float, str], ...]:
    """The key by which names are sorted.

    >>> sorted(["150 MPa", "7 MPa", "50 MPa"], key=natural_key)
    ['7 MPa', '50 MPa', '150 MPa']
    """
    parts = _NUMBER.split(name.lower())
    return tuple((0, float(p), "") if k % 2 else (1, 0.0, p) for k, p in enumerate(parts) if p)
