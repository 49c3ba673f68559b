"""Runs that cannot be compared with a model are refused with a sentence that names the file."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from record import runs
from smarig.core.errors import DataError, UsageError
from smarig.diagnosis.run_checks import check_comparable, check_held_out
from smarig.record import load_run
from smarig.runner.session import Session

MODEL: Any = SimpleNamespace(unit="mm")
OTHER_UNIT: Any = SimpleNamespace(unit="deg")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("comparable") / "steps.run.sqlite"
    with Session("one_wire_twin", wire="comparable") as session:
        session.run("validation", {"points": 3}, path)
    return path


@pytest.fixture
def edited(recorded, tmp_path):
    """The run after an SQL statement."""

    def edit(statement):
        path = tmp_path / "edited.run.sqlite"
        path.write_bytes(recorded.read_bytes())
        with runs.edited(path) as db:
            db.execute(statement)
        return load_run(path)

    return edit


def test_a_run_as_it_was_recorded_is_compared(recorded):
    check_comparable(MODEL, [load_run(recorded)])


def test_another_unit_is_refused(recorded):
    with pytest.raises(DataError, match=r"steps.run.sqlite measures in 'mm', the model in 'deg'"):
        check_comparable(OTHER_UNIT, [load_run(recorded)])


def test_several_wires_are_refused(recorded, edited):
    other = edited("""update run set value = '"another"' where key = 'wire'""")
    with pytest.raises(DataError, match=r"of one wire, .*steps.run.sqlite of 'comparable'.*of 'another'"):
        check_comparable(MODEL, [load_run(recorded), other])


@pytest.mark.parametrize(
    ("statement", "said"),
    [
        ("update sample set t_s = 0", "is not increasing"),
        ("update sample set t_s = -t_s", "is not increasing"),
        ("update sample set t_s = t_s * 1e9", "years according to its clock"),
        ("update sample set position = 1e20", "values of position are larger than any rig can measure"),
        ("update sample set current_A = -1e10", "values of current_A are larger"),
        ("update sample set ambient_degC = 1e20", "values of ambient_degC are no room temperatures"),
        ("update sample set ambient_degC = -300", "values of ambient_degC are no room temperatures"),
        ("update step set t_end_s = 1e20", "lies outside the times of the samples or has"),
        ("update step set t_end_s = t_start_s", "lies outside the times of the samples or has"),
        ("update step set t_start_s = -1e9", "lies outside the times of the samples or has"),
        ("update step set n = 0", "has 0 samples"),
        ("update step set n = 1000000000000000000", "has 1000000000000000000 samples"),
        ("update step set target = 1e20", "has an implausible target or position"),
        ("update step set position = -1e20", "has an implausible target or position"),
    ],
)
def test_what_cannot_be_is_refused(edited, statement, said):
    with pytest.raises(DataError, match=f"edited.run.sqlite.*{said}"):
        check_comparable(MODEL, [edited(statement)])


def test_a_copy_with_another_clock_is_no_other_run(recorded):
    run = load_run(recorded)
    later = replace(run, columns={**run.columns, "t_s": run["t_s"] + 5000.0, "tick": run["tick"] + 7})
    with pytest.raises(UsageError, match="hold the same readings"):
        check_held_out([run, later], [])
    with pytest.raises(UsageError, match="copy of a training run"):
        check_held_out([run], [later])
    other = replace(run, columns={**run.columns, "position": run["position"] + 1e-9})
    check_held_out([run, other], [])
