"""Other packages use a package's front door only: the names in its ``__init__``."""

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import smarig

PACKAGE = Path(smarig.__file__).parent
DOORS = sorted(p.parent.name for p in PACKAGE.glob("*/__init__.py") if p.parent.name != "cli")


def package_of(module: str) -> str:
    """Top-level package of a module of smarig; "" for others."""
    parts = module.split(".")
    return parts[1] if parts[0] == "smarig" and len(parts) > 1 else ""


def imports_of_modules_of_others(file: Path, own: str) -> list[str]:
    """Imports that reach past the front door of another package."""
    found = [n for n in ast.walk(ast.parse(file.read_text("utf-8"))) if isinstance(n, ast.ImportFrom)]
    return [
        f"{file.name}: {n.module}"
        for n in found
        if n.module
        and n.module.count(".") > 1
        and package_of(n.module) not in ("", own)
        and not (file.name == "__init__.py" and n.module == "smarig.core.front_door")
    ]


def test_no_package_imports_a_module_of_another():
    past = [
        line
        for file in PACKAGE.rglob("*.py")
        for line in imports_of_modules_of_others(file, file.relative_to(PACKAGE).parts[0])
    ]
    assert past == []


def test_benchmarks_and_simulators_use_front_doors():
    root = PACKAGE.parents[1]
    files = [f for folder in ("benchmarks", "simulators") for f in (root / folder).rglob("*.py")]
    assert [line for f in files for line in imports_of_modules_of_others(f, "")] == []


@pytest.mark.parametrize("package", ["", *DOORS])
def test_what_a_front_door_lists_is_there(package):
    """Also where a module has the name of what it defines, and was imported before."""
    door = importlib.import_module(f"smarig.{package}".rstrip("."))
    for name in door.__all__:
        try:
            value = getattr(door, name)
        except ImportError as error:  # an extra that is not installed
            pytest.skip(str(error))
        assert value is not None, name


@pytest.mark.parametrize(
    ("module", "name"), [("identification.identify", "identify"), ("diagnosis.diagnose", "diagnose")]
)
def test_a_function_is_not_hidden_by_the_module_of_its_name(module, name):
    importlib.import_module(f"smarig.{module}")
    assert callable(getattr(importlib.import_module(f"smarig.{module.split('.')[0]}"), name))


def test_importing_a_package_imports_none_of_its_modules():
    code = "import sys, smarig, smarig.identification; print([m for m in sys.modules if m.startswith('smarig.id')])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "['smarig.identification']"


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = smarig.nothing
