"""What is checked before a run starts, besides its preview: cycles of the wire, and room on the disk."""

import os
import shutil
from pathlib import Path

from smarig.config import LimitsFile
from smarig.core import LimitExceeded, StorageError
from smarig.record import WireHistory


def check_cycle_limit(history: WireHistory | None, limits: LimitsFile) -> None:
    """Raise LimitExceeded if a wire has reached its number of cycles."""
    most = limits.cycles_max
    if history is not None and most is not None and history.cycles >= most:
        raise LimitExceeded(
            f"Wire '{history.wire}' has completed {history.cycles} cycles; its limit is cycles_max = {most}. Nothing "
            "was started. Install and name a new wire, or raise the limit in the rig file."
        )


def check_free_space(out: Path, needed: int) -> None:
    """Raise StorageError if a run would not fit on the disk."""
    target = Path(os.path.realpath(out))
    folder = next(p for p in target.parents if p.exists())
    free = shutil.disk_usage(folder).free
    # Twice the data, because the write-ahead log repeats them, and a margin to close the run.
    if free < 2 * needed + 16_000_000:
        raise StorageError(
            f"{folder} has {free / 1e6:.0f} MB free; this run needs about {2 * needed / 1e6 + 16:.0f} MB."
        )
