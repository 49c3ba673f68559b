"""A run goes out in another format: the whole file or none, and never over an old one unasked.

Refuses to know any format: those are in writers/.
"""

import contextlib
from pathlib import Path

from smarig.catalogue import find
from smarig.errors import StorageError, UsageError
from smarig.record import Run, load_run


def export_run(run: Run | str | Path, *, to: str, out: str | Path, force: bool = False) -> Path:
    """Write ``run`` (a run or its path) in format ``to`` (csv, parquet, …) at ``out``; returns the path.

    UsageError if ``out`` exists and not ``force``, StorageError if it cannot be written; what was written
    by then is removed.
    """
    target = Path(out)
    write = find("smarig.exchange.writers", to)
    if target.exists() and not force:
        raise UsageError(f"{target} exists; give another name or --force to replace it.")
    data = run if isinstance(run, Run) else load_run(run)
    part = target.with_name(target.name + ".part")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        write(data, part)
        part.replace(target)
    except OSError as error:
        raise StorageError(f"{target} cannot be written: {error.strerror or error}.") from None
    finally:
        with contextlib.suppress(OSError):  # the folder itself may be missing
            part.unlink(missing_ok=True)
    return target
