"""The keys of configuration files, from the models that check them: type, unit, default, bounds, meaning.

A meaning is the comment after the key in its model. Texts are plain; ``double`` backticks mean code.
"""

import ast
import inspect
import io
import json
import textwrap
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo

from smarig.config.quantity import InUnit, Quantity

UNITS = {
    "A": "A", "A_per_s": "A/s", "A2s": "A² s", "K": "K", "V": "V", "counts": "counts", "degC": "°C", "mm": "mm",
    "ohm": "ohm", "s": "s", "W_per_K": "W/K", "h": "h", "min": "min", "C": "°C", "K_per_A2": "K/A²", "N": "N",
    "MPa": "MPa",
}  # fmt: skip


@dataclass(frozen=True)
class FileKey:
    """A key of a table. ``default``: "needed" without one, "" for an empty one."""

    name: str
    type: str
    unit: str
    default: str
    meaning: str

    @property
    def text(self) -> str:
        """In one line, without the name."""
        default = self.default if self.default in ("", "needed") else f"default {self.default}"
        facts = ", ".join(part for part in (self.type, self.unit, default) if part).replace("`", "")
        return f"{facts}: {self.meaning.replace('``', '')}"


def file_keys(model: type[BaseModel]) -> list[FileKey]:
    """The keys of a table, in the order of its model.

    >>> from smarig.config import RigFile
    >>> next(key for key in file_keys(RigFile) if key.name == "period_s").unit
    's'
    """
    comments = class_comments(model)
    return [
        FileKey(name, _bounded_type(field), _unit(name, field), _default(field), comments.get(name, ""))
        for name, field in model.model_fields.items()
    ]


def file_tables(model: type[BaseModel], where: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """(TOML's header, model) of a file and of every table in it, outer ones first."""
    yield where, model
    for name, field in model.model_fields.items():
        inner, kind = _inner(field.annotation)
        path = f"{where.strip('[]')}.{name}" if where else name
        if inner is not None and not issubclass(inner, Quantity):
            bare = path if kind != "dict" else f"{path}.NAME"
            yield from file_tables(inner, f"[{bare}]" if kind == "tuple" else bare)


def unit_of(name: str) -> str:
    """The unit that a name ends in.

    >>> unit_of("current_rate_A_per_s"), unit_of("period_s"), unit_of("wire")
    ('A/s', 's', '')
    """
    endings = [name.split("_", k)[-1] for k in range(1, name.count("_") + 1)]
    return next((UNITS[e] for e in endings if e in UNITS), "")


def type_text(annotation: Any) -> str:
    """What a value may be: "number", "list of text", …"""
    inner, kind = _inner(annotation)
    if inner is not None:
        return (
            "quantity" if issubclass(inner, Quantity) else "tables" if kind in ("tuple", "dict") else "table"
        )
    if get_origin(annotation) is Literal:
        return ", ".join(f"`{json.dumps(choice, ensure_ascii=False)}`" for choice in get_args(annotation))
    if get_origin(annotation) is tuple:
        return "list of " + type_text(get_args(annotation)[0])
    if get_origin(annotation) is dict:
        return "table of " + type_text(get_args(annotation)[1])
    names = {str: "text", float: "number", int: "integer", bool: "true or false", Any: "anything"}
    parts = [a for a in get_args(annotation) if a is not type(None)]
    return type_text(parts[0]) if parts else names.get(annotation, str(annotation))


def class_comments(cls: type) -> dict[str, str]:
    """Comments after the annotated names of a class and of those it inherits from."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        if base.__module__.startswith(cls.__module__.partition(".")[0]):
            found |= _annotated(inspect.getsource(base))
    return found


def comments_by_line(source: str) -> dict[int, str]:
    """The comment of each line that has one."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return {t.start[0]: t.string.lstrip("# ") for t in tokens if t.type == tokenize.COMMENT}


def inner_model(annotation: Any) -> tuple[type[BaseModel] | None, bool]:
    """The model inside an annotation, None for plain values; whether it is one of a list."""
    inner, kind = _inner(annotation)
    return inner, kind == "list"


def _annotated(source: str) -> dict[str, str]:
    source = textwrap.dedent(source)
    comments = comments_by_line(source)
    (body,) = (node.body for node in ast.parse(source).body if isinstance(node, ast.ClassDef))
    return {
        node.target.id: comments.get(node.end_lineno or 0, "")
        for node in body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    value = field.get_default(call_default_factory=True, validated_data={})
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    empty = value is None or isinstance(value, BaseModel) or value in ((), {}, "")
    return (
        ""
        if empty
        else f"`{json.dumps(value, ensure_ascii=False)}`"
        if isinstance(value, str)
        else f"`{value}`"
    )


def _unit(name: str, field: FieldInfo) -> str:
    validators = (m.func for m in field.metadata if isinstance(m, AfterValidator))
    return next((f.unit for f in validators if isinstance(f, InUnit)), unit_of(name))


def _bounded_type(field: FieldInfo) -> str:
    bounds = [_bound(m) for m in field.metadata]
    return ", ".join([type_text(field.annotation), *(b for b in bounds if b)])


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
