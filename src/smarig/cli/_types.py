"""Arguments with shell completion: rigs, protocols and campaigns by name, run files by path.

A protocol, controller or effect may be a path, that of an own file: it joins its catalogue here, because a person typed
it.
"""

import math
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from smarig.catalogue import chosen, is_path, names, own
from smarig.config import listed
from smarig.errors import UsageError
from smarig.model.planted import PACKAGE as EFFECTS

_PACKAGES = {
    "protocols": "smarig.protocols",
    "readers": "smarig.exchange.readers",
    "writers": "smarig.exchange.writers",
    "tracking": "smarig.control.tracking.controllers",
    "velocity": "smarig.control.velocity.controllers",
}
_OWN = ("protocols", "tracking")  # what may be an own file


class Named(click.ParamType):
    """A name from one or more catalogues, or a path; checked where it is used."""

    name = "name"

    def __init__(self, *catalogues: str) -> None:
        self._catalogues = catalogues

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """An own file by its name; anything else as it was typed."""
        del param, ctx
        own_kind = next((c for c in self._catalogues if c in _OWN), None)
        return chosen(_PACKAGES[own_kind], value) if own_kind else value

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Names that begin as typed."""
        del ctx, param
        known = [n for c in self._catalogues for n in (names(_PACKAGES[c]) if c in _PACKAGES else listed(c))]
        return [CompletionItem(n) for n in known if n.startswith(incomplete)]


class _OwnEffect(click.ParamType):
    """The path of an own effect, which is known by its name from then on."""

    name = "file"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Its name."""
        del param, ctx
        if value not in own(EFFECTS) and not is_path(value):
            raise UsageError(f"'{value}' is not the file of an own effect, ./NAME.py.")
        return chosen(EFFECTS, value)


class Finite(click.FloatRange):
    """A number within a range; nan and inf, which are within every range, are none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """A float."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


own_effects = click.option(
    "--effect",
    "own_effects",
    multiple=True,
    type=_OwnEffect(),
    expose_value=False,
    metavar="FILE.py",
    help="An effect of your own, beside those of the catalogue; repeatable.",
)
RIG = Named("rigs")
PROTOCOL = Named("protocols")
CONTROLLER = Named("tracking")
VELOCITY = Named("velocity")
EXPERIMENT = Named("protocols", "campaigns")
FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)
ANY_PATH = click.Path(path_type=Path)
SEED = click.IntRange(0, 2**63 - 1)  # what every generator and file takes
