"""When a run began, by the clock of the computer."""

import time

from console.library.folders import make_run, refreshed


def test_no_run_began_after_it_had_ended(tmp_path):
    """The clock of a fast twin runs ahead: the fifth run of a session of seconds begins hours later by it."""
    make_run(tmp_path / "fast.run.sqlite", start_epoch=time.time() + 9000.0)
    (found,) = refreshed(tmp_path).search("fast").entries
    assert found.began == found.details["ended"] <= time.time()
