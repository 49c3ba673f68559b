"""Sweeps at two rates: the wire moves at them, turns where asked, and stays within the limits."""

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from smarig.core.command import Hold, StepResult, StepVerdict, Waveform
from smarig.core.errors import UsageError
from smarig.protocols._settings import build_protocol
from smarig.protocols._setup import Setup

RIGS = ("one_wire_twin", "two_wire_twin")


def driven(setup, settings=None):
    """(wire temperature, current) of each step, by a first-order low-pass written here."""
    parts = []
    for command in build_protocol("continuous_reversal_curves", setup, settings or {}):
        if isinstance(command, Hold):
            currents = [command.current_A] * round(command.until.seconds / setup.period_s)
            parts.append((command.branch, currents))
        elif isinstance(command, Waveform):
            parts.append((command.branch, list(command.currents_A)))
    current = np.concatenate([c for _, c in parts])
    steady = setup.actuator.gain_K_per_A2 * current**2 * np.where(current < 0, -1, 1)
    decay = np.exp(-setup.period_s / setup.tau_s)
    from scipy.signal import lfilter

    u = lfilter([1 - decay], [1, -decay], steady)
    ends = np.cumsum([0, *(len(c) for _, c in parts)])
    return [(name, u[a:b], current[a:b]) for (name, _), (a, b) in zip(parts, pairwise(ends))]


@pytest.mark.parametrize("rig", RIGS)
def test_the_wire_turns_at_the_reversal_inputs(rig):
    setup = Setup.of(rig)
    steps = driven(setup)
    rises = [u for name, u, _ in steps if name.startswith("rise ") and "again" not in name]
    span = setup.upper_K - setup.lower_K
    asked = [setup.lower_K + span * (k + 1) / len(rises) for k in range(len(rises))]
    assert len(rises) == 13
    assert [u.max() for u in rises[:-1]] == pytest.approx(asked[:-1], abs=0.025 * span)
    assert all(a.max() < b.max() for a, b in pairwise(rises))
    assert max(u.max() for name, u, _ in steps if name == "top") == pytest.approx(setup.upper_K, abs=0.1)
    falls = [u for name, u, _ in steps if name.startswith("fall")]
    assert max(u[-1] for u in falls) < setup.lower_K + 0.05 * span + 1e-9


def test_the_wire_rests_at_the_lower_end_until_its_position_is_constant():
    """Counts that fall by half from rest to rest: the last two differ by less than a count."""
    protocol, rests, counts = (
        build_protocol("continuous_reversal_curves", Setup.of("one_wire_twin"), {}),
        {},
        0.0,
    )
    command = next(protocol)
    with suppress(StopIteration):
        while True:
            branch = getattr(command, "branch", "")
            if branch.startswith("rest"):
                rests[branch] = rests.get(branch, 0) + 1
                counts /= 2
            else:
                counts = 20.0
            command = protocol.send(StepResult(0, StepVerdict.ELAPSED, 0.0, counts, 0.0, 1, 0.0, 0.0))
    assert len(rests) == 14
    assert set(rests.values()) == {5}  # 10, 5, 2.5, 1.25, 0.63


def test_curves_below_the_usual_end_of_a_fall_are_measured():
    steps = driven(Setup.of("one_wire_twin"), {"curves": "40"})
    assert min(u.size for name, u, _ in steps if name.startswith(("rise", "fall"))) > 0


@pytest.mark.parametrize("rig", RIGS)
def test_the_wire_moves_at_the_rates_in_turn(rig):
    setup = Setup.of(rig)
    natural = (setup.upper_K - setup.lower_K) / setup.tau_s
    rates = (0.1 * natural, 0.2 * natural)
    steps = driven(setup, {"rates_K_per_s": rates})
    middle = {"rise 8", "rise 9", "fall 12", "fall 11"}
    seen = {n: float(np.median(np.abs(np.diff(u)))) / setup.period_s for n, u, _ in steps if n in middle}
    assert seen["rise 8"] == pytest.approx(rates[1], rel=0.01)
    assert seen["rise 9"] == pytest.approx(rates[0], rel=0.01)
    assert seen["fall 12"] == pytest.approx(rates[0], rel=0.01)
    assert seen["fall 11"] == pytest.approx(rates[1], rel=0.05)


def test_currents_change_no_faster_than_the_limits_allow():
    setup = Setup.of("one_wire_twin")
    slow = replace(setup, limits=setup.limits.model_copy(update={"current_rate_A_per_s": 0.5}))

    def largest_jump(of):
        sweeps = [current for name, _, current in driven(of) if name.startswith(("rise", "fall"))]
        return max(np.abs(np.diff(np.concatenate(pair))).max() for pair in zip(sweeps[:26:2], sweeps[1:26:2]))

    assert largest_jump(slow) <= 0.5 * setup.period_s + 1e-9
    assert largest_jump(setup) > 0.1  # the turn from heating to cooling


@pytest.mark.long("takes two seconds", cases=("two_wire_twin",))
@pytest.mark.parametrize("rig", RIGS)
def test_it_takes_a_fifth_of_the_settled_protocol(rig):
    from smarig.config import load_rig
    from smarig.runner.preview import preview

    fast, settled = (
        preview(name, load_rig(rig)).duration_s
        for name in ("continuous_reversal_curves", "first_order_descending")
    )
    assert fast < 0.2 * settled


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"curves": "2"}, "curves must lie between 3"),
        ({"rates_K_per_s": "1e4"}, "which this wire can follow"),
        ({"rates_K_per_s": "4,-1"}, "which this wire can follow"),
        ({"reversals_K": "100,80,150"}, "3 increasing inputs"),
        ({"reversals_K": "50,100,500"}, "outside the rig's range"),
    ],
)
def test_impossible_settings_are_refused(settings, text):
    with pytest.raises(UsageError, match=text):
        list(build_protocol("continuous_reversal_curves", Setup.of("one_wire_twin"), settings))
