"""The table [load] of a rig file, and the same from the command line: the force on a single wire."""

from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from smarig.config.named_things import LoadFormula, LoadPath
from smarig.core import Number, TomlTable, UsageError, is_file, number_from_text, passed, swapped_file

if TYPE_CHECKING:
    from smarig.config.file_schemas import RigFile


class LoadFile(TomlTable):
    """[load]: the force on a single wire, constant or over the time t of the run file. Exactly one key is given."""

    force_N: Number | None = Field(default=None, gt=0, le=1e6)  # constant force, such as a weight
    formula: LoadFormula = ""  # force in N over the time t in s, such as 20+4*sin(2*pi*t/600)
    file: LoadPath = ""  # CSV file with the columns time_s and force_N, linear in between

    @model_validator(mode="after")
    def _one_key(self) -> "LoadFile":
        if (self.force_N is not None) + bool(self.formula) + bool(self.file) != 1:
            raise ValueError("exactly one of force_N, formula and file is needed")
        return self

    @property
    def text(self) -> str:
        """As on the command line."""
        return self.formula or self.file or repr(self.force_N)


def with_load(rig: "RigFile", text: str) -> "RigFile":
    """The rig with another load: a number in N, a CSV file, or else a formula of t. Raises UsageError for a bad number
    and for a file of another kind.

    >>> from smarig.config import load_rig
    >>> with_load(load_rig("one_wire_thermomechanical"), "24").load.force_N
    24.0
    """
    try:
        force_N = number_from_text(text)
    except ValueError:
        text = passed(text)
        if is_file(Path(text)) and not text.lower().endswith(".csv"):
            unknown = f"{text} is no load. Give a force in N, a formula of t, or a CSV file (time_s,force_N)."
            raise UsageError(swapped_file(Path(text), "a load") or unknown) from None
        by_file = text.lower().endswith(".csv")
        load = LoadFile(file=str(Path(text).resolve())) if by_file else LoadFile(formula=text)
    else:
        if not 0 < force_N <= 1e6:
            raise UsageError(
                f"The load {text} is not plausible. Give a force in N, more than 0 and below 1e6."
            )
        load = LoadFile(force_N=force_N)
    return rig.model_copy(update={"load": load})
