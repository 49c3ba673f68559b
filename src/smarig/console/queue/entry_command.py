"""The command line of an entry: what the worker starts, and what people can copy."""

import shlex
from pathlib import Path

from smarig.console.queue.entry_request import EntryRequest


def entry_command(request: EntryRequest, *, continued: bool = False) -> list[str]:
    """The arguments, from ``smarig`` on. Relative paths start at the folder of the queue.

    >>> shlex.join(entry_command(EntryRequest("protocol", "validation", "one_wire_twin", "v.run.sqlite", seed=1)))
    'smarig run validation --rig one_wire_twin --out v.run.sqlite --seed 1'
    """
    options = [("--rig", request.rig), ("--out", request.out)]
    options += [("--set", f"{key}={value}") for key, value in request.settings.items()]
    options += [("--effect", effect) for effect in request.effects]
    options += [("--seed", str(request.seed))] if request.seed else []
    options += [("--speed", f"{request.speed:g}")] if request.speed is not None else []
    texts = (("--load", request.load), ("--wire", request.wire), ("--notes", request.notes))
    options += [(name, value) for name, value in texts if value]
    is_run = request.kind != "characterise"
    start = ["run", request.experiment] if is_run else ["characterise", "--campaign", request.experiment]
    words = [word for name, value in options for word in _option(name, value)]
    return ["smarig", *start, *words, *(["--continue"] if continued else [])]


def shown_command(request: EntryRequest, folder: Path, *, continued: bool = False) -> str:
    """The command as a line of a shell that can be copied into a terminal anywhere."""
    command = shlex.join(entry_command(request, continued=continued))
    return f"cd {shlex.quote(str(folder.resolve()))} && {command}"


def _option(name: str, value: str) -> list[str]:
    """As one word where the value would be read as another option."""
    return [f"{name}={value}"] if value.startswith("-") else [name, value]
