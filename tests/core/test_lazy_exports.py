"""The public names of packages: every name in an ``__init__`` exists, and nothing is imported before it is
used.

A contract of import-linter (``import_contracts``) checks that other packages import nothing else.
"""

import ast
import importlib
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import smarig
import smarig.core
import smarig.preisach
from smarig.core import MissingExtra
from smarig.core.lazy_exports import _value

PACKAGE = Path(smarig.__file__).parent
PACKAGES = sorted(p.parent.name for p in PACKAGE.glob("*/__init__.py") if p.parent.name != "cli")


@pytest.mark.parametrize("package", ["", *PACKAGES])
def test_every_listed_name_is_there(package):
    """Also where a module has the name of what it defines, and was imported before."""
    module = importlib.import_module(f"smarig.{package}".rstrip("."))
    without = []
    for name in module.__all__:
        try:
            assert getattr(module, name) is not None, name
        except MissingExtra as error:
            without.append(error)
    if without:
        raise without[0]


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


def test_a_listed_name_that_does_not_exist_is_an_attribute_error():
    package = type(smarig)("smarig.core")
    with pytest.raises(AttributeError, match="lists 'nothing', which smarig.core.errors does not have"):
        _value(package, "smarig.core.errors", "nothing")


def test_a_package_is_pickled_by_its_name():
    assert pickle.loads(pickle.dumps(smarig.preisach)) is smarig.preisach


def test_a_module_of_the_user_replaces_an_exported_name(monkeypatch):
    monkeypatch.setattr(smarig.core, "file_content", ast)
    assert smarig.core.file_content is ast


def test_dir_shows_public_names_and_module_attributes():
    assert {"Session", "__file__", "__doc__"} <= set(dir(smarig))


def test_it_can_be_imported_from_a_zip_file(tmp_path):
    shutil.make_archive(str(tmp_path / "packed"), "zip", PACKAGE.parent, "smarig")
    code = "import smarig; from smarig.preisach import Preisach; print(Preisach.__module__, smarig.__file__)"
    found = subprocess.run(
        [
            sys.executable,
            "-S",
            "-c",
            f"import sys; sys.path[:0] = [{str(tmp_path / 'packed.zip')!r}, *{sys.path!r}]; {code}",
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "packed.zip" in found.stdout
