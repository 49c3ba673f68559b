"""``smarig console``: the browser page of a laboratory to run its rigs from."""

import sys
from pathlib import Path

import click

from smarig.cli.output import emit, json_option, json_requested, show_message
from smarig.cli.parameter_types import RIG
from smarig.core import MissingExtra

EPILOG = """The address carries a token: only a browser that opens it can use the console. It listens on this computer
only. Runs, and the queue, are processes of their own and go on when the console ends.

\b
Examples:
  smarig console --folder runs
  smarig console --folder runs --rig two_wire_twin --port 8765 --no-browser
"""


@click.command("console", short_help="Run a rig from the browser: runs, queue, library.", epilog=EPILOG)
@click.option(
    "--folder",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path(),
    show_default=True,
    help="Folder of the runs, the queue and the library; made if it is missing.",
)
@click.option(
    "--rig", type=RIG, default="one_wire_twin", show_default=True, help="Rig that forms begin with."
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port on this computer (default: a free one)."
)
@click.option("--no-browser", is_flag=True, help="Print the address only.")
@json_option
def command(folder: Path, rig: str, port: int, no_browser: bool) -> None:
    """Open the console in the browser: start, watch, pause and stop runs; queue, library, study of a file."""
    try:
        import jinja2  # noqa: F401
        import multipart  # noqa: F401
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtra(f"The console ({error.name} is missing)", "console") from None
    from smarig.console import serve_console

    at_terminal = sys.stdout.isatty() and not json_requested()
    serve_console(folder, rig=rig, port=port, open_browser=at_terminal and not no_browser, announce=_announce)


def _announce(text: str) -> None:
    """Print the address, on stdout with --json; other texts are messages."""
    if text.startswith("http") and json_requested():
        emit({"address": text})
    else:
        show_message(f"Console: {text}" if text.startswith("http") else text)
