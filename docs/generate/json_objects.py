"""What each command prints with --json: keys, types, units, meaning, and a real example.

Types are those of the kept examples; meanings stand in json_texts.toml. A test runs the commands again.
"""

import json
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from generate.markdown import code, fence, table
from smarig.config import unit_of

HERE = Path(__file__).resolve().parent
LONGEST = 6  # longer lists, and objects of like things, are shown by their first two
TYPES = {"str": "text", "int": "integer", "float": "number", "bool": "true or false", "NoneType": "null"}
HEAD = """# JSON

With `--json` a command prints one object to stdout, and everything else to stderr. Values that JSON cannot represent as
a number (not a number, infinite) are `null`. Paths are as given. If a command fails, the object is
`{"error": "…", "exit_status": 2}`.

`a.b` is a key in an object, `a[].b` is a key in each object of a list, and `*` stands for any name. The unit *out* is
that of the output, which the object gives as `unit`. The numbers in the examples are from one run on the twin. "…"
stands for more entries of the same kind.
"""
Types = dict[str, set[str]]


def pages() -> dict[str, str]:
    """One page: a chapter for each command."""
    return {"json_objects": HEAD + "".join(_chapter(name) for name in texts() if name != "see")}


@cache
def texts() -> dict[str, dict[str, Any]]:
    """Meanings by command and key."""
    return tomllib.loads((HERE / "json_texts.toml").read_text(encoding="utf-8"))


@cache
def examples() -> tuple[tuple[str, dict[str, Any]], ...]:
    """(command line, object) as they were kept."""
    kept = json.loads((HERE / "json_examples.json").read_text(encoding="utf-8"))
    return tuple((e["command"], e["output"]) for e in kept)


def paths(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """(path, type's name) of every value that holds no others."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from paths(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and value:
        for inner in value:
            yield from paths(inner, f"{path}[]")
    elif isinstance(value, list):
        yield f"{path}[]", "empty"
    elif not isinstance(value, dict):
        yield path, type(value).__name__


def explanation_key(command: str, path: str) -> str | None:
    """The key of json_texts.toml that a path is explained by; None for a path that nobody has explained.

    Of an empty list of objects only its name is seen.
    """
    for known in texts().get(command, {}):
        if known == "**" or matches(known, path) or (path.endswith("[]") and known.startswith(f"{path}.")):
            return known
    for prefix, other in texts()["see"].get(command, {}).items():
        deep = prefix.count(".") + 1
        parts = path.split(".")
        if matches(prefix, ".".join(parts[:deep])) and explanation_key(other, ".".join(parts[deep:])):
            return prefix
    return None


def matches(pattern: str, path: str) -> bool:
    """Whether a path is what a pattern says, part by part; a name at its end may hold dots of its own.

    >>> matches("a.*.c", "a.b.c"), matches("a.*.c", "a.b"), matches("a.*.*", "a.b.c.d")
    (True, False, True)
    """
    pattern_parts, path_parts = pattern.split("."), path.split(".")
    if pattern_parts[-1] == "*":
        path_parts = (
            [*path_parts[: len(pattern_parts) - 1], ".".join(path_parts[len(pattern_parts) - 1 :])]
            if path_parts[len(pattern_parts) - 1 :]
            else []
        )
    return len(pattern_parts) == len(path_parts) and all(
        _part(a, g) for a, g in zip(pattern_parts, path_parts)
    )


def _part(pattern_parts: str, path_parts: str) -> bool:
    brackets = pattern_parts.count("[]")
    return pattern_parts == path_parts or (
        pattern_parts.startswith("*") and path_parts.count("[]") == brackets
    )


def _of(command: str) -> list[tuple[str, dict[str, Any]]]:
    return [(line, output) for line, output in examples() if line.split()[1] == command]


def _types(command: str) -> Types:
    found: Types = {}
    for _, output in _of(command):
        for path, kind in paths(output):
            found.setdefault(explanation_key(command, path) or path, set()).add(kind)
    return found


def _chapter(command: str) -> str:
    types, meanings = _types(command), texts()[command]
    rows = [_row(command, key, text, types.get(key, set())) for key, text in meanings.items()]
    shown = {tuple(output): (line, output) for line, output in reversed(_of(command))}.values()
    parts = [f"\n## smarig {command}\n", table(("key", "type", "unit", "means"), rows)]
    for line, output in list(shown)[::-1]:
        parts += [fence("sh", f"{line} --json"), fence("json", _short(output))]
    return "\n".join(parts)


def _row(command: str, key: str, text: str | list[str], kinds: set[str]) -> tuple[str, str, str, str]:
    unit, means = (
        text if isinstance(text, list) else (unit_of(key.rsplit(".", 1)[-1].removesuffix("[]")), text)
    )
    other = texts()["see"].get(command, {}).get(key)
    if other:
        return code(key), "object", "", f"{means}; keys as of [smarig {other}](#smarig-{other})"
    return code(key.replace("**", "*")), _type(kinds), unit, means


def _type(kinds: set[str]) -> str:
    """Integers beside numbers are numbers; empty lists say nothing."""
    shown = kinds - {"empty"} - ({"int"} if "float" in kinds else set())
    return " or ".join(TYPES[k] for k in sorted(shown, key=list(TYPES).index))


def _short(value: Any) -> str:
    return json.dumps(_cut(value), indent=1, ensure_ascii=False)


def _cut(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.4g}")
    many = isinstance(value, (dict, list)) and len(value) > LONGEST
    if isinstance(value, dict):
        same_shape = many and len({type(v) for v in value.values()}) == 1
        kept = {k: _cut(v) for k, v in list(value.items())[: 2 if same_shape else None]}
        return kept | ({"…": "…"} if same_shape else {})
    if isinstance(value, list):
        return [_cut(v) for v in value[: 2 if many else None]] + (["…"] if many else [])
    return value
