"""The public names of packages: every name in an ``__init__`` exists, and nothing is imported before it is
used.

A contract of import-linter (``import_contracts``) checks that other packages import nothing else.
"""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import smarig

PACKAGE = Path(smarig.__file__).parent
PACKAGES = sorted(p.parent.name for p in PACKAGE.glob("*/__init__.py") if p.parent.name != "cli")


@pytest.mark.parametrize("package", ["", *PACKAGES])
def test_every_listed_name_is_there(package):
    """Also where a module has the name of what it defines, and was imported before."""
    module = importlib.import_module(f"smarig.{package}".rstrip("."))
    for name in module.__all__:
        try:
            value = getattr(module, name)
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
