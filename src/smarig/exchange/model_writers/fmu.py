"""Writes a model as FMU for Simulink, dSPACE, Modelica tools and FMPy: FMI 2.0 co-simulation in C, no Python."""

from pathlib import Path

from smarig.core import UsageError, atomic_file
from smarig.exchange.c_code import write_fmu
from smarig.replay import Model


def fmu(model: Model, path: Path, force: bool) -> tuple[Path, ...]:
    """FMU (FMI 2.0, co-simulation) in C with sources; compiled for this machine if it has a C compiler."""
    if path.suffix != ".fmu":
        raise UsageError(f"An FMU needs a name that ends in .fmu, got {path.name}.")
    with atomic_file(path, force=force) as part:
        write_fmu(model, part, path.stem)
    return (path,)
