"""The effects: what each does, its parameters, what it looks like and what it is confused with."""

import importlib

from generate.docstring import as_markdown
from generate.markdown import code, plain, table
from smarig.plant import EffectType, effect_types

HEAD = """# Effects

Physical mechanisms that a twin may have in addition to heating and hysteresis.
`smarig run … --effect NAME.PARAMETER=VALUE` injects one; a diagnosis looks for the same effects. `NAME=VALUE` sets the
first parameter. At zero strength an effect changes nothing, bit for bit.
"""


def pages() -> dict[str, str]:
    """One page."""
    rows = [
        (f"[{k.name}](#{k.name.replace('_', '-')})", plain(k.summary), k.arrangement) for k in effect_types()
    ]
    head = HEAD + "\n" + table(("effect", "what happens", "only on"), rows)
    return {"effects": head + "".join(map(_chapter, effect_types()))}


def _chapter(kind: EffectType) -> str:
    parameters = [
        (code(p.name), p.unit, f"{p.typical:g}", f"{p.lower:g} … {p.upper:g}", plain(p.source))
        for p in kind.parameters
    ]
    rows = [
        ("enters", plain(kind.enters)),
        ("looks like", plain(kind.looks_like)),
        ("confused with", ", ".join(f"[{n}](#{n.replace('_', '-')})" for n in kind.confused_with)),
        ("distinguished by", plain(kind.separated_by)),
        ("against it", plain(kind.remedy)),
    ]
    docstring_text = importlib.import_module(f"smarig.plant.effects.{kind.name}").__doc__ or ""
    return "\n".join(
        [
            f"\n## {kind.name}\n",
            as_markdown(docstring_text),
            "",
            table(("parameter", "unit", "typical", "range", "from"), parameters),
            table(("", ""), [row for row in rows if row[1]]),
        ]
    )
