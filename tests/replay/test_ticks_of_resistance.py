"""A resistance that follows the phase, in ticks as long as a diagnosis takes: the same as in short ones."""

import numpy as np
import pytest

from plant.effects.driven import WIRES, kind
from smarig.plant import Plant

CURRENTS = (0.9, 0.4, 0.8, 0.3, 0.75)
HOLD_S = 20.0


def positions(percent, dt_s):
    """Positions (mm) every two seconds, simulated in ticks of ``dt_s``."""
    plant = Plant(*WIRES["one_wire"], dt_s, [kind("resistance_phase")(percent)])
    per_row, rows = round(2.0 / dt_s), int(HOLD_S / 2.0)
    return np.array(
        [[plant.advance(i, dt_s) for _ in range(per_row)][-1] for i in CURRENTS for _ in range(rows)]
    )


@pytest.mark.parametrize("percent", [-15.0, 10.0])
@pytest.mark.parametrize("dt_s", [0.1, 0.5, 1.0])
def test_long_ticks_agree_with_short_ones(percent, dt_s):
    """With the resistance of its start, a tick is off by ten times as much, 4 to 8 µm."""
    np.testing.assert_allclose(positions(percent, dt_s), positions(percent, 0.02), atol=1e-3)


def test_the_first_tick_has_the_resistance_of_its_start():
    """Against the closed form of heating: what was before is not known."""
    wire, hysteresis, initial = WIRES["one_wire"]
    plant = Plant(wire, hysteresis, initial, 0.1, [kind("resistance_phase")(-10.0)])
    plant.step(0.7)
    first_K = 1.05 * wire.gain_K_per_A2 * 0.49 * (1 - np.exp(-0.1 / wire.tau_s))
    assert plant.now.input_K == pytest.approx(first_K, rel=1e-9)
