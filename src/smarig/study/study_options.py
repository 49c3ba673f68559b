"""The options of a study, which also decide whether an old result still holds."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Literal

from smarig.core import file_bytes, is_file, opened_file

Split = Literal["auto", "run", "time", "curve", "load", "none"]
SPLITS: tuple[Split, ...] = ("auto", "run", "time", "curve", "load", "none")


@dataclass(frozen=True)
class StudyOptions:
    """Options: how to split, a given mapping, and corrections of the guesses.

    ``input`` and ``output`` are names of columns, ``units`` units by column. ``accept``: take the draft even where a
    guess is not sure. ``diagnose``: also look for the causes of the model's errors.
    """

    split: Split = "auto"
    mapping: str | None = None
    input: str | None = None
    output: str | None = None
    units: dict[str, str] = field(default_factory=dict)
    accept: bool = False
    diagnose: bool = True


def study_key(files: Sequence[Path], options: StudyOptions) -> str:
    """A hash of the files' bytes, of the options and of the version: equal for equal studies.

    Modification times are no part of it: copying changes them.

    Raises UsageError for what is no regular file, and OSError.
    """
    total = hashlib.sha256(json.dumps(asdict(options), sort_keys=True).encode())
    total.update(version("smarig").encode())
    if options.mapping is not None and is_file(Path(options.mapping)):
        total.update(file_bytes(Path(options.mapping)))
    for file in files:
        with opened_file(file) as stream:
            total.update(f"{file.name}\n{hashlib.file_digest(stream, 'sha256').hexdigest()}\n".encode())
    return total.hexdigest()
