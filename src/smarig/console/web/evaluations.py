"""Evaluations of library entries: the commands of the command line, in processes of their own, with the line to copy.

Pages are written into ``console_pages`` of the folder under the identity of what they show, so that a run that changes
gets another page.
"""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.console.command_process import run_command
from smarig.console.library.library_entry import Entry
from smarig.console.web.console_context import ConsoleContext
from smarig.core import UsageError, printable
from smarig.diagnosis import DIAGNOSIS_PAGE

PAGES = "console_pages"
LONGEST_S = 900.0
_OWN_PAGES = frozenset({"run", "model"})  # made on request; other entries are pages, or have one beside them


@dataclass(frozen=True)
class EntryEvaluation:
    """A button: its name, its words, and the command as a person would type it."""

    name: str
    words: str
    command: str


@dataclass(frozen=True)
class EvaluationResult:
    """What an evaluation printed, and whether it is good news: "good", "warning" or "bad"."""

    text: str
    level: str


def evaluations_of(context: ConsoleContext, entry: Entry) -> list[EntryEvaluation]:
    """What can be done with an entry."""
    words = {
        "report": "Make its page",
        "identify": "Identify a model",
        "transformation": "Transformation temperatures",
    }
    return [
        EntryEvaluation(name, words[name], shlex.join(["smarig", *arguments]))
        for name, arguments in _commands(context, entry).items()
    ]


def run_evaluation(context: ConsoleContext, entry: Entry, name: str) -> EvaluationResult:
    """Run an evaluation and wait for its end. Raises UsageError for one that this entry does not have."""
    commands = _commands(context, entry)
    if name not in commands:
        raise UsageError("This entry has no such evaluation.")
    (context.folder / PAGES).mkdir(exist_ok=True)
    return _run(context.folder, commands[name])


def finished_page(context: ConsoleContext, entry: Entry) -> Path | None:
    """The page that shows an entry, if there is one."""
    if entry.path.suffix == ".html":
        return entry.path if entry.path.is_file() else None
    own = _page_of(context, entry) if entry.kind in _OWN_PAGES else entry.path.with_name(DIAGNOSIS_PAGE)
    return own if own.is_file() else None


def compared_page(context: ConsoleContext, entries: Sequence[Entry]) -> Path:
    """The page that compares runs. Raises UsageError with the sentence of the command."""
    (context.folder / PAGES).mkdir(exist_ok=True)
    out = context.folder / PAGES / ("comparison-" + "-".join(_short(e) for e in entries)[:100] + ".html")
    done = _run(context.folder, ["report", *(str(e.path) for e in entries), "-o", str(out), "--force"])
    if not out.is_file():
        raise UsageError(done.text)
    return out


def _commands(context: ConsoleContext, entry: Entry) -> dict[str, list[str]]:
    path = str(entry.path)
    report = ["report", path, "-o", str(_page_of(context, entry)), "--force"]
    if entry.verdict in ("unreadable", "recording"):
        return {}
    if entry.kind == "run":
        model = str(entry.path.with_name(entry.path.name.removesuffix(".run.sqlite") + ".model.json"))
        return {
            "report": report,
            "identify": ["identify", path, "--surface", "best", "-o", model],
            "transformation": ["transformation", path],
        }
    if entry.kind == "model":
        return {"report": report}
    return {}


def _page_of(context: ConsoleContext, entry: Entry) -> Path:
    return context.folder / PAGES / f"{_short(entry)}.html"


def _short(entry: Entry) -> str:
    return "".join(c for c in entry.identity if c.isalnum())[:40] or "entry"


def _run(folder: Path, arguments: Sequence[str]) -> EvaluationResult:
    try:
        done = run_command(["smarig", *arguments], folder, LONGEST_S)
    except UsageError as error:
        return EvaluationResult(str(error), "bad")
    output_lines = [line for line in (done.stdout + "\n" + done.stderr).splitlines() if line.strip()]
    text = printable(" ".join(output_lines[-6:])) or "Done."
    return EvaluationResult(text, "bad" if done.returncode else "warning" if "Warning" in text else "good")
