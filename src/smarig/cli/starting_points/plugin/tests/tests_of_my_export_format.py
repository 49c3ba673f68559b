"""What is written is read back equal to the run."""

import json
from pathlib import Path

import numpy as np

import smarig
from smarig.cli import run


def test_it_is_read_back():
    recorded = smarig.run("validation", rig="one_wire_twin", out="v.run.sqlite", points=2)
    assert run(["export", "v.run.sqlite", "--to", "my_export_format", "-o", "v.json"]) == 0
    found = json.loads(Path("v.json").read_text(encoding="utf-8"))
    assert found["units"]["position"] == "mm"
    assert np.array_equal(np.array(found["columns"]["position"], float), recorded["position"], equal_nan=True)
