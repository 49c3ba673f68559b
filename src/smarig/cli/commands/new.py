"""``smarig new``: a commented starting file of your own, which works as it stands.

The starting points are files of that kind themselves, called ``my_KIND``; only that word is replaced.
"""

import re
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path

import click

from smarig.cli.output import emit, json_option
from smarig.cli.parameter_types import FILE
from smarig.config import shipped_names
from smarig.core import UsageError, atomic_file, catalogue_names

_TEMPLATES = Path(__file__).parents[1] / "starting_points"
_PACKAGES = {
    "protocol": "smarig.protocols",
    "controller": "smarig.control.tracking.controllers",
    "effect": "smarig.plant.effects",
    "driver": "smarig.device.drivers",
}
_DEVICES = {"CON", "PRN", "AUX", "NUL", *(f"{port}{k}" for port in ("COM", "LPT") for k in range(10))}
_NEXT_STEP = {
    "rig": "smarig check {file}",
    "actuator": 'name it in a rig file in the same folder: actuator = "./{file_name}"',
    "protocol": "smarig run {file} --rig one_wire_twin -o {name}.run.sqlite",
    "controller": "smarig track MODEL --reference ramps --controller {file} --rig one_wire_twin -o {name}.run.sqlite",
    "effect": "smarig run validation --rig one_wire_twin --effect {file} -o {name}.run.sqlite",
    "driver": 'name it in a rig file in the same folder: driver = "./{file_name}"',
    "campaign": "smarig run {file} --rig one_wire_twin --dry-run",
}

EPILOG = """\b
Examples:
  smarig new protocol two_loops
  smarig run ./two_loops.py --rig one_wire_twin -o two_loops.run.sqlite
  smarig new rig bench_3 -o rigs/bench_3.toml
"""


@click.command("new", epilog=EPILOG)
@click.argument("kind", type=click.Choice(list(_NEXT_STEP)))
@click.argument("name")
@click.option("-o", "--out", type=FILE, help="File to write; default: NAME.toml or NAME.py in this folder.")
@json_option
def command(kind: str, name: str, out: Path | None) -> None:
    """Write a commented starting file: a rig, actuator, protocol, controller, effect, driver or campaign of your own.

    It works as it stands, and is used by its path. Nothing existing is overwritten.
    """
    template = next(_TEMPLATES.glob(f"my_{kind}.*"))
    file = out or Path(name + template.suffix)
    _check(kind, name, file, template.suffix)
    text = re.sub(rf"\bmy_{kind}\b", name, template.read_text(encoding="utf-8"))
    with atomic_file(file, force=False) as part:
        part.write_text(text, encoding="utf-8")
    shown = str(file) if file.is_absolute() else f"./{file}"
    next_step = _NEXT_STEP[kind].format(file=shown, file_name=file.name, name=name)
    emit(
        {"kind": kind, "name": name, "file": str(file), "next": next_step},
        f"{shown} is written. Next: {next_step}",
    )


def _check(kind: str, name: str, file: Path, suffix: str) -> None:
    """UsageError where the name could not be used, or a file would be lost."""
    reason = _unusable(kind, name, python=suffix == ".py")
    if reason:
        raise UsageError(f"{name!r} is no name for a {kind}: {reason}.")
    taken_names = catalogue_names(_PACKAGES[kind]) if kind in _PACKAGES else shipped_names(f"{kind}s")
    if name in taken_names:
        raise UsageError(f"'{name}' is one of the {kind}s that ship: give yours another name.")
    if file.suffix != suffix or (suffix == ".py" and file.stem != name):
        expected = f"{name}.py, as what it defines is" if suffix == ".py" else "…toml"
        raise UsageError(f"{file}: the file of a {kind} is called {expected}.")
    if file.exists():
        raise UsageError(f"{file} exists; give another name, or another place with -o.")
    if suffix == ".py" and _importable(name):
        raise UsageError(
            f"'{name}' is the name of a Python module, which {file.name} would hide: take another."
        )


def _unusable(kind: str, name: str, *, python: bool) -> str:
    """Why a name is none, "" if it is one."""
    if not name.isidentifier() or not name.isascii() or name.startswith("_"):
        return "letters, digits and _, a letter first"
    if python and iskeyword(name):
        return f"it is a word of Python's own, and what defines a {kind} is called as it is"
    return "Windows keeps it for a device" if name.upper() in _DEVICES else ""


def _importable(name: str) -> bool:
    """Whether ``import NAME`` means something already; nothing is imported."""
    try:
        return find_spec(name) is not None
    except ValueError:  # it is loaded, and does not say from where
        return True
