"""The own files that a run was made with: written into its record, and asked for again before it is gone on with.

A run file comes from anywhere, and a Python file is executed when it is loaded. So nothing that a run only names is
ever loaded from it: the person gives the same file again. Knows catalogues and records; loads nothing itself.
"""

from collections.abc import Iterable
from typing import Any

from smarig.config import RigFile, own_drivers
from smarig.control import TRACKING_CONTROLLERS
from smarig.core import DataError, UsageError, catalogue_kind, own_entries
from smarig.plant import EFFECTS, Effect
from smarig.protocols import PROTOCOLS
from smarig.record import Run
from smarig.rig import DRIVERS

OWN_FILES = "own_files"  # key of the run table


def used_own_files(
    protocol: str, effects: Iterable[Any], file: RigFile, controller: str = ""
) -> list[dict[str, str]]:
    """The own files of a run: kind, name, path, hash and text of each; none for what ships."""
    with_type = [e.kind.name for e in effects if isinstance(e, Effect)]
    drivers = own_drivers(file)
    used = {
        PROTOCOLS: {protocol},
        TRACKING_CONTROLLERS: {controller},
        EFFECTS: set(with_type),
        DRIVERS: {name for name, f in own_entries(DRIVERS).items() if str(f.place) in drivers},
    }
    return [
        {
            "kind": catalogue_kind(package),
            "name": name,
            "path": str(f.place),
            "sha256": f.sha256,
            "text": f.text,
        }
        for package, wanted in used.items()
        for name, f in own_entries(package).items()
        if name in wanted
    ]


def check_own_files(run: Run) -> None:
    """UsageError where an own protocol or effect of a run was not given again, or has changed since."""
    for kind, name, path, sha256 in _entries(run):
        package = {"protocol": PROTOCOLS, "effect": EFFECTS}.get(kind)
        if (
            package is None
        ):  # drivers come with the rig file; a closed loop, whose controller it is, is not resumed
            continue
        loaded = own_entries(package).get(name)
        if loaded is None:
            raise UsageError(
                f"{run.path.name} was made with its own {kind}, {path}. It is executed if you give it again: "
                f"smarig resume {run.path.name} --{kind} {path}."
            )
        if loaded.sha256 != sha256:
            raise UsageError(
                f"{loaded.path} is not what {run.path.name} was made with: its {kind} '{name}' has changed since. It "
                "cannot be resumed; the text it was made with stands in its record, under own_files."
            )


def check_drivers(file: RigFile, where: str, remedy: str) -> None:
    """UsageError where a rig that only a file has named would bring a driver of its own."""
    for driver in own_drivers(file):
        raise UsageError(
            f"{where} names rig '{file.name}', which brings a driver of its own, {driver}: {remedy}."
        )


def _entries(run: Run) -> list[tuple[str, str, str, str]]:
    try:
        return [
            (str(e["kind"]), str(e["name"]), str(e["path"]), str(e["sha256"])) for e in run.info.own_files
        ]
    except (KeyError, TypeError):
        raise DataError(f"{run.path.name}: what it says of own files is damaged.") from None
