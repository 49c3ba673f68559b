"""Preview, run and report of a closed loop, shared by ``track`` and ``regulate``."""

from pathlib import Path
from typing import TYPE_CHECKING

from smarig.cli.output import check_distinct, emit, show_message
from smarig.cli.progress import preview_progress
from smarig.cli.run_options import RunOptions, check_target, print_warnings, run_summary
from smarig.core import Interrupted, UsageError

if TYPE_CHECKING:
    from smarig.app import ClosedLoop

NOT_RESUMABLE = "A closed loop cannot be resumed. Start it again."


def run_closed_loop(loop: "ClosedLoop", options: RunOptions, out: Path | None, *inputs: Path) -> None:
    """Preview a closed loop, run it into ``out`` and print its result."""
    from smarig.record import load_run
    from smarig.report import closed_loop_result, loop_result_text

    session = options.session()
    if out is None and not options.dry_run:
        raise UsageError("Give a run file with -o, or --dry-run.")
    if out is not None:
        check_distinct(out, *inputs)
        check_target(out, force=options.force or options.dry_run)
    if loop.statement:
        show_message(loop.statement)
    cost = loop.preview(session.file, report=preview_progress(quiet=options.quiet))
    if options.dry_run or out is None:
        emit({"preview": cost.__dict__}, cost.sentence())
        return
    try:
        with options.open_session(session, {}, loop.protocol) as display, display(out, cost) as run_display:
            session.run(
                loop.protocol,
                loop.settings,
                out,
                listeners=[run_display],
                force=options.force,
                notes=options.notes,
                expected=cost,
                protocol_factory=loop.make,
            )
    except Interrupted as stopped:
        stopped.remedy = NOT_RESUMABLE
        raise
    run = load_run(out)
    print_warnings(run)
    found = closed_loop_result(run)
    loop_json = {loop.protocol: found.to_json()} if found else {}
    emit(
        run_summary(run) | loop_json,
        "\n".join([repr(run), *([loop_result_text(found, run.unit)] if found else [])]),
    )
