"""The protocol runs on a twin to its end."""

import smarig


def test_it_runs_on_a_twin():
    run = smarig.run("my_protocol", rig="one_wire_twin", out="p.run.sqlite", loops=1, points=2)
    assert run.cause == "done"
    assert [step.branch for step in run.steps].count("loop 0") == 4
