"""Code that no part of smarig is and that a command would run: what a person sees before the click that allows it.

A rig file, a campaign or a queue that came with a folder may name a protocol, an effect or a driver in Python, a
library, or an installed plug-in. Here they are only found and hashed; nothing is imported. What lies outside of the
folder is named, and not opened before a person has allowed it (``opened``).
"""

import hashlib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from smarig.config import LinksFile, RigFile, data_led_out, load_campaign, load_rig, shipped_names
from smarig.core import (
    NotPassed,
    SmarigError,
    UsageError,
    catalogue_names,
    is_file,
    is_path,
    offers_of_name,
    opened_file,
    place_inside,
    printable,
)
from smarig.plant import EFFECTS
from smarig.protocols import PROTOCOLS
from smarig.rig import DRIVERS

_NOT_READ = (SmarigError, OSError, ValueError, RecursionError)  # a file that no command can use either


@dataclass(frozen=True)
class OwnCode:
    """A file or a plug-in: its role, its name for people, and the hash of the file ("" if there is none to read).

    ``is_data``: no code, but a file outside of the folder that would be opened.
    """

    role: str
    name: str
    sha256: str = ""
    is_data: bool = False

    @property
    def text(self) -> str:
        """In words, such as "driver of the amplifier mine.py"."""
        return f"{self.role} {self.name}"


def own_code_digest(code: Iterable[OwnCode]) -> str:
    """A text that differs whenever the code does; "" for none."""
    parts = [[each.role, each.name, each.sha256] for each in code]
    return hashlib.sha256(repr(parts).encode("utf-8", "replace")).hexdigest() if parts else ""


def own_code_text(code: Iterable[OwnCode]) -> str:
    """The code in words, for a button or a sentence; "" for none."""
    return printable(", ".join(each.text for each in code), 300)


def own_code_of_rig(name: str, folder: Path, *, opened: bool = False) -> tuple[OwnCode, ...]:
    """What a rig brings, by its name or the path of its file from a folder. ``trace`` is a file that it writes."""
    if name in shipped_names("rigs"):  # never replaced by a file of this name
        return ()
    try:
        file = load_rig(str(folder / name), None if opened else folder)
    except NotPassed as refusal:
        return (OwnCode("rig file", refusal.text, is_data=True),)
    except _NOT_READ:
        return ()
    return tuple(_of_rig(file, folder, opened))


def own_code_of_experiment(name: str, folder: Path, *, opened: bool = False) -> tuple[OwnCode, ...]:
    """What a protocol or a campaign brings."""
    if is_path(name):
        return (_file("protocol", name, folder, opened),)
    given = folder / name
    if not opened and _leads_out(given, folder):
        return (OwnCode("campaign", str(given), is_data=True),)
    if not is_file(given):
        return _plugin("protocol", PROTOCOLS, name)
    try:
        plan = load_campaign(str(given))
    except _NOT_READ:
        return ()
    return tuple(
        code for step in plan.step for code in own_code_of_experiment(step.protocol, folder, opened=opened)
    )


def own_code_of_effect(text: str, folder: Path, *, opened: bool = False) -> tuple[OwnCode, ...]:
    """What an effect brings as the command line takes it: ``./mine.py=3``, ``name.parameter=3``."""
    if path := re.fullmatch(r"(.+\.py)((?:\..*)?(?:=.*)?)", text.strip()):
        return (_file("effect", path[1], folder, opened),)
    return _plugin("effect", EFFECTS, re.split("[.=]", text, maxsplit=1)[0].strip())


def own_code_of_setting(text: str, folder: Path, *, opened: bool = False) -> tuple[OwnCode, ...]:
    """What the value of a setting brings: a controller in Python."""
    return (_file("controller", text, folder, opened),) if is_path(text) else ()


def _of_rig(file: RigFile, folder: Path, opened: bool) -> Iterator[OwnCode]:
    for role in LinksFile.model_fields if file.links else ():
        if (link := getattr(file.links, role)) is not None:
            what = f"driver of the {role.replace('_', ' ')}"
            yield from (
                (_file(what, link.driver, folder, opened),)
                if is_path(link.driver)
                else _plugin(what, DRIVERS, link.driver)
            )
    if file.simulator is not None and file.simulator.library:
        yield _file("firmware library", file.simulator.library, folder, opened)
    if file.simulator is not None and file.simulator.trace:
        yield OwnCode("new file that is written,", str.__str__(file.simulator.trace))
    for role, text in data_led_out(file).items():
        yield OwnCode(role, str.__str__(text), is_data=True)


def _plugin(role: str, package: str, name: str) -> tuple[OwnCode, ...]:
    if name in catalogue_names(package):
        return ()
    return tuple(
        OwnCode(role, f"{name} (plug-in of {offer.origin})") for offer in offers_of_name(package, name)
    )


def _file(role: str, name: str, folder: Path, opened: bool) -> OwnCode:
    path = folder / str.__str__(name)  # Python 3.11 makes no path of a text with a mark
    inside = path.is_relative_to(folder)
    sha256 = _sha256(path) if opened or not _leads_out(path, folder) else ""
    return OwnCode(role, str(path.relative_to(folder)) if inside else str(path), sha256)


def _leads_out(path: Path, folder: Path) -> bool:
    try:
        return place_inside(path, folder) is None
    except ValueError:  # no name of a file
        return False


def _sha256(path: Path) -> str:
    """The hash of a regular file; "" for anything else, which no command can load either."""
    try:
        with opened_file(path) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (UsageError, OSError):
        return ""
