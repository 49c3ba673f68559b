"""Titles of pages: protocol, wire, load and date, as far as all runs share them."""

from types import SimpleNamespace

import pytest

from smarig.report.runs.run_title import titled

MONDAY, TUESDAY = 1.7640e9, 1.7640e9 + 86400


def run(wire="wire-7", load=None, epoch=MONDAY):
    conditions = {"stress": {"mean": load, "unit": "MPa"}} if load is not None else {"room": {"mean": 22.0}}
    return SimpleNamespace(info=SimpleNamespace(wire=wire, conditions=conditions, start_epoch=epoch))


@pytest.mark.parametrize(
    ("runs", "title"),
    [
        ([run()], "Validation of wire-7, 2025-11-24"),
        ([run(load=100.0)], "Validation of wire-7, 100 MPa, 2025-11-24"),
        ([run(load=100.0), run(load=200.0)], "Validation of wire-7, 2025-11-24"),
        ([run(load=100.0), run()], "Validation of wire-7, 2025-11-24"),
        ([run(), run("wire-8", epoch=TUESDAY)], "Validation, 2025-11-24 to 2025-11-25"),
        ([run(wire="", epoch=None)], "Validation"),
    ],
)
def test_what_all_runs_share_is_in_the_title(runs, title):
    assert titled("Validation", runs) == title
