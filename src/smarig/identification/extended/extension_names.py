"""The names of the extensions that can be identified."""

from smarig.core import catalogue_names

EXTENSIONS = "smarig.identification.extended.extensions"
NONE, BEST = "none", "best"


def extension_names() -> tuple[str, ...]:
    """ "none", every file of the catalogue, "best".

    >>> extension_names()[0], extension_names()[-1], "moving" in extension_names()
    ('none', 'best', True)
    """
    return NONE, *catalogue_names(EXTENSIONS), BEST
