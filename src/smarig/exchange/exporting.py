"""Exports a run to another format: the whole file or none, and without replacing a file unless requested."""

from pathlib import Path

from smarig.core import atomic_file, catalogue_entry
from smarig.record import Run, load_run


def export_run(run: Run | str | Path, *, to: str, out: str | Path, force: bool = False) -> Path:
    """Write ``run`` (a run or its path) in format ``to`` (csv, parquet, …) at ``out``; returns the path.

    UsageError if ``out`` exists and not ``force``; StorageError if it cannot be written. A partly written file is
    removed.
    """
    target = Path(out)
    write = catalogue_entry("smarig.exchange.writers", to)
    data = run if isinstance(run, Run) else load_run(run)
    with atomic_file(target, force=force) as part:
        write(data, part)
    return target
