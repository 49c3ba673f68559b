"""Generates the C header and the reference page from the register maps.

``python -m smarig.device.encoding.generate`` writes both; ``--check`` reports whether they are up to date.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from smarig.core import shipped
from smarig.device.encoding.register import DeviceFault, Register, RegisterMap, Value, load_register_map

DEVICES = ("amplifier", "encoder_daq")
GENERATED_NOTE = (
    "made by python -m smarig.device.encoding.generate from the maps in firmware_protocol; do not edit"
)


def header() -> str:
    """``smarig_registers.h``: addresses, sizes, limits, safe values, orders, faults, hashes."""
    lines = [f"/* {GENERATED_NOTE} */", "#ifndef SMARIG_REGISTERS_H", "#define SMARIG_REGISTERS_H", ""]
    for name in DEVICES:
        lines += _defines(load_register_map(name))
    return "\n".join([*lines, "#endif", ""])


def _defines(m: RegisterMap) -> Iterator[str]:
    short = "AMP" if m.device.name == "amplifier" else "DAQ"
    yield f"/* {m.device.name}: {m.device.summary} */"
    for key in ("kind", "version", "default_address"):
        yield f"#define {short}_DEVICE_{key.upper()} {getattr(m.device, key)}u"
    yield f"#define {short}_DEVICE_MAP_HASH 0x{m.hash:08X}ul"
    for block in m.blocks:
        yield f"#define {short}_{block.upper()}_FIRST 0x{m.start(block):04X}u"
        yield f"#define {short}_{block.upper()}_WORDS {m.size(block)}u"
    for r in m.registers.values():
        yield from _register(f"{short}_{r.name.upper()}", r)
    for fault in m.faults.values():
        yield f"#define {short}_FAULT_{fault.name.upper()} {fault.code}u"
    yield ""


def _register(name: str, r: Register) -> Iterator[str]:
    yield f"#define {name} 0x{r.address:04X}u"
    if r.access == "rw":
        low, high = r.limits
        yield f"#define {name}_LEAST {_number(low)}"
        yield f"#define {name}_MOST {_number(high)}"
        yield f"#define {name}_SAFE {_number(r.safe or 0)}"
    if r.none is not None:
        yield f"#define {name}_NONE ({r.none})"
    for number, value in r.values.items():
        yield f"#define {name}_{value.upper()} {number}u"
    if r.field:
        yield f"#define {name}_RECORDS {r.count}u"
        yield f"#define {name}_RECORD_WORDS {r.record_words}u"
    for field in r.field:
        if field.none is not None:
            yield f"#define {name}_{field.name.upper()}_NONE ({field.none})"
        for bit, flag in field.flags.items():
            yield f"#define {name}_{field.name.upper()}_{flag.upper()} {1 << int(bit)}u"


def _number(raw: int) -> str:
    return f"({raw}l)" if raw < 0 else f"{raw}ul" if raw > 0x7FFFFFFF else f"{raw}l"


def reference() -> str:
    """The text of ``docs/reference/registers.md``."""
    return (
        f"<!-- {GENERATED_NOTE} -->\n# Registers\n\n"
        "firmware_protocol/README.md describes how requests and replies carry them.\n"
        + "".join(_chapter(load_register_map(name)) for name in DEVICES)
    )


def _chapter(m: RegisterMap) -> str:
    d = m.device
    rows = "".join(_row(f"0x{r.address:04X}", r, _limits(r)) for r in m.registers.values())
    fields = "".join(_row("", f, "") for r in m.registers.values() for f in r.field)
    faults = "".join(map(_fault, m.faults.values()))
    return f"""
## {d.name}

{d.summary} Kind 0x{d.kind:04X}, map version {d.version}, hash {m.hash:08X}, Modbus address {d.default_address} by
default.

| address | register | type | unit | may be written | |
|---|---|---|---|---|---|
{rows}
Each sample of the ring:

| | value | type | unit | | |
|---|---|---|---|---|---|
{fields}
| code | fault | cause | what to do |
|---|---|---|---|
{faults}"""


def _row(address: str, v: Register | Value, limits: str) -> str:
    unit = f"{v.lsb:g} {v.unit}" if v.lsb != 1 else v.unit
    return f"| {address} | `{v.name}` | {v.type} | {unit} | {limits} | {v.text} |\n"


def _limits(r: Register) -> str:
    if r.access == "r":
        return ""
    names = ", ".join(f"{number} {name}" for number, name in r.values.items())
    return f"{names or ' … '.join(map(str, r.limits))}; safe {r.safe}"


def _fault(f: DeviceFault) -> str:
    return f"| {f.code} | {f.name} | {f.cause} | {f.remedy} |\n"


def outdated(write: bool) -> list[Path]:
    """Files that differ from the maps; they are rewritten if ``write``."""
    root = shipped("firmware_protocol")
    wanted = {
        root / "firmware" / "smarig_registers.h": header(),
        root.parent / "docs" / "reference" / "registers.md": reference(),
    }
    old = [path for path, text in wanted.items() if not path.is_file() or path.read_text("utf-8") != text]
    for path in old if write else ():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(wanted[path], encoding="utf-8")
    return old


if __name__ == "__main__":
    check = "--check" in sys.argv
    found = outdated(write=not check)
    for path in found:
        sys.stderr.write(
            f"{path} {'is not up to date: python -m smarig.device.encoding.generate' if check else 'written'}\n"
        )
    sys.exit(1 if check and found else 0)
