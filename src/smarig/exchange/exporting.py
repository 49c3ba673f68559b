"""Exports a run to another format: the whole file or none, and without replacing a file unless requested."""

from pathlib import Path

from smarig.core import atomic_file, catalogue_entry, resolve_name
from smarig.record import AnyRun, stored_run
from smarig.replay import Model, load_model

WRITERS = "smarig.exchange.writers"


def export_run(run: AnyRun | str | Path, *, to: str, out: str | Path, force: bool = False) -> Path:
    """Write ``run`` (a run or its path) in format ``to`` (csv, parquet, …) at ``out``; returns the path.

    ``to`` is a name, also of a plug-in, or the path of an own file; both are executed.
    UsageError if ``out`` exists and not ``force``; StorageError if it cannot be written. A partly written file is
    removed. The samples of a path are read in blocks or by column, so that a long run takes little memory.
    """
    if not isinstance(run, AnyRun):
        with stored_run(run) as stored:
            return export_run(stored, to=to, out=out, force=force)
    target = Path(out)
    write = catalogue_entry(WRITERS, resolve_name(WRITERS, to))
    with atomic_file(target, force=force) as part:
        write(run, part)
    return target


def export_model(
    model: Model | str | Path, *, to: str, out: str | Path, force: bool = False
) -> tuple[Path, ...]:
    """Write ``model`` (a model or its path) in format ``to`` (c, fmu) at ``out``; returns the files written.

    Raises UsageError for a model without such a form, for a wrong ending, and if a file exists without ``force``;
    StorageError if it cannot be written or compiled.
    """
    loaded = model if isinstance(model, Model) else load_model(model)
    return catalogue_entry("smarig.exchange.model_writers", to)(loaded, Path(out), force)
