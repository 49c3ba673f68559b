"""Two folders of a characterisation are compared by a run that shows loops, of one protocol on both days."""

from pathlib import Path

import pytest

from smarig.report import folder_contents
from smarig.report.folder_contents import runs_of_folders


@pytest.fixture(autouse=True)
def _protocol_in_the_name(monkeypatch):
    class Loaded:
        def __init__(self, file):
            self.info = type("Info", (), {"protocol": file.name.split("_", 1)[1]})

    monkeypatch.setattr(folder_contents, "load_run", Loaded)


def folder(day, *protocols):
    return [Path(day) / f"{k:02}_{name}" for k, name in enumerate(protocols, start=1)]


def test_the_curves_are_compared_not_the_initialisations():
    all_protocols = ("initialise", "wiping_out", "first_order_descending", "validation")
    files, protocol = runs_of_folders([folder("monday", *all_protocols), folder("tuesday", *all_protocols)])
    assert protocol == "first_order_descending"
    assert files == [Path("monday/03_first_order_descending"), Path("tuesday/03_first_order_descending")]


def test_a_protocol_that_only_one_folder_holds_is_not_compared():
    monday = folder("monday", "initialise", "first_order_descending", "validation")
    files, protocol = runs_of_folders([monday, folder("tuesday", "initialise", "validation")])
    assert (protocol, files) == ("validation", [Path("monday/03_validation"), Path("tuesday/02_validation")])


def test_without_a_common_protocol_only_initialisations_are_left_out():
    monday, tuesday = folder("monday", "initialise", "minor_loops"), folder("tuesday", "initialise", "steps")
    assert runs_of_folders([monday, tuesday]) == ([monday[1], tuesday[1]], "")
    assert runs_of_folders([monday[:1], tuesday[:1]]) == ([monday[0], tuesday[0]], "")
