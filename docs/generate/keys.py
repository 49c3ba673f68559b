"""Keys of configuration files, from the models that check them: type, unit, default, bounds, meaning."""

import re

from pydantic import BaseModel

from generate.markdown import code, plain, table
from smarig.config import ActuatorFile, CampaignFile, FileKey, RigFile, file_keys, file_tables
from smarig.exchange import MappingFile

FILES = {
    "Rig": (RigFile, "rigs"),
    "Actuator": (ActuatorFile, "actuators"),
    "Campaign": (CampaignFile, "campaigns"),
    "Import mapping": (MappingFile, "imports"),
}
HEAD = """# Configuration keys

Configuration files are TOML, in `configs/` or at the path that you give. An unknown key is an error. A missing physical
quantity is an error too: it has no default. Keys end in their unit.

A *quantity* is a table of three keys, because it must state its source:
`{ value = 0.15, unit = "mm", source = "data sheet" }`.
"""


def pages() -> dict[str, str]:
    """One page: a chapter for each kind of file."""
    return {"keys": HEAD + "".join(_chapter(*item) for item in FILES.items())}


def _chapter(title: str, model_and_folder: tuple[type[BaseModel], str]) -> str:
    model, folder = model_and_folder
    parts = [f"\n## {title}: `configs/{folder}/NAME.toml`\n"]
    places: dict[type[BaseModel], list[str]] = {}
    for where, inner in file_tables(model):
        places.setdefault(inner, []).append(where)
    for inner, where in places.items():
        if where != [""]:
            heads = ", ".join(code(f"[{w}]") for w in where)
            parts.append(f"\n### {heads}\n\n{_lead(inner)}")
        parts.append("\n" + table(("key", "type", "unit", "default", "means"), map(_row, file_keys(inner))))
    return "".join(parts)


def _lead(model: type[BaseModel]) -> str:
    text = re.sub(r"^\[[\w.]+\]: ", "", (model.__doc__ or "").strip())
    return "\n\n".join(plain(p[:1].upper() + p[1:]) for p in re.split(r"\n\s*\n", text)) + "\n"


def _row(key: FileKey) -> tuple[str, str, str, str, str]:
    return code(key.name), key.type, key.unit, key.default or "–", plain(key.meaning)
