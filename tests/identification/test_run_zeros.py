"""Files whose outputs start at arbitrary zeros: fitted if the mapping states it, and noticed if it does not."""

from dataclasses import replace

import numpy as np
import pytest

from identification.made_runs import driven_run
from smarig.identification import identify, verify

PEAKS = ([0, 40, 80, 40, 0], [0, 120, 60, 20, 0], [0, 150, 100, 50, 0])


def _runs(offsets=(0.0, 3.0, -2.0), **meta):
    """Three imported loops from negative saturation, each with an offset of the output."""
    paths = [np.concatenate([np.linspace(a, b, 9)[1:] for a, b in zip(p, p[1:])]) for p in PEAKS]
    return [
        driven_run("one_e", u, name=f"{k}.run.sqlite", offset=offset).with_meta(source="import", **meta)
        for k, (u, offset) in enumerate(zip(paths, offsets))
    ]


def test_runs_with_zeros_of_their_own_fit_as_well_as_runs_with_one_zero():
    shared, own = (
        identify(_runs((0.0, 0.0, 0.0)), "positive"),
        identify(_runs(encoder_zero="own"), "positive"),
    )
    assert own.model.fit["rms"] == pytest.approx(shared.model.fit["rms"], rel=0.5)
    assert not any("different zeros" in w for w in own.warnings)
    verified = verify(own.model, _runs(encoder_zero="own")).runs
    assert max(r.settled.rms for r in verified) < 3 * own.model.fit["rms"]


def test_a_falling_output_is_followed_with_zeros_of_its_own():
    """Without a measure, free zeros alone explain most of such outputs."""
    runs = _runs((0.0, 60.0, -90.0), encoder_zero="own")
    falling = [run.with_meta() for run in runs]
    for run in falling:
        run.columns["position"] *= -1
    falling = [replace(run, steps=()) for run in falling]
    found = identify(falling, "positive")
    assert any("The output falls while the input rises" in w for w in found.warnings)
    assert found.model.fit["rms"] < 0.05 * np.ptp(falling[0]["position"])


def test_different_zeros_that_were_not_stated_are_noticed():
    found = identify(_runs(), "positive")
    (said,) = [w for w in found.warnings if "different zeros of the output" in w]
    assert 'write zero = "own" under [output] of the mapping' in said
    assert not any("different zeros" in w for w in identify(_runs((0, 0, 0)), "positive").warnings)


def test_without_an_encoder_the_zero_is_that_of_the_output():
    (run, *_), model = _runs(), identify(_runs((0, 0, 0)), "positive").model
    (said,) = [w for w in verify(model, run).runs[0].warnings if "additive offset" in w]
    assert said.startswith("The zero of the output is not known for this run")
