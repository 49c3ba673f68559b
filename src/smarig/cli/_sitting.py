"""What every command has that lets current flow: its options, the session, and the faces it shows meanwhile.

Knows sessions and faces; refuses to know what is run.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import click

from smarig.cli._keys import keys
from smarig.cli._live import Live, joined, live_options, live_view
from smarig.cli._notify import notified, notify_option
from smarig.cli._output import say
from smarig.cli._progress import progress
from smarig.cli._situation import about
from smarig.cli._types import RIG, SEED, Finite
from smarig.errors import UsageError
from smarig.file_kind import RUN
from smarig.model.planted import asked_for
from smarig.record import Run
from smarig.rig.twin import TwinSettings
from smarig.runner.listener import Listener
from smarig.runner.preview import Preview
from smarig.runner.session import Session
from smarig.sample import Quality
from smarig.whole_file import replaceable

Shown = Callable[..., AbstractContextManager[Listener]]


class Sitting(NamedTuple):
    """What was asked for."""

    rig: str
    effects: tuple[str, ...]
    seed: int
    speed: float | None
    wire: str
    notes: str
    dry_run: bool
    force: bool
    quiet: bool
    notify: str
    live: Live

    def session(self) -> Session:
        """The session asked for, not opened yet."""
        twin = TwinSettings(seed=self.seed, effects=asked_for(self.effects))
        return Session(self.rig, twin=twin, speed=self.speed, wire=self.wire)

    @contextmanager
    def watched(self, session: Session, settings: Mapping[str, Any], what: str) -> Iterator[Shown]:
        """Within: the session is open, keys and the live view work. Yields what shows one run."""
        title = f"{what} on {session.file.name}"
        watching = live_view(self.live, session.file, session.source, settings, title)
        with (
            watching as watchers,
            notified(self.notify) as told,
            session,
            keys(session.control) as listening,
        ):

            def shown(target: Path, cost: Preview, place: str = "") -> AbstractContextManager[Listener]:
                told.run = target
                wire, source = session.wire, session.source
                subject = about(session.file, cost, target, wire=wire, source=source, place=place)
                face = progress(subject, session.control, quiet=self.quiet, keys=listening)
                return joined(face, watchers)

            yield shown


def sitting_options(command: Callable) -> Callable:
    """``--rig``, ``--seed`` and the others, gathered into one argument ``sitting``."""

    def gathered(*args: Any, **given: Any) -> Any:
        mine = {name: given.pop(name) for name in Sitting._fields}
        return command(*args, sitting=Sitting(**mine), **given)

    gathered.__doc__, gathered.__name__ = command.__doc__, command.__name__
    gathered.__click_params__ = getattr(command, "__click_params__", [])  # type: ignore[attr-defined]
    gathered = live_options(notify_option(gathered))
    for option in reversed(_OPTIONS):
        gathered = option(gathered)
    return gathered


_OPTIONS = (
    click.option("--rig", type=RIG, required=True, help="Rig by name or path."),
    click.option(
        "--effect",
        "effects",
        multiple=True,
        metavar="NAME[.PARAMETER]=VALUE",
        help="Twin: plant an effect (see 'smarig list effects'), or one of your own: ./FILE.py=3; repeatable.",
    ),
    click.option("--seed", type=SEED, default=0, show_default=True, help="Of the twin's noise."),
    click.option("--speed", type=Finite(0, min_open=True), help="Twin: real time × SPEED (default: free)."),
    click.option("--wire", default="", help="Identity of the wire, if not the rig file's."),
    click.option("--notes", default="", help="A remark kept with the run."),
    click.option("--dry-run", is_flag=True, help="Only say what it would cost."),
    click.option("--force", is_flag=True, help="Replace existing run files."),
    click.option("--quiet", is_flag=True, help="No panel, no lines."),
)


def free(target: Path, *, force: bool, remedy: str = "") -> None:
    """UsageError when a file exists and may not be replaced by a run."""
    if target.exists() and not force:
        raise UsageError(f"{target} exists; give another name,{remedy} or --force to replace it.")
    replaceable(target, RUN)


def marked(run: Run) -> list[str]:
    """Honest numbers: what a person must know although the run is done."""
    late = sum(s.verdict == "timed_out" for s in run.steps)
    saturated = int(((run["quality"].astype(int) & Quality.SATURATED) > 0).sum())
    found = [f"{run.path.name}: {late} of {len(run.steps)} holds did not settle in time."] if late else []
    return found + ([f"{run.path.name}: {saturated} samples were saturated."] if saturated else [])


def warn(run: Run) -> None:
    """Say them."""
    for warning in marked(run):
        say(f"Warning: {warning}")


def summarised(run: Run) -> dict:
    """A run for --json."""
    return {
        "run": str(run.path),
        "protocol": run.meta["protocol"],
        "samples": len(run),
        "steps": len(run.steps),
        "void": sum(s.void for s in run.steps),
        "timed_out": sum(s.verdict == "timed_out" for s in run.steps),
        "warnings": marked(run),
        "cause": run.cause,
    }
