"""The command line: one file per command. A command is found by its name and imported when it is used."""

import contextlib
import errno
import importlib
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from types import FrameType

import click

from smarig.cli.output import close_output, report_error
from smarig.cli.parameter_types import PluginName
from smarig.cli.working_line import working_line
from smarig.core import (
    ENDING,
    Interrupted,
    SmarigError,
    UsageError,
    catalogue_names,
    error_text,
    exit_within,
    forced_end,
    own_file_error,
    own_files,
    renew_watch,
    suggestion,
)

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
EXIT_LIMIT_S = 4.0  # for what the interpreter clears up
_COMPLETION = "_SMARIG_COMPLETE"  # set by the shell that asks for completions
_SOURCE_DATE = (
    "SOURCE_DATE_EPOCH"  # libraries read it when they are imported: each would fail in words of its own
)
_LATEST_S = 253402300799  # 9999-12-31, the last day that a date can have
_NO_QUESTION = "{} asks no question, so it has no option --yes. Leave it out."
_SPELLINGS = {"characterize": "characterise"}
EPILOG = """\b
Examples:
  smarig characterise --rig one_wire_twin --out out/one_wire
  smarig list protocols
  smarig run validation --rig one_wire_twin -o validation.run.sqlite --set points=20
"""


class _Commands(click.Group):
    """Finds the commands in ``smarig.cli.commands``. Each module there defines ``command``."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return [name.rstrip("_") for name in catalogue_names("smarig.cli.commands")]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command of the first argument; an unknown one is an error that suggests the nearest."""
        args = [_SPELLINGS.get(args[0], args[0]), *args[1:]] if args else args
        names = self.list_commands(ctx)
        if args and args[0] not in names and not args[0].startswith("-"):
            raise UsageError(f"There is no command '{args[0]}'{suggestion(args[0], names)}.")
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        module = next((n for n in catalogue_names("smarig.cli.commands") if n.rstrip("_") == cmd_name), None)
        return importlib.import_module(f"smarig.cli.commands.{module}").command if module else None


@click.command(
    cls=_Commands,
    epilog=EPILOG,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Rig software for shape-memory-alloy actuators: experiments, Preisach identification, verification.",
)
@click.version_option(package_name="smarig")
@click.option(
    "--plugin",
    "plugins",
    multiple=True,
    type=PluginName(),
    expose_value=False,
    metavar="NAME",
    help="Import a plug-in that a model, run or rig file of the command needs; repeatable.",
)
def cli() -> None:
    """Root of all commands."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a command and exit with its status (0, 2, 3, 4, 5 or 130; 1 for an internal error)."""
    with forced_end(partial(report_error, forced=True)):
        status = run(arguments)
        with _signals_without_effect():  # the command is finished and its status is final
            status = close_output(status)
    for number in ENDING:
        with contextlib.suppress(ValueError):
            signal.signal(number, signal.SIG_IGN)
    exit_within(EXIT_LIMIT_S, status)
    sys.exit(status)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns the exit status."""
    _interrupt_as_ctrl_c_does()
    try:
        given = sys.argv[1:] if arguments is None else arguments
        _check_source_date()
        with own_files(), _blame_own_file(), working_line(_command_name(given)):
            status = cli.main(args=arguments, prog_name="smarig", standalone_mode=False)
        return status if isinstance(status, int) else 0
    except click.exceptions.Exit as exit_request:
        return exit_request.exit_code
    except click.NoSuchOption as error:
        return report_error(_no_option(error), 2)
    except click.ClickException as error:
        return report_error(error.format_message(), 2)
    except Interrupted as interruption:
        sentence = f"Run {interruption}: it is closed, the current is at zero. {interruption.remedy}"
        return report_error(sentence, interruption.exit_status)
    except SmarigError as error:
        return report_error(str(error), error.exit_status)
    except (KeyboardInterrupt, click.Abort):
        with _signals_without_effect():  # Ctrl-C pressed twice
            return report_error("Interrupted.", Interrupted.exit_status)
    except MemoryError:
        return report_error("This needs more memory than is available. Request less.", 4)
    except OSError as error:
        full = "Standard output or a file cannot be written: " if error.errno in _FULL else ""
        what = f"{error.filename}: " if error.filename else full
        return report_error(f"{what}{error.strerror or error}.", 4)
    except ArithmeticError as error:
        return report_error(f"A number in these files is too large or too small to compute with: {error}.", 4)
    except BaseException as error:  # a SystemExit that is none of smarig would end the process in silence
        if os.environ.get("SMARIG_DEBUG") or _COMPLETION in os.environ:  # completions end by SystemExit
            raise
        return report_error(
            f"Internal error ({error_text(error)}). This is a bug in smarig; "
            "set SMARIG_DEBUG=1 to see the traceback.",
            1,
        )


def _no_option(error: click.NoSuchOption) -> str:
    """The sentence on an option that a command does not have."""
    if error.option_name == "--yes" and error.ctx is not None:
        return _NO_QUESTION.format(error.ctx.command_path)
    return error.format_message()


def _check_source_date() -> None:
    """Raise UsageError if the variable that dates files for reproducible builds is no time."""
    given = os.environ.get(_SOURCE_DATE)
    if given is None:
        return
    is_whole = given.isascii() and given.isdecimal() and len(given) < 20
    if not is_whole or int(given) > _LATEST_S:
        raise UsageError(
            f"The environment variable {_SOURCE_DATE} is '{given}', expected whole seconds since 1970, "
            f"0 to {_LATEST_S}. Correct it, or unset it."
        )


def _command_name(arguments: Sequence[str]) -> str:
    """The first argument that is no option of the root, nor the value of one; "" if there is none."""
    pairs = zip(["", *arguments], arguments)
    return next((word for before, word in pairs if not word.startswith("-") and before != "--plugin"), "")


@contextlib.contextmanager
def _blame_own_file() -> Iterator[None]:
    """Report an exception raised in a user's own file as an error of that file, with the line."""
    try:
        yield
    except (SmarigError, click.ClickException, click.exceptions.Exit, click.Abort, KeyboardInterrupt):
        raise
    except BaseException as error:
        sentence = own_file_error(error)
        if not sentence or os.environ.get("SMARIG_DEBUG"):
            raise
        raise UsageError(sentence) from error


def _interrupt_as_ctrl_c_does() -> None:
    """Let the other signals end a command as Ctrl-C does. A session installs its own handlers."""
    for number in ENDING:
        with contextlib.suppress(ValueError):  # not the main thread, where signals can be handled
            if (
                number != signal.SIGINT and signal.getsignal(number) != signal.SIG_IGN
            ):  # ignored by nohup: it stays
                signal.signal(number, signal.default_int_handler)


@contextlib.contextmanager
def _signals_without_effect() -> Iterator[None]:
    """Let the signals do nothing but count for a forced end. One that was ignored at the start stays ignored."""
    with contextlib.ExitStack() as restored:
        for number in ENDING:
            with contextlib.suppress(ValueError):
                if signal.getsignal(number) != signal.SIG_IGN:
                    restored.callback(signal.signal, number, signal.signal(number, _nothing))
        yield


def _nothing(number: int, _frame: FrameType | None) -> None:
    """Handle a signal by counting it only."""
    renew_watch(number)
