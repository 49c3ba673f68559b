"""The package of ``smarig new plugin`` for the tests of plug-ins."""

import os
import sys

import pytest

from cli.plugin_site import KINDS, imported, install_project
from smarig.cli import run as cli
from smarig.core.catalogue import own_files


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A package with an example of every kind, and its metadata beside it as an editable installation leaves them."""
    folder = tmp_path_factory.mktemp("plugins")
    assert cli(["new", "plugin", "acme", *KINDS, "-o", str(folder / "acme")]) == 0
    install_project(folder / "acme" / "src", folder / "acme")
    return folder / "acme"


@pytest.fixture
def acme(project, tmp_path, monkeypatch):
    """An empty folder in which commands see the package; its modules are forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(project / "src")
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(project / "src"), os.environ.get("PYTHONPATH", "")])
    )
    with own_files():
        yield tmp_path
    for name in imported():
        del sys.modules[name]
