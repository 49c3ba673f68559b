"""Reads a file of any kind into what the library keeps. Whatever the file holds, the result is an entry or nothing."""

import math
import os
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from smarig.console.library.found_files import FoundFile
from smarig.console.library.library_entry import (
    DIAGNOSIS,
    MODEL,
    RUN,
    UNREADABLE,
    Content,
    one_line,
    path_of,
    shown_place,
)
from smarig.console.library.result_content import (
    diagnosis_content,
    model_content,
    page_content,
    place_identity,
)
from smarig.console.library.run_content import run_content
from smarig.core import SmarigError, error_text, printable

_LONGEST_ERROR = 1000
_LONGEST_LINE, _LONGEST_TEXT = 2000, 20_000  # characters
_MOST_VALUES = 1000  # of a table or list
_LINES = ("kind", "name", "wire", "rig", "protocol", "label", "sentence")


def read_content(folder: Path, found: FoundFile) -> Content | None:
    """The content of a file, with an error sentence if it cannot be read; None if it is no entry."""
    file = path_of(folder, found.place)
    try:
        with np.errstate(all="ignore"):
            content = _content(folder, file, found)
            return None if content is None else _storable(content)
    except SmarigError as error:
        sentence = str(error)
    except Exception as error:  # a file can be anything; the others must be listed all the same
        sentence = f"{shown_place(found.place)} cannot be read: {error_text(error)}."
    return Content(
        identity=place_identity(found.place),
        kind=found.kind,
        name=shown_place(os.path.basename(found.place)),  # noqa: PTH119 - bytes
        began=found.modified_ns / 1e9,
        verdict=UNREADABLE,
        error=one_line(sentence.replace(f"{folder}{os.sep}", ""), _LONGEST_ERROR),
    )


def _content(folder: Path, file: Path, found: FoundFile) -> Content | None:
    if found.kind == RUN:
        return run_content(file)
    if found.kind == MODEL:
        return model_content(file, folder)
    if found.kind == DIAGNOSIS:
        return diagnosis_content(file, found.place)
    return page_content(file, found.place)


def _storable(content: Content) -> Content:
    """The content with texts of one printable line, and numbers that JSON has."""
    lines: dict[str, Any] = {name: one_line(getattr(content, name), _LONGEST_LINE) for name in _LINES}
    finite = {name: each for name, each in content.figures.items() if math.isfinite(each[0])}
    return replace(content, **lines, details=_plain(content.details), figures=finite)


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return printable(value, _LONGEST_TEXT)
    if isinstance(value, dict):
        return {one_line(str(k), _LONGEST_LINE): _plain(v) for k, v in islice(value.items(), _MOST_VALUES)}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value[:_MOST_VALUES]]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int) else printable(str(value), _LONGEST_TEXT)
