"""Plug-ins: catalogue entries of other installed distributions, found by their entry points.

``plugin_offers`` reads the metadata of distributions and imports nothing. ``import_plugin`` imports one plug-in.
"""

import importlib
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from difflib import get_close_matches
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from typing import Any

from smarig.core.errors import UsageError
from smarig.core.shown_text import error_text

PREFIX = "smarig."
PLUGIN_GROUPS: Mapping[str, str] = {  # group of entry points: catalogue
    "smarig.controllers": "smarig.control.tracking.controllers",
    "smarig.drivers": "smarig.device.drivers",
    "smarig.effects": "smarig.plant.effects",
    "smarig.export_formats": "smarig.exchange.writers",
    "smarig.protocols": "smarig.protocols",
    "smarig.surface_forms": "smarig.preisach.hysteresis.forms",
}


@dataclass(frozen=True)
class PluginOffer:
    """One entry point: its group, its name, the object "module:attribute", and its distribution."""

    group: str
    name: str
    target: str
    distribution: str
    version: str

    @property
    def package(self) -> str:
        """The catalogue that the plug-in extends; "" for an unknown group."""
        return PLUGIN_GROUPS.get(self.group, "")

    @property
    def kind(self) -> str:
        """The kind of the plug-in in words.

        >>> PluginOffer("smarig.surface_forms", "wavy", "lab.wavy:wavy", "lab", "1.2").kind
        'surface form'
        """
        return self.group.removeprefix(PREFIX).removesuffix("s").replace("_", " ")

    @property
    def origin(self) -> str:
        """Distribution and version."""
        return f"{self.distribution} {self.version}".rstrip()

    def fault(self) -> str:
        """Why this cannot be a plug-in, as far as its metadata tell; "" if they tell nothing."""
        if not self.package:
            near = get_close_matches(self.group, PLUGIN_GROUPS, n=1)
            hint = f"; did you mean {near[0]}?" if near else f". There are: {', '.join(PLUGIN_GROUPS)}"
            return f"smarig has no group '{self.group}'{hint}"
        if not self.name.isidentifier() or iskeyword(self.name):
            return f"'{self.name}' is not a valid Python name"
        module = self.target.partition(":")[0].strip().partition(".")[0]
        try:
            missing = not module or (module not in sys.modules and find_spec(module) is None)
        except Exception:
            missing = True
        return f"its module '{module}' is missing" if missing else ""


def plugin_offers() -> tuple[list[PluginOffer], list[str]]:
    """All offers of the installed distributions, and a sentence for each distribution that cannot be read."""
    offers: list[PluginOffer] = []
    faults: list[str] = []
    seen: set[str] = set()
    for distribution in _distributions(faults):
        name = "?"
        try:
            if PREFIX not in (distribution.read_text("entry_points.txt") or ""):
                continue
            name = str(distribution.metadata["Name"] or "?")
            key = re.sub(r"[-_.]+", "-", name).lower()
            if key not in seen:  # of two with the same name, Python imports the first one
                seen.add(key)
                offers += _offers_of(distribution, name)
        except Exception as error:  # whatever is wrong with it, other plug-ins must remain usable
            faults.append(f"The entry points of the distribution {name} cannot be read: {error_text(error)}.")
    return sorted(offers, key=lambda o: (o.group, o.name, o.distribution)), faults


def _distributions(faults: list[str]) -> Iterator[Any]:
    from importlib.metadata import distributions  # needed only for unknown names and lists

    try:
        yield from distributions()
    except Exception as error:
        faults.append(f"The installed distributions cannot be read: {error_text(error)}.")


def _offers_of(distribution: Any, name: str) -> Iterator[PluginOffer]:
    version = str(distribution.metadata["Version"] or "")
    for point in distribution.entry_points:
        if point.group.startswith(PREFIX):
            yield PluginOffer(point.group, point.name, point.value, name, version)


def offers_of_name(package: str, name: str) -> list[PluginOffer]:
    """The offers of one name for one catalogue."""
    return [offer for offer in _offers_for(package) if offer.name == name]


def offered_names(package: str) -> list[str]:
    """The names that plug-ins offer for one catalogue."""
    return sorted({offer.name for offer in _offers_for(package)})


def _offers_for(package: str) -> list[PluginOffer]:
    extensible = package in PLUGIN_GROUPS.values()
    return [offer for offer in plugin_offers()[0] if offer.package == package] if extensible else []


def check_single(offers: list[PluginOffer]) -> PluginOffer:
    """The offer, if it is the only one of its name. Raises UsageError if several distributions offer the name."""
    if len(offers) > 1:
        origins = " and ".join(offer.origin for offer in offers)
        raise UsageError(
            f"The {offers[0].kind} '{offers[0].name}' is offered by several distributions: {origins}. "
            "Uninstall all except one."
        )
    return offers[0]


def import_plugin(offer: PluginOffer) -> tuple[Any, Path]:
    """The object of a plug-in and the path of its module. Raises UsageError that names the distribution."""
    reason = offer.fault()
    if reason:
        raise UsageError(f"{_named(offer)} cannot be used: {reason}.")
    name, _, attribute = (part.strip() for part in offer.target.partition(":"))
    try:
        with redirect_stdout(sys.stderr):  # what it prints is not part of a command's result
            module = found = importlib.import_module(name)
        for part in filter(None, attribute.partition("[")[0].strip().split(".")):
            found = getattr(found, part)
    except (Exception, SystemExit) as error:
        raise UsageError(f"{_named(offer)} cannot be imported: {error_text(error)}.") from None
    reason = _misfit_reason(offer, found)
    if reason:
        raise UsageError(f"{_named(offer)} cannot be used: {reason}.")
    return found, Path(getattr(module, "__file__", None) or name)


def _misfit_reason(offer: PluginOffer, found: Any) -> str:
    misfit = getattr(importlib.import_module(offer.package), "misfit", None)
    try:
        return misfit(offer.name, found) if misfit else ""
    except Exception as error:  # an object whose attributes raise errors
        return error_text(error)


def plugin_folder(module: Path) -> Path:
    """The folder of a plug-in's package, or its file if the module is in no package."""
    found = module
    while (found.parent / "__init__.py").is_file():
        found = found.parent
    return found


def _named(offer: PluginOffer) -> str:
    return f"The {offer.kind} '{offer.name}' of {offer.origin}"
