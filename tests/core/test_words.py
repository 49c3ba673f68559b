"""The values exchanged between packages: errors, samples and commands."""

import copy
import pickle

import pytest

from smarig.core import command, errors, sample
from smarig.core.errors import UsageError


def test_exit_statuses_are_the_contract():
    """Design §4.1: 2 usage or configuration, 3 rig, 4 data, 5 in use, 130 interrupted."""
    status = {
        errors.UsageError: 2,
        errors.ConfigError: 2,
        errors.RigFault: 3,
        errors.LimitExceeded: 3,
        errors.LeaseExpired: 3,
        errors.DataError: 4,
        errors.StorageError: 4,
        errors.InUse: 5,
        errors.Interrupted: 130,
    }
    assert {kind: kind("x").exit_status for kind in status} == status
    assert all(issubclass(kind, errors.SmarigError) for kind in status)


def test_quality_marks_combine_and_store_as_integers():
    marks = sample.Quality.RETRIED | sample.Quality.SATURATED
    assert int(marks) == 5
    assert sample.Quality(5) == marks
    assert sample.Quality.STALE not in marks
    assert not sample.Quality.GOOD
    powers = [int(q) for q in sample.Quality.__members__.values() if q]  # members, not single bits
    assert powers == [1 << k for k in range(len(powers))]


@pytest.mark.parametrize(
    "word",
    [
        command.Hold(0.5, command.Settled(), target=43.5, branch="rise"),
        command.Hold(0.5, command.Elapsed(3.0)),
        command.Waveform((0.1, 0.2), 0.1),
        command.Drive(0.3),
        command.Zero(),
        command.Mark("here", {"x": 1}),
    ],
)
def test_commands_are_inert_values(word):
    """Commands can be printed, compared and stored, and are immutable."""
    assert copy.deepcopy(word) == word
    assert pickle.loads(pickle.dumps(word)) == word
    assert type(word).__name__ in repr(word)
    for name in (*word.__slots__, "new"):
        with pytest.raises((AttributeError, TypeError)):
            setattr(word, name, 9.0)


@pytest.mark.parametrize(
    "wrong",
    [
        {"band_counts": 0.0},
        {"band_counts": float("nan")},
        {"window_s": -1.0},
        {"window_s": 25.0, "timeout_s": 24.0},
        {"timeout_s": float("nan")},
    ],
)
def test_settling_that_cannot_be_is_refused(wrong: dict):
    with pytest.raises(UsageError, match="Settling needs band_counts > 0"):
        command.Settled(**wrong)


def test_settling_defaults_are_the_thesis():
    """§5.2.1: constant for 25 s."""
    assert command.Settled().window_s == 25.0
    assert command.Settled().timeout_s > command.Settled().window_s


def test_verdicts_are_what_the_record_stores():
    assert [str(v) for v in command.StepVerdict][:3] == ["settled", "timed_out", "elapsed"]
