"""The command line, from click's own objects: usage, arguments, options, examples."""

import inspect
import re
from collections.abc import Iterator

import click

from generate.markdown import code, fence, plain, table
from smarig.cli import cli

HEAD = """# Commands

Every command has `--help`, which prints the text of this page, and `--json`, which prints one object to stdout and
everything else to stderr ([JSON](json_objects.md)).

`smarig --plugin NAME COMMAND` imports a plug-in that a model, run or rig file of the command needs. It may be repeated
([plug-ins](../../how_to/write_a_plugin.md)).

| exit status | meaning |
|---|---|
| 0 | done |
| 1 | an internal error of smarig; `SMARIG_DEBUG=1` shows the traceback |
| 2 | usage or configuration error |
| 3 | the rig tripped, refused, or could not be reached |
| 4 | data error, or a file that cannot be written |
| 5 | another process uses the wire, a line of the rig, or the run file |
| 130 | interrupted; the rig is safe |

`SMARIG_LOCK_DIR` names the folder of the locks of wires, lines and run files in use (else each user has one; users who
share a rig give the same folder), `SMARIG_HISTORY_DIR` the folder of the wires' histories, `SMARIG_CACHE_DIR` that of
compiled loops (else `smarig/compiled` in the user's cache folder; it may be deleted), `SMARIG_RUNNING_DIR` the folder
in which runs announce themselves to the user's other processes (else one in main memory). A twin locks no wire and has
no history.
"""


def pages() -> dict[str, str]:
    """One page of all commands."""
    return {"commands": HEAD + "".join(f"\n{_chapter(name, command)}" for name, command in all_commands())}


def all_commands() -> Iterator[tuple[str, click.Command]]:
    """Names and commands."""
    context = click.Context(cli)
    for name in cli.list_commands(context):
        command = cli.get_command(context, name)
        if command is not None:
            yield name, command


def _chapter(name: str, command: click.Command) -> str:
    context = click.Context(command, info_name=f"smarig {name}")
    usage = " ".join(command.get_usage(context).removeprefix("Usage: ").split())
    rows = [_row(p, context) for p in command.params if isinstance(p, click.Option)]
    parts = [f"## smarig {name}", _prose(command.help or ""), fence("text", usage)]
    parts.append(table(("option", "value", "default", "means"), [r for r in rows if r[0] != "`--json`"]))
    return "\n".join([*parts, *_epilog(command.epilog or "")])


def _prose(text: str) -> str:
    return "\n\n".join(plain(p) for p in inspect.cleandoc(text).split("\n\n")) + "\n"


def _row(option: click.Option, context: click.Context) -> tuple[str, str, str, str]:
    names = " ".join(code(n) for n in (*option.opts, *option.secondary_opts))
    shown = option.get_default(context)
    default = "" if option.is_flag or shown in (None, "", ()) or "UNSET" in repr(shown) else code(shown)
    means = plain(option.help or "") + (" **Needed.**" if option.required else "")
    return names, "" if option.is_flag else _value(option, context), default, means


def _value(option: click.Option, context: click.Context) -> str:
    if isinstance(option.type, click.Choice):
        return ", ".join(code(c) for c in option.type.choices)
    return code(option.make_metavar(context))


def _epilog(text: str) -> Iterator[str]:
    """Paragraphs; those that click must not wrap (``\\b``) are a title and lines as they stand."""
    for paragraph in re.split(r"\n\s*\n", text.strip("\n")):
        if not paragraph.strip().startswith("\b"):
            yield _prose(paragraph)
            continue
        title, *lines = paragraph.strip().removeprefix("\b").strip("\n").splitlines()
        language = "sh" if title.startswith("Example") else "text"
        yield f"{title.strip()}\n\n{fence(language, inspect.cleandoc(chr(10).join(['', *lines])))}"
