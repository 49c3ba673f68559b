"""The Uno's current loop: steps between currents; with ``SMARIG_LONG=1`` for wires and supplies of different size."""

import os
from typing import NamedTuple

import numpy as np
import pytest

TICK_MS = 100
SETTLED_MS = 60  # after a step
SMALL_MA = 100  # smaller steps end in the noise of the INA219: 9 to 17 ms in 144 steps of 30 mA
BENCHES = {  # supply in V, wire in ohm, currents in mA
    "5 ohm at 6 V": (6.0, 5.0, (1000, 500, 100, 1000, 50, 20)),
    "11 ohm at 7.5 V": (7.5, 11.0, (400, 100, 300)),
    "2 ohm at 5 V": (5.0, 2.0, (1000, 200, 800)),
}


class StepResponse(NamedTuple):
    """One step: times in ms, the rest in mA."""

    rise_ms: float  # from a tenth to nine tenths
    settling_ms: float  # until it stays within 2 %, at least 3 mA
    overshoot_mA: float
    error_mA: float  # of the mean, settled
    ripple_mA: float  # peak to peak, settled, at all frequencies
    wander_mA: float  # standard deviation of the means of 1 ms, settled


def response(trace, begin_ms, before_mA, after_mA):
    """The step that begins at a millisecond and lasts for three ticks."""
    span = (trace.ms > begin_ms) & (trace.ms <= begin_ms + 3 * TICK_MS)
    mean, largest, least = (c[span] / 1000 for c in (trace.mean_uA, trace.largest_uA, trace.least_uA))
    step = after_mA - before_mA
    share = (mean - before_mA) / step
    late = slice(SETTLED_MS, None)
    outside = np.flatnonzero(np.abs(mean - after_mA) > max(0.02 * abs(step), 3.0))
    beyond = (largest if step > 0 else -least)[:SETTLED_MS] - (largest if step > 0 else -least)[late].max()
    return StepResponse(
        rise_ms=float(np.argmax(share > 0.9) - np.argmax(share > 0.1)),
        settling_ms=float(outside[-1] + 1 if len(outside) else 0),
        overshoot_mA=float(max(0.0, beyond.max())),
        error_mA=float(mean[late].mean() - after_mA),
        ripple_mA=float((largest - least)[late].max()),
        wander_mA=float(mean[late].std()),
    )


def steps(board, currents_mA, wire_ohm):
    """Drive each current for several ticks; the responses."""
    board.settings(resistance_min=int(800 * wire_ohm), resistance_max=int(1200 * wire_ohm), lease=2000)
    board.arm()
    for current_mA in currents_mA:
        board.drive(1000 * current_mA, 6)
    trace = board.close()
    found, before_mA = [], 0
    begin_ms = 0
    for current_mA in currents_mA:
        half = (before_mA + current_mA) * 500.0
        crossed = (trace.mean_uA > half) if current_mA > before_mA else (trace.mean_uA < half)
        after = np.flatnonzero(crossed & (trace.ms > begin_ms))[0]
        moved = np.abs(trace.mean_uA - before_mA * 1000) > 0.05 * 1000 * abs(current_mA - before_mA)
        begin = after - np.argmin(moved[after::-1])
        found.append(response(trace, trace.ms[begin], before_mA, current_mA))
        before_mA, begin_ms = current_mA, trace.ms[after] + 3 * TICK_MS
    return found


@pytest.mark.long("takes ten seconds")
@pytest.mark.parametrize("name", BENCHES if os.environ.get("SMARIG_LONG") else list(BENCHES)[:1])
def test_steps(name, uno):
    supply_V, wire_ohm, currents_mA = BENCHES[name]
    board = uno("--speed", "0", "--wait", "80", "--couple", "100", wire=lambda _: f"{wire_ohm} 1000 22")
    board.tell(f"supply {supply_V}")
    for before_mA, after_mA, r in zip((0, *currents_mA), currents_mA, steps(board, currents_mA, wire_ohm)):
        print(f"{name}: {before_mA} to {after_mA} mA: {r}")
        step_mA = abs(after_mA - before_mA)
        assert r.rise_ms <= (15 if step_mA >= SMALL_MA else 20)
        assert r.settling_ms <= 30
        assert r.overshoot_mA <= max(10, 0.05 * step_mA)
        assert abs(r.error_mA) <= 1.0
        assert r.ripple_mA <= 25
        assert r.wander_mA <= 3
