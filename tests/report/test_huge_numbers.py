"""Numbers near the largest that there is: a page all the same, which says that they count as missing."""

from dataclasses import replace

import pytest

from record.runs import META, result, sample
from report.pages import Page
from smarig.cli import run
from smarig.record import Recorder

HUGE = 1e308


@pytest.fixture
def huge(tmp_path):
    """A run with huge numbers of both signs in every column that can have them."""
    own = Recorder(tmp_path / "huge.run.sqlite", META)
    for tick in range(60):
        big = HUGE * (-1) ** tick if tick % 7 == 3 else 0.0
        there = {
            "position": big,
            "current_A": big,
            "voltage_V": -big,
            "temperature_degC": big,
            "ambient_degC": big,
        }
        own.sample(sample(tick, **there) if big else sample(tick), tick // 20, big or float(tick % 20))
        if tick % 20 == 19:
            own.step(replace(result(tick // 20), position=HUGE * (-1) ** tick), branch="rise", target=HUGE)
    own.close()
    return own.path


def test_a_run_with_huge_numbers_has_a_page(huge, tmp_path, capsys):
    out = tmp_path / "a.html"
    assert run(["report", str(huge), "-o", str(out)]) == 0, capsys.readouterr().err
    assert "hold a number over 1e+30, which nothing measured can be" in Page(out.read_text()).visible


def test_two_such_runs_are_compared(huge, tmp_path, capsys):
    other = tmp_path / "other.run.sqlite"
    other.write_bytes(huge.read_bytes())
    status = run(["report", str(huge), str(other), "-o", str(tmp_path / "b.html")])
    assert status in (0, 4), capsys.readouterr().err
