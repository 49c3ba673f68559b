"""Loads a user's own file: the object that it defines under its own name, checked for its catalogue."""

import hashlib
import importlib
import sys
import traceback
from dataclasses import dataclass
from keyword import iskeyword
from pathlib import Path
from types import ModuleType
from typing import Any

from smarig.core.errors import UsageError
from smarig.core.plugin import PluginOffer, plugin_folder
from smarig.core.regular_file import file_bytes
from smarig.core.shown_text import error_text


@dataclass(frozen=True)
class OwnFile:
    """An entry from outside of smarig: a user's own file, or the module of a plug-in.

    Its path as given and as resolved, the executed bytes, the object that it defines, and the plug-in's ``offer``.
    """

    name: str
    path: Path
    place: Path
    data: bytes
    found: Any
    offer: PluginOffer | None = None

    @property
    def text(self) -> str:
        """Its text; "" for the machine code of a plug-in."""
        return self.data.decode("utf-8-sig") if self.offer is None or self.path.suffix == ".py" else ""

    @property
    def sha256(self) -> str:
        """SHA-256 hash of its bytes."""
        return hashlib.sha256(self.data).hexdigest()

    @property
    def reference(self) -> str:
        """What a user gives to use it, in any folder: the path of a file, the name of a plug-in."""
        return str(self.place) if self.offer is None else self.name

    def blamed(self, error: BaseException) -> str:
        """A sentence with file and line if the error was raised in it; otherwise ""."""
        if self.offer is None:
            return line_of(error, str(self.path))
        folder = plugin_folder(self.path)
        frames = [f.filename for f in traceback.extract_tb(error.__traceback__)]
        inside = [f for f in frames if Path(f) == folder or folder in Path(f).parents]
        return f"{self.offer.origin}: {line_of(error, inside[-1])}" if inside else ""


def read_own_file(path: Path) -> bytes:
    """The bytes of a UTF-8 text file. Raises UsageError if it cannot be read."""
    try:
        data = file_bytes(path)
        data.decode("utf-8-sig")
        return data
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}.") from None
    except UnicodeDecodeError:
        raise UsageError(f"{path} is not a UTF-8 text file.") from None


def check_own_name(path: Path, kind: str, shipped_names: list[str]) -> None:
    """Raise UsageError if the name of a file cannot be the name of an entry of this kind."""
    if not path.stem.isidentifier() or iskeyword(path.stem):
        raise UsageError(
            f"{path}: '{path.stem}' is not a valid Python name. Rename the file; use letters, digits and _."
        )
    if path.stem in shipped_names:
        raise UsageError(
            f"{path}: '{path.stem}' is the name of a shipped {kind}. Rename the file and the {kind} in it."
        )


def load_own_file(package: str, kind: str, path: Path, data: bytes) -> Any:
    """The object that the file defines under its own name, checked for the catalogue ``package``."""
    name = path.stem
    module = ModuleType(f"_own_{kind}_{name}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses look up their module there
    try:
        exec(compile(data, str(path), "exec"), module.__dict__)
    except SyntaxError as error:  # in this file or in a file that it imports
        raise UsageError(f"{error.filename or path}, line {error.lineno or 1}: {error.msg}.") from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # older Pythons raise ValueError without a line for null bytes
        raise UsageError(line_of(error, str(path)) or f"{path} cannot be loaded: {error}.") from None
    if name not in vars(module):
        raise UsageError(f"{path} defines no '{name}': the {kind} must have the file's name.")
    found = vars(module)[name]
    misfit = getattr(importlib.import_module(package), "misfit", None)
    reason = misfit(name, found) if misfit else ""
    if reason:
        raise UsageError(f"{path}: {reason}.")
    return found


def line_of(error: BaseException, path: str) -> str:
    """The last line of the file in the traceback, with the error's message; "" if the file is not in it."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == path]
    return f"{path}, line {lines[-1]}: {error_text(error)}." if lines else ""
