"""Writes a model as C99 for the firmware of a controller: operator and inverse, without allocation."""

from pathlib import Path

from smarig.core import UsageError, atomic_file
from smarig.exchange.c_code import c_source
from smarig.replay import Model


def c(model: Model, path: Path, force: bool) -> tuple[Path, ...]:
    """C99 source and header: the model and its inverse, for firmware."""
    if path.suffix != ".c":
        raise UsageError(f"The C source of a model needs a name that ends in .c, got {path.name}.")
    source, header = c_source(model, path.stem), path.with_suffix(".h")
    with atomic_file(path, force=force) as part, atomic_file(header, force=force) as head:
        part.write_text(source.source, encoding="ascii")
        head.write_text(source.header, encoding="ascii")
    return path, header
