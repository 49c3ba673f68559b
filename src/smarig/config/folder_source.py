"""A rig file that came with a folder: nobody has named it, and what it names leads nowhere out of the folder."""

from dataclasses import dataclass
from pathlib import Path

from smarig.config.file_schemas import LinksFile, RigFile
from smarig.core import Named, Origin, Source, is_path, named, place_inside

LED_OUT = "folder of a console: rig file"  # the row of the gate's table
_FORMULA = "rig: load.formula"  # stands in the file itself
_NO_FILES = ("rig: links.DEVICE.url", _FORMULA)


@dataclass(frozen=True)
class FolderSource(Source):
    """The context of a rig file's schema: only files of the folder, and formulas, may be used without a click."""

    folder: Path

    def mark(self, text: str, key: str) -> Named:
        """A text, marked by where it leads. ``Source.origin`` counts for what is no path of a file."""
        if key in _NO_FILES or (key.endswith(".driver") and not is_path(text)):
            return named(text, key, self.where, Origin.FILE if key == _FORMULA else self.origin)
        if place_inside(self.folder / text, self.folder) is None:
            return named(text, LED_OUT, self.where, Origin.INSIDE)
        return named(text, key, self.where, Origin.FILE)


def led_out(file: RigFile) -> dict[str, Named]:
    """What a rig that was loaded as one of a folder names outside of it, by its role."""
    links = {role: getattr(file.links, role) for role in LinksFile.model_fields} if file.links else {}
    code = {f"driver of the {role.replace('_', ' ')}": link.driver for role, link in links.items() if link}
    if file.simulator is not None:
        code |= {"firmware library": file.simulator.library, "trace": file.simulator.trace}
    return _outside(code) | data_led_out(file)


def data_led_out(file: RigFile) -> dict[str, Named]:
    """The files of data among them, which are only read."""
    load, simulator = file.load, file.simulator
    named_by = {"actuator file": file.actuator, "load file": load.file if load else ""}
    return _outside(named_by | {"faults file": simulator.faults if simulator else ""})


def _outside(texts: dict[str, str]) -> dict[str, Named]:
    return {role: t for role, t in texts.items() if isinstance(t, Named) and t.row.name == LED_OUT}
