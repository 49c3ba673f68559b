"""What ``track`` and ``regulate`` share: a closed loop is previewed, run like any protocol, and told."""

from pathlib import Path
from typing import TYPE_CHECKING

from smarig.cli._output import distinct, emit
from smarig.cli._sitting import Sitting, free, summarised, warn
from smarig.errors import Interrupted, UsageError
from smarig.record import load_run
from smarig.runner.preview import preview

if TYPE_CHECKING:
    from smarig.closed_loop import Loop

ANEW = "A closed loop is not gone on with: close it anew."


def carried_out(loop: "Loop", sitting: Sitting, out: Path | None, *inputs: Path) -> None:
    """Preview it, run it into ``out`` and say how it went."""
    from smarig.report.closed_loop import closed_loop
    from smarig.report.closed_loop_words import in_words

    session = sitting.session()
    if out is None and not sitting.dry_run:
        raise UsageError("Give a run file with -o, or --dry-run.")
    if out is not None:
        distinct(out, *inputs)
        free(out, force=sitting.force or sitting.dry_run)
    cost = preview(loop.protocol, session.file, maker=loop.make)
    if sitting.dry_run or out is None:
        emit({"preview": cost.__dict__}, cost.sentence())
        return
    try:
        with sitting.watched(session, {}, loop.protocol) as shown, shown(out, cost) as face:
            session.run(
                loop.protocol,
                loop.settings,
                out,
                listeners=[face],
                force=sitting.force,
                notes=sitting.notes,
                expected=cost,
                maker=loop.make,
            )
    except Interrupted as stopped:
        stopped.remedy = ANEW
        raise
    run = load_run(out)
    warn(run)
    found = closed_loop(run)
    told = {loop.protocol: found.to_json()} if found else {}
    emit(summarised(run) | told, "\n".join([repr(run), *([in_words(found, run.unit)] if found else [])]))
