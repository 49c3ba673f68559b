"""The names that ``identify --extension`` takes: every file of the catalogue, "none" and "best"."""

from smarig.core.catalogue import names

EXTENSIONS = "smarig.identification.extended.extensions"
NONE, BEST = "none", "best"


def extension_names() -> tuple[str, ...]:
    """ "none", every file of the catalogue, "best".

    >>> extension_names()[0], extension_names()[-1], "moving" in extension_names()
    ('none', 'best', True)
    """
    return NONE, *names(EXTENSIONS), BEST
