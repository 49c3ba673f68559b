"""Loops that are shifted from one cycle to the next, by less than a noisy thermometer hides on the steep branches."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from diagnosis.measured.independent_wire import as_run
from smarig.diagnosis import diagnose
from smarig.exchange.loop_faults import LoopRecord, loop_findings
from smarig.identification import identify

STROKE, CYCLES, ROWS = 4.0, 30, 60  # %; rows of one branch
LEFT_BEHIND, WITHIN = 0.06 * STROKE, 8.0  # cycles
NOISE = (4.0, 0.002)  # K, %


def cycles(left_behind=0.0, first_strain=STROKE):
    """Temperatures and strains of thermal cycles; a saturating ``left_behind`` is added with each of them.

    Two logistic branches: heating at 125 °C, cooling at 108 °C.
    """
    up = np.linspace(30.0, 300.0, ROWS)
    temperature = np.tile(np.concatenate([up, up[::-1]]), CYCLES)
    middle = np.tile(np.repeat([125.0, 108.0], ROWS), CYCLES)
    strain = STROKE / (1 + np.exp((temperature - middle) / 6.0))
    strain[:ROWS] *= first_strain / STROKE
    number = np.arange(temperature.size) / (2 * ROWS)
    return temperature, strain + left_behind * (1 - np.exp(-number / WITHIN))


@cache
def any_model():
    """A model to compare with; the diagnosis refits everything itself."""
    u, y = (part[: 4 * ROWS] for part in cycles())
    return identify(as_run("any", u, y, noise=(0.05, 0.002)), "positive").model


def diagnosed(seed=0, **kinds):
    return diagnose(any_model(), [as_run("cycles", *cycles(**kinds), noise=NOISE, seed=seed)])


def test_cycles_that_leave_a_strain_behind_are_named():
    found = diagnosed(left_behind=LEFT_BEHIND)
    assert found.verdict.names == ("ratcheting",)
    assert found.best.rms > 0.9 * found.base.rms, (
        "over all readings, the gain is hidden in the noise of the steep ones"
    )
    values = found.effects()[0]["parameters"]
    assert values["amplitude"]["value"] == pytest.approx(LEFT_BEHIND, rel=0.15)
    low, high = values["cycles"]["ci95"]
    assert low <= WITHIN <= high


@pytest.mark.parametrize("seed", range(20))
def test_cycles_that_close_are_silent(seed):
    found = diagnosed(seed)
    assert found.verdict.word == "silent"
    assert not found.effects()


def test_a_first_heating_from_another_state_is_left_out_and_said():
    found = diagnosed(first_strain=0.0)
    assert not found.effects()
    assert found.base.rms < 0.05 * STROKE
    assert "The first branch of cycles differs from all later ones" in found.text()


@pytest.mark.parametrize(("first", "words"), [(STROKE, 0), (0.0, 1)])
def test_the_import_counts_no_first_branch_of_another_state_as_a_loop_that_does_not_close(first, words):
    u, y = cycles(first_strain=first)
    found = loop_findings(LoopRecord(u, y, np.arange(u.size), "degC", "%"))
    assert not any("does not close" in s for s in found)
    assert sum("first branch differs" in s for s in found) == words


def test_the_import_gives_the_change_of_later_visits():
    u, y = cycles(LEFT_BEHIND, first_strain=0.0)
    low, high = [
        s for s in loop_findings(LoopRecord(u, y, np.arange(u.size), "degC", "%")) if "does not close" in s
    ]
    for sentence, ends in ((low, slice(2 * ROWS, None, 2 * ROWS)), (high, slice(ROWS, None, 2 * ROWS))):
        change = sum(b - a for a, b in pairwise(y[ends]))
        assert f"({100 * change / np.ptp(y):+.1f} % of the range)" in sentence
