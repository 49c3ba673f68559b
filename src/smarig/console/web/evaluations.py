"""Evaluations of library entries: the commands of the command line, in processes of their own, with the line to copy.

Pages are written into ``console_pages`` of the folder under the identity of what they show, so that a run that changes
gets another page.
"""

import shlex
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from smarig.console.library.library_entry import Entry
from smarig.console.web.desk import Desk
from smarig.core import UsageError, printable

PAGES = "console_pages"
LONGEST_S = 900.0
_OWN_PAGES = frozenset(
    {"run", "model"}
)  # whose pages are made on request; others are pages, or have one beside them


@dataclass(frozen=True)
class EntryEvaluation:
    """A button: its name, its words, and the command as a person would type it."""

    name: str
    words: str
    command: str


@dataclass(frozen=True)
class EvaluationResult:
    """What an evaluation output_lines, and whether it is good news: "good", "warning" or "bad"."""

    text: str
    level: str


def evaluations_of(desk: Desk, entry: Entry) -> list[EntryEvaluation]:
    """What can be done with an entry."""
    words = {
        "report": "Make its page",
        "identify": "Identify a model",
        "transformation": "Transformation temperatures",
    }
    return [
        EntryEvaluation(name, words[name], shlex.join(["smarig", *arguments]))
        for name, arguments in _commands(desk, entry).items()
    ]


def run_evaluation(desk: Desk, entry: Entry, name: str) -> EvaluationResult:
    """Run an evaluation and wait for its end. Raises UsageError for one that this entry does not have."""
    commands = _commands(desk, entry)
    if name not in commands:
        raise UsageError("This entry has no such evaluation.")
    (desk.folder / PAGES).mkdir(exist_ok=True)
    return _run(desk.folder, commands[name])


def finished_page(desk: Desk, entry: Entry) -> Path | None:
    """The page that shows an entry, if there is one."""
    if entry.path.suffix == ".html":
        return entry.path if entry.path.is_file() else None
    own = _page_of(desk, entry) if entry.kind in _OWN_PAGES else entry.path.with_name("report.html")
    return own if own.is_file() else None


def compared_page(desk: Desk, entries: Sequence[Entry]) -> Path:
    """The page that compares runs. Raises UsageError with the sentence of the command."""
    (desk.folder / PAGES).mkdir(exist_ok=True)
    out = desk.folder / PAGES / ("comparison-" + "-".join(_short(e) for e in entries)[:100] + ".html")
    done = _run(desk.folder, ["report", *(str(e.path) for e in entries), "-o", str(out), "--force"])
    if not out.is_file():
        raise UsageError(done.text)
    return out


def _commands(desk: Desk, entry: Entry) -> dict[str, list[str]]:
    path = str(entry.path)
    if entry.verdict in ("unreadable", "recording"):
        return {}
    if entry.kind == "run":
        model = str(entry.path.with_name(entry.path.name.removesuffix(".run.sqlite") + ".model.json"))
        return {
            "report": ["report", path, "-o", str(_page_of(desk, entry)), "--force"],
            "identify": ["identify", path, "--surface", "best", "-o", model],
            "transformation": ["transformation", path],
        }
    return (
        {"report": ["report", path, "-o", str(_page_of(desk, entry)), "--force"]}
        if entry.kind == "model"
        else {}
    )


def _page_of(desk: Desk, entry: Entry) -> Path:
    return desk.folder / PAGES / f"{_short(entry)}.html"


def _short(entry: Entry) -> str:
    return "".join(c for c in entry.identity if c.isalnum())[:40] or "entry"


def _run(folder: Path, arguments: Sequence[str]) -> EvaluationResult:
    command = [sys.executable, "-P", "-m", "smarig", *arguments]
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=LONGEST_S,
        )
    except subprocess.TimeoutExpired:
        return EvaluationResult(
            f"It took more than {LONGEST_S:g} s and was ended. Run it at a terminal.", "bad"
        )
    output_lines = [line for line in (done.stdout + "\n" + done.stderr).splitlines() if line.strip()]
    text = printable(" ".join(output_lines[-6:])) or "Done."
    return EvaluationResult(text, "bad" if done.returncode else "warning" if "Warning" in text else "good")
