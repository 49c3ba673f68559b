"""What the training runs of a rig do not determine is missing knowledge; a wire that walks has changed."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from benchmarks.boxes import write_box
from smarig.diagnosis.comparison.commanded import undetermined
from smarig.diagnosis.comparison.commanded.commanded_evidence import _beyond_limit
from smarig.diagnosis.comparison.commanded.compared_runs import subject_of
from smarig.diagnosis.comparison.commanded.undetermined import missing_knowledge_of
from smarig.diagnosis.comparison.missing_knowledge import MissingKnowledge
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.identification import identify
from smarig.record import load_run
from tests.diagnosis.short_boxes import short_box

NOISE = 0.02  # output units


def missing(hidden: dict[str, dict[str, float]], train: str, held_out: str) -> MissingKnowledge | None:
    with TemporaryDirectory() as folder:
        box = short_box(3, hidden)
        runs = {str(run.info.protocol): run for run in map(load_run, write_box(box, Path(folder)).train)}
        first, second = [runs[train]], [runs[held_out]]
        subject = subject_of(identify(first, "positive").model, first, second)
        return missing_knowledge_of(subject, subject.base.plant_model, NOISE, first, second)


def test_inner_loops_that_no_training_run_turned_are_missing_knowledge() -> None:
    found = missing({}, "wiping_out", "congruency")
    assert found is not None
    assert found.share == pytest.approx(1.0, abs=0.1)
    assert found.inputs[0] < found.inputs[1]


def test_a_wire_that_walks_between_the_runs_is_no_missing_knowledge() -> None:
    assert missing({"walking": {"percent_per_cycle": 3.0}}, "wiping_out", "congruency") is None


@pytest.mark.long("takes five seconds")
def test_a_positive_measure_of_all_runs_tells_it_where_a_smooth_density_fits_worse(monkeypatch) -> None:
    """A smooth density can leave what would look like a change of the wire."""
    monkeypatch.setattr(undetermined, "with_posterior_density", lambda *given: given[-1])
    found = missing({}, "wiping_out", "congruency")
    assert found is not None
    assert found.share == pytest.approx(1.0, abs=0.1)
    assert missing({"walking": {"percent_per_cycle": 3.0}}, "wiping_out", "congruency") is None


@pytest.mark.parametrize(("noise", "beyond"), [(0.02, 3.0), (0.1, 1.0)])
def test_what_held_out_runs_show_beyond_the_limit_exceeds_the_noise_as_well(
    noise: float, beyond: float
) -> None:
    error = np.full(6, 0.1)
    weight = np.array([1.0, 1.0, 1.0, 100.0, 100.0, 100.0])
    gain = HeldOutGain(error, error, np.arange(6), floor=0.1 / 3, weight=weight)
    assert _beyond_limit(gain, noise) == pytest.approx(beyond)
