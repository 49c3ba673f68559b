"""A model of a run that ended early says so, once for each such run, with the time and the cause."""

import pytest

from identification.made_runs import fod_run
from smarig.identification import identify

TRIP = "stopped: The predicted temperature 151 K exceeds 150 K."


def warnings_of(*runs):
    return [w for w in identify(list(runs), "exponential").warnings if "ended early" in w]


@pytest.mark.parametrize("cause", [TRIP, "stop requested by the console", "failed: ValueError: no"])
def test_a_run_that_ended_early_is_named_once(cause):
    whole, part = (
        fod_run("one_e", seed=4),
        fod_run("one_e", seed=5, name="part.run.sqlite", end={"cause": cause}),
    )
    last_s = part["t_s"][-1]
    assert warnings_of(whole, part) == [
        f"part ended early at {last_s:.1f} s: {cause.rstrip('.')}. The model describes only the rows before."
    ]


@pytest.mark.parametrize("end", [{"cause": "done"}, None])
def test_a_run_that_ended_as_planned_or_does_not_say_gives_no_warning(end):
    assert warnings_of(fod_run("one_e", seed=4, end=end)) == []
