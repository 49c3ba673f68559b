"""``smarig check RUN``: say what a run file holds, and save what a damaged one still holds."""

from pathlib import Path

from smarig.cli.output import check_distinct, emit
from smarig.core import RUN, DataError, UsageError, content_kind, is_file


def is_run_file(name: str) -> bool:
    """Whether the user gives a run file and not a rig."""
    path = Path(name)
    return name.endswith(".sqlite") or (is_file(path) and content_kind(path) == RUN)


def check_run_file(run: Path, out: Path | None, force: bool) -> int:
    """Report what a run file holds and save it to ``out``; returns the exit status."""
    from smarig.record import SIDECARS, check_run, salvage, write_salvaged

    check_distinct(out, run)
    if out is not None and out.name.endswith(SIDECARS):
        raise UsageError(f"{out} is the name of a journal of a run file. Give a name such as NEW.run.sqlite.")
    check = check_run(run)
    data, lines = check.to_json(), check.sentences()
    if out is not None:
        saved = check.salvaged or salvage(run)
        write_salvaged(saved, out, force=force)
        lines.append(f"Saved to {out}: {saved.amount()}. {saved.sentence()}")
        data["saved"] = {"run": str(out), **saved.to_json()}
    elif not check.whole and check.hashes != "not_compared":
        lines.append(f"Save what it holds: smarig check {run} -o NEW.run.sqlite")
    emit(data, "\n".join(lines))
    return 0 if check.whole else DataError.exit_status
