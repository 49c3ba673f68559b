"""The controller follows a ramp on a twin, with a model identified from a run on this twin."""

import json

import smarig
from smarig.cli import run


def test_it_follows_a_ramp(capsys):
    rig = ["--rig", "one_wire_twin", "--quiet"]
    levels = [0.0, 40.0, 90.0, 130.0, 170.0]
    curves = smarig.run("first_order_descending", rig="one_wire_twin", out="f.run.sqlite", partition_K=levels)
    smarig.identify(curves, surface="exponential").model.save("wire.model.json")
    words = ["track", "wire.model.json", "--reference", "ramps", "--set", "seconds=60", "--json"]
    assert run([*words, "--controller", "my_controller", *rig, "-o", "t.run.sqlite"]) == 0
    assert json.loads(capsys.readouterr().out)["track"]["rms_counts"] < 2
