"""``smarig new``: write a commented template that works unchanged, or a package of plug-ins.

The templates are valid files named ``my_KIND``. Only that word is replaced.
"""

import re
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path

import click

from smarig.cli.output import emit, json_option
from smarig.cli.parameter_types import ANY_PATH
from smarig.cli.plugin_package import PLUGIN_KINDS, plugin_names, write_plugin_package
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
  smarig new plugin my_lab --kind effect --kind protocol
"""


@click.command("new", short_help="Write a commented template for your own file.", epilog=EPILOG)
@click.argument("kind", type=click.Choice([*_NEXT_STEP, "plugin"]))
@click.argument("name")
@click.option(
    "--kind",
    "plugin_kinds",
    multiple=True,
    type=click.Choice(list(PLUGIN_KINDS)),
    help="plugin: an example of this kind; repeatable (default: effect).",
)
@click.option(
    "-o",
    "--out",
    type=ANY_PATH,
    help="File to write (default: NAME.toml or NAME.py in this folder); plugin: a new folder (default: NAME).",
)
@json_option
def command(kind: str, name: str, plugin_kinds: tuple[str, ...], out: Path | None) -> None:
    """Write a commented template for your own rig, actuator, protocol, controller, effect, driver or campaign.

    The file works unchanged. Commands accept the path of this file. An existing file is not overwritten.

    plugin: write a Python package of plug-ins, which other people can install. It contains tests and a README.
    """
    if kind == "plugin":
        _write_plugin(name, list(dict.fromkeys(plugin_kinds or ("effect",))), out or Path(name))
        return
    if plugin_kinds:
        raise UsageError(f"--kind belongs to smarig new plugin, not to smarig new {kind}. Leave it out.")
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
        f"{shown} written. Next: {next_step}",
    )


def _write_plugin(name: str, kinds: list[str], folder: Path) -> None:
    module = name.replace("-", "_")
    reason = _unusable("plugin", module, python=True)
    if reason or not name[-1].isalnum():
        raise UsageError(
            f"{name!r} cannot be the name of a plugin: {reason or 'end it with a letter or digit'}."
        )
    if _importable(module):
        raise UsageError(f"The package '{module}' would hide a Python module. Choose another name.")
    examples = plugin_names(module, kinds)
    written = write_plugin_package(name, module, kinds, folder)
    shown = (
        str(folder) if folder.is_absolute() else f"./{folder}"
    )  # pip takes a bare name for one of its index
    next_step = f'python -m pip install -e "{shown}[test]" && python -m pytest {shown}'
    emit(
        {
            "kind": "plugin",
            "name": name,
            "file": str(folder),
            "next": next_step,
            "files": [str(path.relative_to(folder)) for path in written],
            "plugins": examples,
        },
        f"{shown} written, with {', '.join(examples.values())}. Next: {next_step}",
    )


def _article(kind: str) -> str:
    return "an" if kind[0] in "aeiou" else "a"


def _check(kind: str, name: str, file: Path, suffix: str) -> None:
    """Raise UsageError if the name is not usable or a file would be overwritten."""
    from smarig.config import shipped_names

    reason = _unusable(kind, name, python=suffix == ".py")
    if reason:
        raise UsageError(f"{name!r} cannot be the name of {_article(kind)} {kind}: {reason}.")
    taken_names = catalogue_names(_PACKAGES[kind]) if kind in _PACKAGES else shipped_names(f"{kind}s")
    if name in taken_names:
        raise UsageError(f"'{name}' is the name of a shipped {kind}. Choose another name.")
    if file.suffix != suffix or (suffix == ".py" and file.stem != name):
        expected = f"{name}.py, like the object that it defines" if suffix == ".py" else "…toml"
        raise UsageError(f"{file}: the file of {_article(kind)} {kind} must be named {expected}.")
    if file.exists():
        raise UsageError(f"{file} exists. Give another name, or another path with -o.")
    if suffix == ".py" and _importable(name):
        raise UsageError(f"{file.name} would hide the Python module '{name}'. Choose another name.")


def _unusable(kind: str, name: str, *, python: bool) -> str:
    """Why a name is not usable, or "" if it is usable."""
    if not name.isidentifier() or not name.isascii() or name.startswith("_"):
        return "use letters, digits and _, with a letter first"
    if python and iskeyword(name):
        return f"it is a Python keyword, and the {kind} is defined under its name"
    return "Windows reserves it for a device" if name.upper() in _DEVICES else ""


def _importable(name: str) -> bool:
    """Whether ``import NAME`` would find a module. Nothing is imported."""
    try:
        return find_spec(name) is not None
    except ValueError:  # a loaded module without a spec
        return True
