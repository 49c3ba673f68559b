"""The public names of each package, imported on first use."""

import ast
import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any


class _LazyPackage(ModuleType):
    """A package whose exported names are not overwritten by its modules of the same name."""

    def __setattr__(self, name: str, value: Any) -> None:
        # importing pkg.identify sets pkg.identify to the module, but the package exports the function of that name
        if isinstance(value, ModuleType) and name in self.__dict__.get("__all__", ()):
            return
        super().__setattr__(name, value)


def lazy_exports(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package, from the imports under its ``if TYPE_CHECKING:``.

    Type checkers read the same list. Importing a package imports none of its modules.
    """
    module = sys.modules[package]
    homes = _listed(Path(str(module.__file__)))
    module.__class__ = _LazyPackage

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        home = importlib.import_module(homes[name])
        value = None if home is module else getattr(home, name, None)
        if value is None:  # the exported name is a module
            value = importlib.import_module(f"{homes[name]}.{name}")
        module.__dict__[name] = value
        return value

    return get, lambda: sorted(homes), sorted(homes)


def _listed(file: Path) -> dict[str, str]:
    """Maps each exported name to its module, from the imports under ``if TYPE_CHECKING:``."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    blocks = (
        node.body
        for node in tree.body
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    )
    imports = (node for block in blocks for node in block if isinstance(node, ast.ImportFrom))
    return {alias.name: str(node.module) for node in imports for alias in node.names}
