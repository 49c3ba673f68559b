"""Numbers that nothing measured can be are read as missing, and the run says so."""

from dataclasses import replace

import numpy as np
import pytest

from record.runs import META, result, sample
from smarig.record import Recorder, load_run, stored_run


@pytest.mark.parametrize("number", [1e308, -1e308, 1.1e30, float("inf"), float("-inf")])
def test_such_a_number_is_missing_and_counted(tmp_path, number):
    recorder = Recorder(tmp_path / "a.run.sqlite", META)
    for tick in range(5):
        changes = {"position": number, "voltage_V": number} if tick == 3 else {}
        recorder.sample(sample(tick, **changes), 0, 1.0)
    recorder.close()
    run = load_run(recorder.path)
    assert np.flatnonzero(np.isnan(run["position"])).tolist() == [3]
    assert np.flatnonzero(np.isnan(run["voltage_V"])).tolist() == [3]
    assert run.info.warnings == (
        "1 sample(s) or step(s) hold a number over 1e+30, which nothing measured can be. It counts as missing.",
    )
    with stored_run(recorder.path) as stored:
        assert np.flatnonzero(np.isnan(stored["position"])).tolist() == [3]
        assert stored.extremes("voltage_V") == (2.4, 2.4)


def test_such_a_number_of_a_step_is_missing_and_counted(tmp_path):
    recorder = Recorder(tmp_path / "a.run.sqlite", META)
    recorder.sample(sample(0), 0, 1.0)
    recorder.step(replace(result(0), position=float("inf")), branch="rise", target=1.0)
    recorder.close()
    run = load_run(recorder.path)
    assert run.steps[0].position is None
    assert not run.settled
    assert len(run.info.warnings) == 1


def test_the_largest_measurable_number_is_kept(tmp_path):
    recorder = Recorder(tmp_path / "a.run.sqlite", META)
    recorder.sample(sample(0, position=1e30), 0, 1.0)
    recorder.close()
    run = load_run(recorder.path)
    assert run["position"].tolist() == [1e30]
    assert not run.info.warnings
