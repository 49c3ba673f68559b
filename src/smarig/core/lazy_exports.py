"""The public names of each package, imported on first use."""

import ast
import importlib
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any


class _LazyPackage(ModuleType):
    """A package whose exported names are not overwritten by its modules of the same name."""

    def __setattr__(self, name: str, value: Any) -> None:
        # importing pkg.identify sets pkg.identify to the module, but the package exports the function of that name
        is_own_module = isinstance(value, ModuleType) and value is sys.modules.get(f"{self.__name__}.{name}")
        if is_own_module and name in self.__dict__.get("__all__", ()):
            return
        super().__setattr__(name, value)

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        """Pickled by name: functions of a notebook that use a package can go to another process."""
        return importlib.import_module, (self.__name__,)


def lazy_exports(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package, from the imports under its ``if TYPE_CHECKING:``.

    Call it in the ``else:`` of that block: type checkers then read the same list and report every other name. Importing
    a package imports none of its modules. Raises ImportError if the package was installed without its source text.
    """
    module = sys.modules[package]
    exports = _listed(_source(module))
    module.__class__ = _LazyPackage

    def get(name: str) -> Any:
        if name not in exports:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        home, original = exports[name]
        value = _value(module, home, original)
        module.__dict__[name] = value
        return value

    return get, lambda: sorted({*exports, *module.__dict__}), sorted(exports)


def _value(package: ModuleType, home: str, name: str) -> Any:
    """The object ``name`` of the module ``home``, or the module ``home.name``."""
    found = importlib.import_module(home)
    if found is not package and hasattr(found, name):
        return getattr(found, name)
    try:
        return importlib.import_module(f"{home}.{name}")
    except ModuleNotFoundError as error:
        if error.name != f"{home}.{name}":  # an extra that is not installed
            raise
        raise AttributeError(f"{package.__name__} lists {name!r}, which {home} does not have") from None


def _source(module: ModuleType) -> str:
    """The text of a package's ``__init__``, also in a zip file."""
    loader: Any = module.__spec__.loader if module.__spec__ else None
    source = loader.get_source(module.__name__) if hasattr(loader, "get_source") else None
    if source is None:
        raise ImportError(
            f"{module.__name__} needs the source text of its __init__.py. Install it with its .py files."
        )
    return source


def _listed(source: str) -> dict[str, tuple[str, str]]:
    """Maps each exported name to its module and its name there, from the imports under ``if TYPE_CHECKING:``."""
    blocks = (
        node.body
        for node in ast.parse(source).body
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    )
    imports = (node for block in blocks for node in block if isinstance(node, ast.ImportFrom))
    return {a.asname or a.name: (str(node.module), a.name) for node in imports for a in node.names}
