"""What a person asks the queue to do: the arguments of ``smarig run`` or ``smarig characterise``.

The command line of an entry: what the worker starts, and what people can copy.
"""

import json
import shlex
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from smarig.config import shipped_names
from smarig.core import DataError, UsageError, catalogue_names, shown

Kind = Literal["protocol", "campaign", "characterise"]
KINDS: tuple[str, ...] = get_args(Kind)
_MOST_CHARACTERS = 50_000  # of all arguments: the system accepts twice as many of each
_ONLY_OF_RUN = ("settings", "speed", "load", "notes")  # ``smarig characterise`` does not have them


@dataclass(frozen=True)
class EntryRequest:
    """One experiment. Paths are relative to the folder of the queue; texts are those of the command line.

    ``out`` is a run file, or a folder for a campaign and a characterisation. ``settings`` are those of a protocol.
    """

    kind: Kind
    experiment: str
    rig: str
    out: str
    settings: dict[str, str] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    seed: int = 0
    speed: float | None = None
    load: str = ""
    wire: str = ""
    notes: str = ""

    def to_json(self) -> str:
        """As it is stored."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "EntryRequest":
        """As it was stored. Raises DataError."""
        try:
            values = json.loads(text)
            arguments: dict[str, Any] = {**values, "effects": tuple(values["effects"])}
            request = cls(**arguments)
            check_request(request)
        except (ValueError, TypeError, KeyError, UsageError) as error:
            raise DataError(f"The arguments {shown(text)} of a queue are damaged: {error}") from None
        return request


def check_request(request: EntryRequest) -> None:
    """Raise UsageError for arguments that no command line could hold, or that the kind does not have.

    Names and values are checked by the command itself, when it previews them.
    """
    if request.kind not in KINDS:
        raise UsageError(f"There is no kind of entry {shown(request.kind)}. There are: {', '.join(KINDS)}.")
    texts = _texts(request)
    for text in texts:
        _check_text(text)
    if sum(map(len, texts)) > _MOST_CHARACTERS:
        raise UsageError(f"The arguments of an entry may have {_MOST_CHARACTERS} characters together.")
    for name in ("experiment", "rig", "out"):
        if not getattr(request, name).strip():
            raise UsageError(f"An entry needs the argument '{name}'.")
    if request.experiment.startswith("-"):  # it would be read as an option
        raise UsageError(f"There is no protocol or campaign {shown(request.experiment)}.")
    given = [name for name in _ONLY_OF_RUN if getattr(request, name) not in ({}, None, "")]
    if request.kind == "characterise" and given:
        raise UsageError(f"'smarig characterise' has no argument '{given[0]}'. Queue a campaign instead.")
    _check_kind(request)


def _check_kind(request: EntryRequest) -> None:
    """A campaign writes a folder and a protocol writes a file, so one must not be taken for the other."""
    name = request.experiment
    named_so = name in shipped_names("campaigns") and name not in catalogue_names("smarig.protocols")
    is_campaign = name.endswith(".toml") or named_so
    if is_campaign and request.kind == "protocol":
        raise UsageError(f"{shown(name)} is a campaign, not a protocol.")
    if not is_campaign and request.kind != "protocol":
        known = ", ".join(shipped_names("campaigns"))
        raise UsageError(f"{shown(name)} is no campaign. Give a file NAME.toml, or one of: {known}.")


def _texts(request: EntryRequest) -> list[Any]:
    named = [request.experiment, request.rig, request.out, request.load, request.wire, request.notes]
    return [*named, *request.effects, *request.settings, *request.settings.values()]


def _check_text(text: Any) -> None:
    if not isinstance(text, str):
        raise UsageError(f"An argument must be text, not {shown(text)}.")
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        raise UsageError(f"The argument {text!a} is not UTF-8 text.") from None
    if "\0" in text:
        raise UsageError(f"The argument {shown(text)} holds a null character.")


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
