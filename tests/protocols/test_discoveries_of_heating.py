"""Effects of thermal lag that a steady-state model lacks: loops drift, and initialisation is incomplete."""

import numpy as np
import pytest

import smarig
from smarig.config import load_rig
from smarig.plant.actuator import Actuator
from smarig.plant.heating import temperature_along
from smarig.preisach.hysteresis.gorbet_1997 import thesis_surface
from smarig.preisach.operator import Preisach
from smarig.runner.initialisation_spread import initialisation_spread

long = pytest.mark.long("takes ten seconds")


def loop_tops(run, loop_s):
    """Mean counts around each loop's upper turning point."""
    step = next(s for s in run.steps if s.branch == "loops")
    counts = run["counts"][run["step"] == step.index]
    period, first = round(loop_s / 0.1), round(loop_s / 0.2)
    lows = [first + period // 2 - 1 + k * period for k in range(5)]
    return np.array([counts[k - 2 : k + 3].mean() for k in lows])


def replay_residual(run):
    """Counts the operator fails to explain, driven by the simulated temperature."""
    temperature = temperature_along(Actuator.named("gorbet_one_wire"), run["current_command_A"], 0.1)
    return (
        Preisach(thesis_surface("one_e")).simulate(temperature) / run.meta["output"]["per_count"]
        - run["counts"]
    )


@pytest.mark.parametrize("seed", [pytest.param(1, marks=long), pytest.param(2, marks=long)])
def test_fig_5_3_fast_loops_drift_slow_loops_do_not_and_the_operator_explains_both(tmp_path, seed):
    noise = np.hypot(0.4, 1 / np.sqrt(12))
    runs = {
        loop_s: smarig.run(
            "minor_loops",
            rig="one_wire_twin",
            out=tmp_path / f"{loop_s}.run.sqlite",
            seed=seed,
            loop_s=loop_s,
        )
        for loop_s in (8.0, 480.0)
    }
    fast, slow = (np.diff(loop_tops(runs[loop_s], loop_s)) for loop_s in (8.0, 480.0))
    assert fast[0] > 30
    assert fast[1] > 5, "8 s loops drift upwards, loop after loop"
    assert np.max(np.abs(slow)) < 1.5, "8 min loops close within noise"
    for run in runs.values():
        residual = replay_residual(run)
        assert abs(residual.std() / noise - 1) < 0.1, "nothing but noise is left: the drift is the heating's"
        assert np.max(np.abs(residual)) < 3


@pytest.mark.long("takes three seconds")
def test_fig_5_4_initialisation():
    rig = load_rig("two_wire_twin")
    none, thesis, planned = (
        initialisation_spread(rig, Actuator.named(rig.actuator), method)
        for method in ("none", "thesis", "planned")
    )
    assert none.offset_counts > 20
    assert thesis.offset_counts > 2, "the thesis's 0.1 Hz for 180 s does not make loops agree"
    assert thesis.max_input_K == pytest.approx(74, abs=2)
    assert thesis.min_input_K == pytest.approx(-46, abs=2)
    assert planned.offset_counts <= 1
    assert planned.max_input_K > 184
    assert planned.min_input_K < -184
