"""Finds and reads configuration files by name or path, with their base files and the drivers that they bring."""

from pathlib import Path
from typing import Any

from smarig.config.actuator_file import ActuatorFile
from smarig.config.file_schemas import CampaignFile, LinksFile, RigFile
from smarig.config.folder_source import LED_OUT, FolderSource
from smarig.core import (
    ConfigError,
    Origin,
    Source,
    UsageError,
    check_file,
    check_table,
    has_control_characters,
    is_file,
    is_path,
    load_toml,
    named,
    passed,
    place_inside,
    read_toml,
    shipped,
    shown,
    suggestion,
)


def shipped_names(folder: str) -> list[str]:
    """Names of the files that ship in a folder of configs/.

    >>> shipped_names("campaigns")
    ['characterise', 'quick_look']
    """
    return sorted(p.stem for p in (shipped("configs") / folder).glob("*.toml"))


def locate(folder: str, name: str) -> Path:
    """Path of a configuration file given by name or path. UsageError suggests the nearest name.

    A name of smarig is never that of a file of the present folder, which may have come from anywhere: ./NAME is.
    """
    known = shipped_names(folder)
    name = passed(name, known)
    if name in known:
        return shipped("configs") / folder / f"{name}.toml"
    path = Path(name)
    if path.suffix == ".toml":
        check_file(path)
    elif not is_file(path):
        raise UsageError(f"No {folder.rstrip('s')} {shown(name)}{suggestion(path.name, known)}.")
    return path


def load_actuator(name: str) -> ActuatorFile:
    """An actuator by name or path."""
    return load_toml(ActuatorFile, locate("actuators", name))


def actuator_text(name: str) -> str:
    """The text of an actuator's file."""
    return locate("actuators", name).read_text(encoding="utf-8-sig")


def load_rig(name: str, came_with: Path | None = None) -> RigFile:
    """A rig by name or path. ``came_with``: it was found in this folder, nobody named it, and it leads nowhere out.

    Raises NotPassed if its base lies outside; ``led_out`` tells what else does.
    """
    folder = came_with and came_with.resolve()
    if folder and name not in shipped_names("rigs") and place_inside(Path(name), folder) is None:
        name = named(name, LED_OUT, "An address or an entry")
    files = _rig_files(name, folder)
    raw: dict[str, Any] = {}
    for path, table in files:
        raw = merged_tables(_with_resolved_paths(table, path.parent, folder), raw)
    top = files[0][0]
    return check_table(RigFile, raw, str(top), source=_source(top, folder))


def _source(path: Path, folder: Path | None) -> Source:
    """Who made a rig file: the user, or whoever made the folder that it came with."""
    if folder is None:
        return Source(str(path), Origin.FILE)
    return FolderSource(str(path), Origin.INSIDE, folder)


def merged_tables(base: dict[str, Any], mine: dict[str, Any]) -> dict[str, Any]:
    """Merge two tables key by key. Values that are not tables are replaced."""
    both = {
        key: merged_tables(base[key], mine[key])
        for key in base.keys() & mine.keys()
        if _all_tables(base[key], mine[key])
    }
    return base | mine | both


def _with_resolved_paths(table: dict[str, Any], folder: Path, came_with: Path | None) -> dict[str, Any]:
    """A rig's table with paths of its own drivers, actuator and load that are relative to the rig file's folder."""

    def resolved_path(name: str) -> str:
        if came_with and not has_control_characters(name):
            return _inner_path(folder / name, came_with)
        return _absolute(name, folder)

    actuator, links, load = (table.get(key) for key in ("actuator", "links", "load"))
    resolved = dict(table)
    if isinstance(actuator, str):
        resolved["actuator"] = _sibling_path(actuator, folder, "actuators", came_with)
    if isinstance(load, dict) and isinstance(load.get("file"), str):
        resolved["load"] = load | {"file": resolved_path(load["file"])}
    if isinstance(links, dict):
        resolved["links"] = {
            device: link | {"driver": resolved_path(link["driver"])}
            if isinstance(link, dict) and is_path(str(link.get("driver", "")))
            else link
            for device, link in links.items()
        }
    return resolved


def _absolute(path: str, folder: Path) -> str:
    """A path that is relative to a folder; the text unchanged if it is none, which its schema refuses."""
    return path if has_control_characters(path) else str((folder / path).resolve())


def _inner_path(path: Path, came_with: Path) -> str:
    """Where a path leads in a folder; one that leads out of it is not looked at, and stays as it is written."""
    return str(place_inside(path, came_with) or path)


def _sibling_path(name: str, folder: Path, kind: str, came_with: Path | None) -> str:
    """The path of a file in the same folder as the file that names it; otherwise the name unchanged.

    Of a rig that came with a folder every name but those of smarig is a path: none is looked for elsewhere.
    """
    if has_control_characters(name):
        return name
    if came_with:
        own = name and name not in shipped_names(kind)
        return _inner_path(folder / name, came_with) if own else name
    sibling = folder / name
    return str(sibling.resolve()) if name.endswith(".toml") and is_file(sibling) else name


def driver_names(file: RigFile) -> list[str]:
    """The drivers that a rig file names: names, and paths of own drivers."""
    links = [getattr(file.links, device) for device in LinksFile.model_fields] if file.links else []
    return [link.driver for link in links if link]


def own_drivers(file: RigFile) -> list[str]:
    """Paths of the own drivers that a rig file names."""
    return [driver for driver in driver_names(file) if is_path(driver)]


def _all_tables(*values: Any) -> bool:
    return all(isinstance(value, dict) for value in values)


def rig_text(name: str) -> str:
    """The texts of all files that define a rig: its file, then its base, and so on."""
    return "\n".join(path.read_text(encoding="utf-8-sig") for path, _ in _rig_files(name))


def _rig_files(name: str, came_with: Path | None = None) -> list[tuple[Path, dict[str, Any]]]:
    """A rig's file, then its base, and so on."""
    found: list[tuple[Path, dict[str, Any]]] = []
    while name or not found:  # "" is no rig's name, but that of a base that is not there
        path = locate("rigs", name)
        if path in (visited for visited, _ in found):
            raise ConfigError(
                f"{path} is its own base, directly or through another file. Name another rig file."
            )
        raw = read_toml(path)
        if found and not raw.keys() <= RigFile.model_fields.keys() | {"base"}:
            raise ConfigError(
                f"{found[-1][0]} has the base {path}, which is not a rig file."
            )  # without its contents
        found.append((path, raw))
        name = raw.get("base", "")
        if not isinstance(name, str) or has_control_characters(name):
            raise ConfigError(f"{path}: key 'base' must name another rig file.")
        name = _sibling_path(name, path.parent, "rigs", came_with)
        name = passed(_source(path, came_with).mark(name, "rig: base"), shipped_names("rigs"))
    return found


def load_campaign(name: str) -> CampaignFile:
    """A campaign by name or path. Paths of own protocols are relative to its folder."""
    path = locate("campaigns", name)
    plan = load_toml(CampaignFile, path)
    steps = (
        s.model_copy(update={"protocol": _absolute(passed(s.protocol), path.parent)})
        if is_path(s.protocol)
        else s
        for s in plan.step
    )
    return plan.model_copy(update={"step": tuple(steps)})
