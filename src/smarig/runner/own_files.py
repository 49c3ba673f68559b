"""The own files and plug-ins of a run: stored in its record, and required again to resume it.

A run file may come from anywhere, and a Python file is executed when it is loaded. A file or plug-in that a run only
names is therefore never loaded from there; the user gives the same one again.
"""

import shlex
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from smarig.config import RigFile, driver_names
from smarig.control import TRACKING_CONTROLLERS
from smarig.core import (
    DataError,
    SmarigError,
    UsageError,
    catalogue_kind,
    named,
    own_entries,
    passed,
)
from smarig.plant import EFFECTS, Effect
from smarig.protocols import PROTOCOLS, file_settings
from smarig.record import Run, StoredRun, stored_run
from smarig.rig import DRIVERS

OWN_FILES = "own_files"  # key of the run table


def used_own_files(
    protocol: str, effects: Iterable[Any], file: RigFile, controller: str = ""
) -> list[dict[str, str]]:
    """The own files of a run with kind, name, path, hash and text, and the distribution of a plug-in.

    Files of the package are left out.
    """
    with_type = [e.kind.name for e in effects if isinstance(e, Effect)]
    drivers = driver_names(file)
    used = {
        PROTOCOLS: {protocol},
        TRACKING_CONTROLLERS: {controller},
        EFFECTS: set(with_type),
        DRIVERS: {name for name, f in own_entries(DRIVERS).items() if f.reference in drivers},
    }
    return [
        {
            "kind": catalogue_kind(package),
            "name": name,
            "path": str(f.place),
            "sha256": f.sha256,
            "text": f.text,
            **({"distribution": f.offer.distribution, "version": f.offer.version} if f.offer else {}),
        }
        for package, wanted in used.items()
        for name, f in own_entries(package).items()
        if name in wanted
    ]


def check_own_files(run: Run) -> None:
    """Raise UsageError if an own protocol or effect of a run was not given again, or has changed."""
    for kind, name, path, sha256, origin in own_file_entries(run):
        package = {"protocol": PROTOCOLS, "effect": EFFECTS}.get(kind)
        # Drivers belong to the rig file; the controller of a closed loop is not needed, as it is not resumed.
        if package is None:
            continue
        loaded = own_entries(package).get(name)
        if loaded is None:
            what = f"the plug-in '{name}' of {origin}" if origin else f"a user's own {kind}, {path}"
            raise UsageError(
                f"{run.path.name} was made with {what}. To execute {'it' if origin else 'this file'}, give it again: "
                f"smarig resume {run.path.name} --{kind} {name if origin else path}."
            )
        now = loaded.offer.origin if loaded.offer else ""
        if now != origin:
            raise UsageError(
                f"{run.path.name} was made with the {kind} '{name}' of {origin or 'the file ' + path}, not of "
                f"{now or loaded.path}. The run cannot be resumed."
            )
        if loaded.sha256 != sha256:
            raise UsageError(
                f"{loaded.path} has changed since {run.path.name} was made: its {kind} '{name}' is not the same. The "
                "run cannot be resumed. Its record holds the original text under own_files."
            )


def with_files_given(run: Run, settings: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a run with its files as the user gives them now. Raises UsageError if one is not given again.

    A record may name any file; only those that the user names are read.
    """
    names = file_settings(str(run.info.protocol))
    for key in given:
        if key not in names:
            raise UsageError(
                f"{run.path.name} continues with the settings that it was started with; '{key}' cannot be given. "
                + (f"Only these name files: {', '.join(names)}." if names else "None of them names a file.")
            )
    for key in names:
        if settings.get(key) and key not in given:
            passed(named(str(settings[key]), "run: settings.file", run.path.name))
    return {**settings, **{key: given[key] for key in names if settings.get(key)}}


def resume_command(path: Path, rig: str = "") -> str:
    """The command with which the user who made a run resumes it; ``rig``: the user's own rig file.

    It names again what no record may name: own protocols and effects, plug-ins, and files of settings.
    """
    words = ["smarig", "resume", str(path), *(["--rig", rig] if rig else [])]
    with suppress(SmarigError), stored_run(path, verify=False) as run:
        words += _named_again(run)
    return shlex.join(words)


def _named_again(run: Run | StoredRun) -> Iterator[str]:
    for kind, name, path, _, origin in own_file_entries(run):
        if kind in ("protocol", "effect"):
            yield from (f"--{kind}", name if origin else path)
    for key in file_settings(str(run.info.protocol)):
        if value := run.info.settings.get(key):
            yield from ("--set", f"{key}={value}")


def own_file_entries(run: Run | StoredRun) -> list[tuple[str, str, str, str, str]]:
    """Kind, name, path, hash, and origin of each own file of a run; the origin is "" for a file, which is no plug-in.

    Raises DataError if they are damaged.
    """
    try:
        return [
            (str(e["kind"]), str(e["name"]), str(e["path"]), str(e["sha256"]), _origin(e))
            for e in run.info.own_files
        ]
    except (KeyError, TypeError):
        raise DataError(f"{run.path.name}: its own_files are damaged.") from None


def _origin(entry: Mapping[str, Any]) -> str:
    return f"{entry.get('distribution', '')} {entry.get('version', '')}".strip()
