"""A room that fluctuates by more than is noise is told as a dependence on time, though it fits best as noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.boxes import draw_world_box, write_box
from smarig.diagnosis import diagnose_commanded
from smarig.diagnosis.comparison.commanded.commanded_problem import CommandedProblem
from smarig.identification import identify
from smarig.record import load_run


@pytest.mark.parametrize(
    ("temperature_K", "correlation_s", "expected"),
    [(0.3, 300.0, True), (0.05, 300.0, False), (0.3, 30.0, False)],
)
def test_it_is_large_and_lasts_over_several_steps(temperature_K, correlation_s, expected):
    subject = SimpleNamespace(timeline=SimpleNamespace(settled=SimpleNamespace(t_s=60.0 * np.arange(20))))
    noise = SimpleNamespace(temperature_K=temperature_K, correlation_s=correlation_s)
    fitted = SimpleNamespace(refitted=SimpleNamespace(noise=noise))
    assert CommandedProblem.fluctuates(subject, fitted) is expected


@pytest.mark.long("takes a minute")
def test_an_open_door_is_told_as_time(tmp_path):
    box = draw_world_box(61001, 28, "sealed")
    assert list(box.hidden) == ["door"]
    files = write_box(box, tmp_path)
    train, held_out = ([load_run(path) for path in paths] for paths in (files.train, files.held_out))
    found = diagnose_commanded(identify(train, "positive").model, train, held_out)
    assert (found.verdict.word, found.verdict.depends_on) == ("unknown", "time")
    assert "fluctuate" in found.reason
