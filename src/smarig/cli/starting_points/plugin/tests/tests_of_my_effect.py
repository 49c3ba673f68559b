"""A twin has the effect when a command names it. At zero strength the twin is unchanged, bit for bit."""

import numpy as np

import smarig
from smarig.cli import run


def _positions(*effect: str) -> np.ndarray:
    words = ["run", "validation", "--rig", "one_wire_twin", "--set", "points=2", "--quiet", "--force"]
    assert run([*words, *effect, "-o", "v.run.sqlite"]) == 0
    return smarig.load_run("v.run.sqlite")["position"]


def test_the_twin_has_the_effect():
    plain, without, changed = (
        _positions(),
        _positions("--effect", "my_effect=0"),
        _positions("--effect", "my_effect=20"),
    )
    assert np.array_equal(without, plain, equal_nan=True)
    both = min(len(plain), len(changed))  # an effect changes how long the wire needs to settle
    assert np.nanmax(np.abs(changed[:both] - plain[:both])) > 0.1
