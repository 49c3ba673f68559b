"""Import paths of earlier versions, for own protocols, effects, controllers and drivers that use them.

They work only after an own file has been loaded (``catalogue``). smarig itself uses none of them.
"""

import importlib
import importlib.util
import sys
from collections.abc import Mapping, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

# former module: the present module, and the names that changed in it
FORMER: Mapping[str, tuple[str, Mapping[str, str]]] = {
    "smarig.command": ("smarig.core.command", {"Verdict": "StepVerdict"}),
    "smarig.control.tracking.known": (
        "smarig.control.tracking.controller_model",
        {"Known": "ControllerModel", "Wanted": "ReferenceFunction"},
    ),
    "smarig.drivers": ("smarig.device.drivers", {}),
    "smarig.drivers._roles": ("smarig.device.roles.ticked", {}),
    "smarig.device.wire": ("smarig.device.encoding", {}),
    "smarig.device.wire.link_faults": ("smarig.device.encoding.link_faults", {}),
    "smarig.errors": ("smarig.core.errors", {}),
    "smarig.links": ("smarig.device.links", {}),
    "smarig.links.serial_line": ("smarig.device.links.serial_line", {"GONE": "PORT_ERRORS"}),
    "smarig.model": ("smarig.plant", {}),
    "smarig.model.actuator": ("smarig.plant.actuator", {}),
    "smarig.model.effect": (
        "smarig.plant.effect",
        {"Kind": "EffectType", "Moment": "PlantState", "Setup": "EffectContext"},
    ),
    "smarig.protocols._moves": (
        "smarig.protocols._building_blocks",
        {"few": "checked_count", "increasing": "checked_partition", "line": "evenly_spaced"},
    ),
    "smarig.sample": ("smarig.core.sample", {}),
    "smarig.wire": ("smarig.device.encoding", {}),
    "smarig.wire.blame": ("smarig.device.encoding.link_faults", {}),
}


# former package: the present package, for modules that kept their names
FOLDERS: Mapping[str, str] = {
    "smarig.device.wire": "smarig.device.encoding",
    "smarig.drivers": "smarig.device.drivers",
    "smarig.links": "smarig.device.links",
    "smarig.model": "smarig.plant",
    "smarig.wire": "smarig.device.encoding",
}


def _present(former: str) -> tuple[str, Mapping[str, str]] | None:
    """The present module, and the names that changed in it; None for a module that never existed."""
    if former in FORMER:
        return FORMER[former]
    folder, _, name = former.rpartition(".")
    present = f"{FOLDERS[folder]}.{name}" if folder in FOLDERS else ""
    return (present, {}) if present and importlib.util.find_spec(present) else None


class _FormerModule(Loader):
    """Creates a module whose names are looked up in the present module."""

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        del spec  # the default module is sufficient

    def exec_module(self, module: ModuleType) -> None:
        present, renamed = _present(module.__name__) or (module.__name__, {})
        home = importlib.import_module(present)

        def get(name: str) -> Any:
            return getattr(home, renamed.get(name, name))

        module.__dict__["__getattr__"] = get
        module.__dict__["__all__"] = [n for n in {*dir(home), *renamed} if not n.startswith("_")]


class _FormerModules(MetaPathFinder):
    """Finds the modules of ``FORMER``, whether or not a folder of that name exists."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        del path, target
        if _present(fullname) is None:
            return None
        is_package = any(name.startswith(f"{fullname}.") for name in [*FORMER, *(f"{p}." for p in FOLDERS)])
        return ModuleSpec(fullname, _FormerModule(), is_package=is_package)


def answer_former_names() -> None:
    """Make the former modules importable from now on. All present modules take precedence."""
    if not any(isinstance(finder, _FormerModules) for finder in sys.meta_path):
        sys.meta_path.append(_FormerModules())
