"""Evaluations of library entries: the commands of the command line, in processes of their own, with the line to copy.

An evaluation may take minutes, so nobody waits for it: its page shows that it is being computed, and then its result.

Pages are written into ``console_pages`` of the folder under the identity of what they show, so that a run that changes
gets another page.
"""

import shlex
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarig.console.command_process import run_command
from smarig.console.library.library_entry import Entry
from smarig.console.web.console_context import ConsoleContext, is_own_place, own_place
from smarig.console.web.evaluation_jobs import EvaluationJob, EvaluationResult
from smarig.core import UsageError, printable
from smarig.diagnosis import DIAGNOSIS_PAGE
from smarig.identification import BEST_KIND, surface_choices

PAGES = "console_pages"
LONGEST_S = 3600.0
MODELS_OFFERED = 50
_OWN_PAGES = frozenset({"run", "model"})  # made on request; other entries are pages, or have one beside them


_WORDS = {
    "report": "Make its page",
    "identify": "Identify a model",
    "transformation": "Transformation temperatures",
    "verify": "Verify a model on it",
    "diagnose": "Diagnose",
}
_WITH_MODEL = frozenset({"verify", "diagnose"})


@dataclass(frozen=True)
class EvaluationChoice:
    """What an evaluation works with, a model of the library or a surface, and the command with it."""

    id: str
    words: str
    command: str


@dataclass(frozen=True)
class EntryEvaluation:
    """A button: its name, its words, and the command as a person would type it; with its state if it was pressed.

    ``chosen``: what is chosen among ``choices``, "Model" or "Surface"; "" if nothing is. ``since`` is set while it is
    being computed, ``result`` when it has ended; ``given`` is the command that was started. ``page`` is the entry that
    it wrote, and ``awaits_page`` is true while the library has not read that.
    """

    name: str
    words: str
    command: str
    chosen: str = ""
    choices: tuple[EvaluationChoice, ...] = ()
    since: str = ""
    given: str = ""
    result: EvaluationResult | None = None
    page: str = ""
    awaits_page: bool = False

    @property
    def shown_command(self) -> str:
        """The command with what was chosen last, or with the first choice."""
        commands = [choice.command for choice in self.choices] or [self.command]
        return self.given if self.given in commands else commands[0]


def evaluations_of(context: ConsoleContext, entry: Entry) -> list[EntryEvaluation]:
    """What can be done with an entry, and what is being done."""
    models, jobs = _models(context), context.evaluations.of(entry.identity)
    return [
        EntryEvaluation(
            name,
            _WORDS[name],
            _line(arguments),
            *_choices(context, entry, name, models),
            **_state(context, jobs.get(name)),
        )
        for name, arguments in _commands(context, entry).items()
    ]


def _choices(
    context: ConsoleContext, entry: Entry, name: str, models: Sequence[Entry]
) -> tuple[str, tuple[EvaluationChoice, ...]]:
    """What is chosen for an evaluation, and the choices."""
    if name in _WITH_MODEL:
        offered = [(each.id, each.place, _commands(context, entry, model=each)) for each in models]
    elif name == "identify":
        offered = [(kind, kind, _commands(context, entry, surface=kind)) for kind in _surfaces()]
    else:
        return "", ()
    choices = tuple(EvaluationChoice(id, words, _line(commands[name])) for id, words, commands in offered)
    return "Model" if name in _WITH_MODEL else "Surface", choices


def _surfaces() -> list[str]:
    """The kinds of surfaces, that which is chosen by its error on held-out curves first."""
    return [BEST_KIND, *(kind for kind in surface_choices() if kind != BEST_KIND)]


def start_evaluation(context: ConsoleContext, entry: Entry, name: str, choice: str = "") -> None:
    """Start an evaluation; ``choice`` is the identity of a model's entry, or a kind of surface. Raises UsageError for
    one that cannot be.
    """
    chosen = next((each for each in _models(context) if each.id == choice), None) if choice else None
    if name == "identify" and choice not in ("", *surface_choices()):
        raise UsageError("There is no such surface.")
    surface = choice if name == "identify" and choice else BEST_KIND
    commands = _commands(context, entry, chosen, surface)
    if name not in commands:
        raise UsageError("This entry has no such evaluation.")
    if name in _WITH_MODEL and chosen is None:
        raise UsageError("Choose a model of the library.")
    arguments = commands[name]
    out = own_place(Path(arguments[arguments.index("-o") + 1]), context.folder) if "-o" in arguments else None
    page = out / DIAGNOSIS_PAGE if out is not None and name == "diagnose" else None

    def compute() -> EvaluationResult:
        result = _run(context.folder, arguments)
        context.scanner.soon()
        return result

    job = EvaluationJob(_line(arguments), page)
    context.evaluations.start(entry.identity, name, job, compute)


def _models(context: ConsoleContext) -> list[Entry]:
    """The models among which people choose, newest first."""
    return list(context.library.search(kind="model", limit=MODELS_OFFERED).entries)


def _line(arguments: Sequence[str]) -> str:
    return shlex.join(["smarig", *arguments])


def _state(context: ConsoleContext, job: EvaluationJob | None) -> dict[str, Any]:
    if job is None:
        return {}
    if job.result is None:
        return {"since": time.strftime("%H:%M:%S", time.localtime(job.began)), "given": job.command}
    page = _entry_of(context, job.page)
    awaits = not page and job.page is not None and job.page.is_file()
    return {"given": job.command, "result": job.result, "page": page, "awaits_page": awaits}


def _entry_of(context: ConsoleContext, page: Path | None) -> str:
    """The entry of a page that was written; "" if the library has not read it yet."""
    if page is None or not page.is_file():
        return ""
    found = context.library.search(page.parent.name, limit=MODELS_OFFERED).entries
    return next((entry.id for entry in found if entry.path == page), "")


def finished_page(context: ConsoleContext, entry: Entry) -> Path | None:
    """The page that shows an entry, if there is one."""
    if entry.path.suffix == ".html":
        return entry.path if entry.path.is_file() else None
    own = _page_of(context, entry) if entry.kind in _OWN_PAGES else entry.path.with_name(DIAGNOSIS_PAGE)
    return own if is_own_place(own, context.folder) and own.is_file() else None


def page_is_old(context: ConsoleContext, entry: Entry) -> bool:
    """Whether a run went on after its page was made."""
    found = finished_page(context, entry) if entry.kind == "run" else None
    return found is not None and found.stat().st_mtime < entry.path.stat().st_mtime


def compared_page(context: ConsoleContext, entries: Sequence[Entry]) -> Path:
    """The page that compares runs with the earliest. Raises UsageError with the sentence of the command."""
    entries = sorted(entries, key=lambda entry: entry.began or 0.0)
    name = "comparison-" + "-".join(_short(e) for e in entries)[:100] + ".html"
    out = own_place(context.folder / PAGES / name, context.folder)
    done = _run(context.folder, ["report", *(str(e.path) for e in entries), "-o", str(out), "--force"])
    if not out.is_file():
        raise UsageError(done.text)
    return out


def _commands(
    context: ConsoleContext, entry: Entry, model: Entry | None = None, surface: str = BEST_KIND
) -> dict[str, list[str]]:
    path = str(entry.path)
    report = ["report", path, "-o", str(_page_of(context, entry)), "--force"]
    if entry.verdict in ("unreadable", "recording"):
        return {}
    if entry.kind == "run":
        stem = entry.path.name.removesuffix(".run.sqlite")
        chosen = str(model.path) if model else "MODEL"
        by = model.path.name.removesuffix(".json").removesuffix(".model") if model else "MODEL"
        folder = str(entry.path.with_name(f"{stem}.diagnosis_{by}"))
        return {
            "report": report,
            "identify": [
                "identify",
                path,
                "--surface",
                surface,
                "-o",
                str(
                    entry.path.with_name(f"{stem}{'' if surface == BEST_KIND else f'.{surface}'}.model.json")
                ),
            ],
            "transformation": ["transformation", path],
            "verify": ["verify", chosen, path],
            "diagnose": ["diagnose", chosen, "--train", path, "-o", folder, "--force"],
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
    text = "\n".join(printable(line.removeprefix("smarig: ")) for line in output_lines[-6:]) or "Done."
    return EvaluationResult(text, "bad" if done.returncode else "warning" if "Warning" in text else "good")
