"""Options and session of the commands that drive current through a wire, with their displays."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from smarig.cli.live_options import LiveOptions, live_options, live_view, with_watchers
from smarig.cli.notifier import Subject
from smarig.cli.notify import NotifyOptions, notified, notify_option
from smarig.cli.option_group import option_group
from smarig.cli.output import emit, show_message
from smarig.cli.panel.keyboard import keys
from smarig.cli.parameter_types import RIG, SEED, FiniteNumber
from smarig.cli.progress import progress
from smarig.core import RUN, Quality, RigFault, UsageError, check_replaceable, spaced

if TYPE_CHECKING:
    from smarig.config import RigFile
    from smarig.plant import Effect
    from smarig.record import AnyRun
    from smarig.runner import Listener, Preview, Session

DisplayFactory = Callable[..., "AbstractContextManager[Listener]"]


class RunOptions(NamedTuple):
    """The values of the options of a run."""

    rig: str
    effects: tuple[str, ...]
    seed: int
    speed: float | None
    load: str
    wire: str
    notes: str
    dry_run: bool
    force: bool
    quiet: bool
    notify: NotifyOptions
    live: LiveOptions

    def session(self) -> "Session":
        """A session with these options, not opened yet."""
        from smarig.rig import TwinSettings
        from smarig.runner import Session

        twin = TwinSettings(seed=self.seed, effects=injected_effects(self.effects, quiet=self.quiet))
        return Session(self.rig, twin=twin, speed=self.speed, wire=self.wire, load=self.load)

    def rig_file(self) -> "RigFile":
        """The rig file, with the load that was given."""
        from smarig.config import load_rig, with_load

        file = load_rig(self.rig)
        return with_load(file, self.load) if self.load else file

    @contextmanager
    def open_session(
        self, session: "Session", settings: Mapping[str, Any], what: str
    ) -> Iterator[DisplayFactory]:
        """Open the session, the keys and the live view. Yields a function that opens the display of one run."""
        from smarig.running import run_info

        title = f"{what} on {session.file.name}"
        subject = Subject(session.wire, session.file.name, "", "")
        live_context = live_view(self.live, session.file, session.source, settings, title)
        with (
            live_context as watchers,
            notified(self.notify, session.control, subject) as watch,
            session,
            keys(session.control) as listening,
        ):

            def display(target: Path, cost: "Preview", place: str = "") -> "AbstractContextManager[Listener]":
                wire, source = session.wire, session.source
                what_runs = run_info(session.file, cost, target, wire=wire, source=source, place=place)
                run_display = progress(what_runs, session.control, quiet=self.quiet, keys=listening)
                return with_watchers(run_display, [*watchers, *watch.listeners(what_runs)])

            yield display


def injected_effects(arguments: Sequence[str], *, quiet: bool) -> "tuple[Effect, ...]":
    """The effects of ``--effect``; their strengths are shown with their units."""
    from smarig.plant import effects_from_arguments, parameter_words

    effects = effects_from_arguments(arguments)
    for effect in effects if not quiet else ():
        values = (
            f"{parameter_words(p.name, p.unit)} {effect.values[p.name]:g}{spaced(p.unit)}"
            for p in effect.kind.parameters
        )
        show_message(f"Injected into the twin: {effect.kind.name} ({', '.join(values)})")
    return effects


effect_option = click.option(
    "--effect",
    "effects",
    multiple=True,
    metavar="NAME[.PARAMETER]=VALUE",
    help="Twin: inject an effect, or one of your own: ./FILE.py=3; repeatable. VALUE is in the unit of its parameter, "
    "often percent: 'smarig list effects --settings'.",
)

run_options = option_group(
    "options",
    RunOptions,
    (
        click.option("--rig", type=RIG, required=True, help="Rig by name or path."),
        effect_option,
        click.option("--seed", type=SEED, default=0, show_default=True, help="Seed of the twin's noise."),
        click.option(
            "--speed",
            type=FiniteNumber(0, min_open=True),
            help="Twin: real time × SPEED (default: as fast as possible).",
        ),
        click.option(
            "--load",
            default="",
            metavar="N|FORMULA|FILE",
            help="Force on a single wire: in N, a formula of the time t in s, or a CSV file with time_s and force_N "
            "(default: that of the rig file).",
        ),
        click.option("--wire", default="", help="Identity of the wire (default: that of the rig file)."),
        click.option("--notes", default="", help="Note to store with the run."),
        click.option("--dry-run", is_flag=True, help="Only print the preview: duration and range."),
        click.option("--force", is_flag=True, help="Replace existing run files."),
        click.option("--quiet", is_flag=True, help="Show no panel and no log lines."),
        live_options,
        notify_option,
    ),
)


def check_target(target: Path, *, force: bool, remedy: str = "") -> None:
    """Raise UsageError if a file exists that the run must not replace, InUse if it is being recorded."""
    from smarig.record import check_not_recording

    check_not_recording(target)
    if target.exists() and not force:
        raise UsageError(f"{target} exists. Give another name,{remedy} or --force to replace it.")
    check_replaceable(target, RUN)


@contextmanager
def resumable(session: "Session", out: Path) -> Iterator[None]:
    """A fault of the rig that ends the run of this file is followed by the command that continues the run."""
    try:
        yield
    except RigFault:
        if out.exists():
            show_message(f"When the cause is removed, {session.resume_command(out)} continues this run.")
        raise


def emit_previews(previews: "Sequence[Preview]") -> None:
    """Print the previews of one or more runs, as --dry-run does."""
    total_h = sum(p.duration_s for p in previews) / 3600
    lines = [*(p.sentence() for p in previews), f"total: {total_h:.2f} h"]
    emit({"preview": [p.__dict__ for p in previews]}, "\n".join(lines))


def run_warnings(run: "AnyRun") -> list[str]:
    """Warnings about a finished run: holds that did not settle, suspect steps and saturated samples."""
    suspect = sum(s.verdict == "suspect" for s in run.steps)
    unsettled = sum(s.verdict == "timed_out" for s in run.steps)
    marks = (block["quality"].astype(int) for block in run.blocks(["quality"]))
    saturated = sum(int(((mark & Quality.SATURATED) > 0).sum()) for mark in marks)
    found = (
        [f"{run.path.name}: {unsettled} of {len(run.steps)} holds did not settle in time."]
        if unsettled
        else []
    )
    found += [f"{run.path.name}: {suspect} of {len(run.steps)} steps are suspect."] if suspect else []
    return found + ([f"{run.path.name}: {saturated} samples were saturated."] if saturated else [])


def print_warnings(run: "AnyRun") -> None:
    """Print the warnings of a run."""
    for warning in run_warnings(run):
        show_message(f"Warning: {warning}")


def run_summary(run: "AnyRun") -> dict:
    """The summary of a run for --json."""
    return {
        "run": str(run.path),
        "protocol": run.info.protocol,
        "samples": len(run),
        "steps": len(run.steps),
        "void": sum(s.void for s in run.steps),
        "timed_out": sum(s.verdict == "timed_out" for s in run.steps),
        "warnings": run_warnings(run),
        "severity": run.severity,
        "cause": run.cause,
    }
