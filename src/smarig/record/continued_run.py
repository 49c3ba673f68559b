"""Whether one run continues another: its wire then starts in the final state of the run before."""

from smarig.record.run import CONTINUED, Run

LONGEST_GAP_S = 2.0


def continues_run(before: Run, run: Run) -> bool:
    """Whether a run starts in the final state of the one before: same session and no gap in its clock, or an import
    that names the data before it.
    """
    if run.info.initial != CONTINUED or not (len(run) and len(before)):
        return False
    if run.info.imported is not None:
        data = before.info.imported and before.info.imported.sha256
        return bool(data) and run.info.imported.continues_sha256 == data
    if run.info.start_epoch is None or run.info.start_epoch != before.info.start_epoch:
        return False
    return bool(0 <= run["t_s"][0] - before["t_s"][-1] <= LONGEST_GAP_S)
