"""Keys of configuration files, from the models that check them: type, unit, default, bounds, meaning."""

import re
from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo

from generate.comments import class_comments
from generate.markdown import code, plain, table
from smarig.config import ActuatorFile, CampaignFile, InUnit, Quantity, RigFile
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
UNITS = {
    "A": "A", "A_per_s": "A/s", "A2s": "A² s", "K": "K", "V": "V", "counts": "counts", "degC": "°C", "mm": "mm",
    "ohm": "ohm", "s": "s", "W_per_K": "W/K", "h": "h", "min": "min", "C": "°C", "K_per_A2": "K/A²",
}  # fmt: skip
Key = tuple[str, FieldInfo, str]


def pages() -> dict[str, str]:
    """One page: a chapter for each kind of file."""
    return {"keys": HEAD + "".join(_chapter(*item) for item in FILES.items())}


def unit_of(name: str) -> str:
    """The unit that a name ends in.

    >>> unit_of("current_rate_A_per_s"), unit_of("period_s"), unit_of("wire")
    ('A/s', 's', '')
    """
    endings = [name.split("_", k)[-1] for k in range(1, name.count("_") + 1)]
    return next((UNITS[e] for e in endings if e in UNITS), "")


def tables(model: type[BaseModel], where: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """(TOML's header, model) of a file and of every table in it, outer ones first."""
    yield where, model
    for name, field in model.model_fields.items():
        inner, kind = _inner(field.annotation)
        path = f"{where.strip('[]')}.{name}" if where else name
        if inner is not None and not issubclass(inner, Quantity):
            bare = path if kind != "dict" else f"{path}.NAME"
            yield from tables(inner, f"[{bare}]" if kind == "tuple" else bare)


def keys(model: type[BaseModel]) -> list[Key]:
    """(key, field, meaning) in the order of the model."""
    comments_by_name = class_comments(model)
    return [(name, field, comments_by_name.get(name, "")) for name, field in model.model_fields.items()]


def _chapter(title: str, model_and_folder: tuple[type[BaseModel], str]) -> str:
    model, folder = model_and_folder
    parts = [f"\n## {title}: `configs/{folder}/NAME.toml`\n"]
    places: dict[type[BaseModel], list[str]] = {}
    for where, inner in tables(model):
        places.setdefault(inner, []).append(where)
    for inner, where in places.items():
        if where != [""]:
            heads = ", ".join(code(f"[{w}]") for w in where)
            parts.append(f"\n### {heads}\n\n{_lead(inner)}")
        parts.append("\n" + table(("key", "type", "unit", "default", "means"), map(_row, keys(inner))))
    return "".join(parts)


def _lead(model: type[BaseModel]) -> str:
    text = re.sub(r"^\[[\w.]+\]: ", "", (model.__doc__ or "").strip())
    return "\n\n".join(plain(p[:1].upper() + p[1:]) for p in re.split(r"\n\s*\n", text)) + "\n"


def _row(key: Key) -> tuple[str, str, str, str, str]:
    name, field, means = key
    needed = field.is_required()
    default = "needed" if needed else _default(field)
    return code(name), _type(field), _unit(name, field), default, plain(means)


def _default(field: FieldInfo) -> str:
    value = field.get_default(call_default_factory=True, validated_data={})
    if isinstance(value, bool):
        return code(str(value).lower())
    empty = value is None or isinstance(value, BaseModel) or value in ((), {}, "")
    return "–" if empty else code(f'"{value}"' if isinstance(value, str) else value)


def _unit(name: str, field: FieldInfo) -> str:
    validators = (m.func for m in field.metadata if isinstance(m, AfterValidator))
    return next((f.unit for f in validators if isinstance(f, InUnit)), unit_of(name))


def _type(field: FieldInfo) -> str:
    bounds = [_bound(m) for m in field.metadata]
    return ", ".join([_named(field.annotation), *(b for b in bounds if b)])


def _bound(m: Any) -> str:
    signs = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
    return " ".join(
        f"{signs[k]}\u00a0{float(getattr(m, k)):.12g}" for k in signs if getattr(m, k, None) is not None
    )


def _inner(annotation: Any) -> tuple[type[BaseModel] | None, str]:
    """The model inside an annotation, and whether it stands alone, in a tuple or in a dictionary."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation, "alone"
    kind = getattr(get_origin(annotation), "__name__", "")
    for part in get_args(annotation):
        inner, _ = _inner(part)
        if inner is not None:
            return inner, kind
    return None, ""


def _named(annotation: Any) -> str:
    inner, kind = _inner(annotation)
    if inner is not None:
        return (
            "quantity" if issubclass(inner, Quantity) else "tables" if kind in ("tuple", "dict") else "table"
        )
    if get_origin(annotation) is Literal:
        return ", ".join(code(f'"{choice}"') for choice in get_args(annotation))
    if get_origin(annotation) is tuple:
        return "list of " + _named(get_args(annotation)[0])
    if get_origin(annotation) is dict:
        return "table of " + _named(get_args(annotation)[1])
    names = {str: "text", float: "number", int: "integer", bool: "true or false", Any: "anything"}
    parts = [a for a in get_args(annotation) if a is not type(None)]
    return _named(parts[0]) if parts else names.get(annotation, str(annotation))
