"""Arguments with shell completion: rigs, protocols and campaigns by name, run files by path."""

from pathlib import Path

import click
from click.shell_completion import CompletionItem

from smarig.catalogue import names
from smarig.config import listed

_PACKAGES = {
    "protocols": "smarig.protocols",
    "readers": "smarig.exchange.readers",
    "writers": "smarig.exchange.writers",
}


class Named(click.ParamType):
    """A name from one or more catalogues, or a path; checked where it is used."""

    name = "name"

    def __init__(self, *catalogues: str) -> None:
        self._catalogues = catalogues

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Names that begin as typed."""
        del ctx, param
        known = [n for c in self._catalogues for n in (names(_PACKAGES[c]) if c in _PACKAGES else listed(c))]
        return [CompletionItem(n) for n in known if n.startswith(incomplete)]


RIG = Named("rigs")
PROTOCOL = Named("protocols")
EXPERIMENT = Named("protocols", "campaigns")
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)
ANY_PATH = click.Path(path_type=Path)
SEED = click.IntRange(0, 2**63 - 1)  # what every generator and file takes
