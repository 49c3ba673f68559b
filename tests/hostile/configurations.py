"""Configuration files in TOML: rigs, actuators, mappings and campaigns with absurd structures and values."""

from hostile.material import Material
from hostile.run_structures import Maker, later
from hostile.tables import text


def rig(old: str, new: str) -> Maker:
    """The twin's rig file with a replaced text."""

    def make(m: Material, path) -> None:
        before = m.text("rig.toml")
        assert old in before, old
        path.write_text(before.replace(old, new), encoding="utf-8")

    return make


def mapping(old: str, new: str) -> Maker:
    """The mapping with a replaced text."""

    def make(m: Material, path) -> None:
        before = m.text("map.toml")
        assert old in before, old
        path.write_text(before.replace(old, new), encoding="utf-8")

    return make


def with_path(template: str) -> Maker:
    """A file whose text names the secret or the Python file."""
    return lambda m, path: path.write_text(
        template.format(secret=m.secret, evil=m.evil, mine=path), encoding="utf-8"
    )


CAMPAIGN = 'name = "c"\nsummary = "s"\n[[step]]\nprotocol = "validation"\n'
CONFIGURATIONS: dict[str, Maker] = {
    "deep lists": later(lambda: text("x = " + "[" * 100_000 + "]" * 100_000)),
    "open lists": later(lambda: text("x = " + "[" * 100_000)),
    "deep tables": text("x = " + "{a=" * 50_000 + "1" + "}" * 50_000),
    "deep keys": text(".".join(["a"] * 5_000) + " = 1"),
    "deep header": text("[" + ".".join(["a"] * 5_000) + "]\nx = 1"),
    "an endless integer": later(lambda: text("x = " + "9" * 100_000)),
    "an endless integer in a rig": rig("period_s = 0.1", "period_s = " + "9" * 5_000),
    "an endless float": later(lambda: rig("period_s = 0.1", "period_s = " + "9" * 100_000 + ".0")),
    "an endless hexadecimal": later(lambda: rig("period_s = 0.1", "period_s = 0x" + "f" * 100_000)),
    "an endless name": later(lambda: rig('name = "one_wire_twin"', f'name = "{"n" * 5_000_000}"')),
    "an endless key": later(lambda: text("k" * 2_000_000 + " = 1")),
    "100 000 keys": later(lambda: text("\n".join(f"k{k} = 1" for k in range(100_000)))),
    "100 000 tables": later(lambda: text("\n".join(f"[t{k}]" for k in range(100_000)))),
    "100 000 steps": later(
        lambda: text('name = "c"\nsummary = "s"\n' + '[[step]]\nprotocol = "validation"\n' * 30_000)
    ),
    "bytes of no text": lambda _, path: path.write_bytes(b"name = '\xff\xfe'"),
    "zero bytes": text("name = '\x00'"),
    "a byte order mark": text('\ufeffname = "x"'),
    "UTF-16": text('name = "x"', "utf-16"),
    "empty": text(""),
    "a number": text("7"),
    "open quote": text("name = '"),
    "escape sequences": rig('name = "one_wire_twin"', 'name = "\\u001b[2J\\u001b]0;x\\u0007"'),
    "lines in a name": rig('name = "one_wire_twin"', 'name = "a\\nsmarig: done"'),
    "name of a path": rig('wire = "twin-one-wire"', 'wire = "../../../x"'),
    "infinite period": rig("period_s = 0.1", "period_s = inf"),
    "no number for a period": rig("period_s = 0.1", "period_s = nan"),
    "negative period": rig("period_s = 0.1", "period_s = -0.1"),
    "dates": rig("period_s = 0.1", "period_s = 1979-05-27T07:32:00Z"),
    "period as a truth": rig("period_s = 0.1", "period_s = true"),
    "huge resolution": rig("counts_per_rev = 2000", f"counts_per_rev = {10**18}"),
    "no resolution": rig("counts_per_rev = 2000", "counts_per_rev = 0"),
    "actuator is the secret": with_path('name = "x"\nkind = "twin"\nactuator = "{secret}"\n'),
    "base is the secret": with_path('base = "{secret}"\n'),
    "its own base": with_path('base = "{mine}"\n'),
    "base as a list": text("base = [1]"),
    "own protocol": with_path('name = "c"\nsummary = "s"\n[[step]]\nprotocol = "{evil}s"\n'),
    "campaign of endless points": text(CAMPAIGN + "set = { points = 1000000000 }\n"),
    "campaign of deep settings": text(CAMPAIGN + "set = { points = " + "[" * 300 + "]" * 300 + " }\n"),
    "mapping of empty names": mapping('column = "H"', 'column = ""'),
    "mapping of a formula": mapping('unit = "T"', 'unit = "=cmd|calc!A0"'),
    "mapping of a long unit": later(lambda: mapping('unit = "T"', f'unit = "{"m" * 100_000}"')),
    "mapping of a deep unit": mapping('unit = "T"', f'unit = "{"(" * 5_000}m{")" * 5_000}"'),
    "mapping of powers": mapping('unit = "T"', 'unit = "m^9999999999"'),
    "mapping of infinite scale": mapping('unit = "T" }', 'unit = "T", scale = inf }'),
    "mapping of zero scale": mapping('unit = "T" }', 'unit = "T", scale = 0.0 }'),
    "mapping of tables": later(
        lambda: mapping("[columns]", f'[file]\nheader_starts = "{"x" * 100_000}"\n[columns]')
    ),
    "endless device": lambda _, path: path.symlink_to("/dev/zero"),
}
