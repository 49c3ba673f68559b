"""Types of command-line arguments, with shell completion of rigs, protocols, campaigns and run files.

A protocol, controller or effect may also be the path of an own file, which is then added to its catalogue.
"""

import math
import os
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from smarig.core import UsageError, catalogue_names, is_path, own_entries, resolve_name

_PACKAGES = {
    "effects": "smarig.plant.effects",
    "protocols": "smarig.protocols",
    "readers": "smarig.exchange.readers",
    "writers": "smarig.exchange.writers",
    "model_writers": "smarig.exchange.model_writers",
    "tracking": "smarig.control.tracking.controllers",
    "velocity": "smarig.control.velocity.controllers",
    "drivers": "smarig.device.drivers",
}
_MAY_BE_OWN_FILE = ("protocols", "tracking", "drivers")  # catalogues that accept an own file


class CatalogueName(click.ParamType):
    """A name from one or more catalogues, or a path. The command checks it."""

    name = "name"

    def __init__(self, *catalogues: str) -> None:
        self._catalogues = catalogues

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name that an own file defines, or the value as it was typed."""
        del param, ctx
        own_kind = next((c for c in self._catalogues if c in _MAY_BE_OWN_FILE), None)
        return resolve_name(_PACKAGES[own_kind], value) if own_kind else value

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """The names that start with the incomplete text."""
        del ctx, param
        from smarig.config import shipped_names

        candidates = [
            n
            for c in self._catalogues
            for n in (catalogue_names(_PACKAGES[c]) if c in _PACKAGES else shipped_names(c))
        ]
        return [CompletionItem(n) for n in candidates if n.startswith(incomplete)]


class _OwnEffect(click.ParamType):
    """The path of an own effect. The effect is added to the catalogue under its name."""

    name = "file"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The name of the effect."""
        del param, ctx
        if value not in own_entries(_PACKAGES["effects"]) and not is_path(value):
            raise UsageError(
                f"'{value}' is not the file of an effect of your own. Give a path such as ./NAME.py."
            )
        return resolve_name(_PACKAGES["effects"], value)


class FiniteNumber(click.FloatRange):
    """A finite number within a range. ``click`` accepts nan and inf, this type does not."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The value as a float."""
        number = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number

    def _describe_range(self) -> str:
        """The range that help shows; nothing where there are no bounds."""
        return "" if self.min is None and self.max is None else super()._describe_range()


class _TextPath(click.Path):
    """A path whose name is text. Other bytes could not be written into a page, a record or a message."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path."""
        try:
            os.fspath(value).encode("utf-8")
        except UnicodeEncodeError:
            self.fail(f"{value!a}: this name is not UTF-8 text. Rename the file or folder.", param, ctx)
        return super().convert(value, param, ctx)


own_effects = click.option(
    "--effect",
    "own_effects",
    multiple=True,
    type=_OwnEffect(),
    expose_value=False,
    metavar="FILE.py",
    help="An effect of your own, in addition to those of the catalogue; repeatable.",
)
RIG = CatalogueName("rigs")
PROTOCOL = CatalogueName("protocols")
CONTROLLER = CatalogueName("tracking", "velocity")
VELOCITY = CatalogueName("velocity")
DRIVER = CatalogueName("drivers")
EXPERIMENT = CatalogueName("protocols", "campaigns")
FILE = _TextPath(path_type=Path, dir_okay=False)
FOLDER = _TextPath(path_type=Path, file_okay=False)
ANY_PATH = _TextPath(path_type=Path)
SEED = click.IntRange(0, 2**63 - 1)  # the range that all random generators and file formats accept
