"""An error that goes with the recent motion, which a mount or a sensor forgets with time, is told as history."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.boxes import unlisted_effects
from benchmarks.boxes.unlisted_effects import UnlistedEffect
from smarig.diagnosis import diagnose_commanded
from smarig.diagnosis.comparison.commanded.kernel_shapes import recent_motion
from smarig.preisach import RelayMeasure
from smarig.replay import Prediction
from tests.diagnosis.short_boxes import given_model, recorded, short_box


def test_each_motion_counts_until_it_is_forgotten():
    """Two relays switch at known times: z is the sum of their steps, each with its age in an exponential."""
    hysteresis = RelayMeasure.from_arrays([10.0, 30.0], [5.0, 20.0], [1.0, 3.0])
    t_s = np.arange(0.0, 100.0)
    input_K = np.where(t_s < 20, 0.0, np.where(t_s < 50, 15.0, 40.0))
    ticks = np.array([10, 20, 40, 60, 99])
    prediction = Prediction({}, t_s, input_K, (), np.zeros(5), ticks, np.ones(5))
    model = SimpleNamespace(hysteresis=hysteresis, initial="negative", stroke=8.0)
    tau_s, strokes = 17.0, {20: 0.25, 50: 0.75}
    expected = [
        sum(size * np.exp(-(t + 1 - begin) / tau_s) for begin, size in strokes.items() if t >= begin)
        for t in ticks.tolist()
    ]
    assert recent_motion(prediction, model, tau_s) == pytest.approx(expected, abs=1e-12)


def rubber_mount(y, record, stroke, p):
    """A mount yields with two time constants, and less than in proportion."""
    fast, slow = (_late(y, record.t_s, s) - y for s in (p["tau_s"], 10 * p["tau_s"]))
    rest = (0.6 * fast + 0.4 * slow) / stroke
    return y + p["share"] * stroke * np.sign(rest) * np.abs(rest) ** 0.7


def _late(y, t_s, tau_s):
    late = [float(y[0])]
    for value, share in zip(y[1:].tolist(), np.exp(-np.diff(t_s) / tau_s).tolist()):
        late.append(value + (late[-1] - value) * share)
    return np.array(late)


@pytest.mark.long("takes half a minute")
def test_a_mount_of_rubber_is_no_creep_of_the_wire(monkeypatch):
    mount = UnlistedEffect({}, unlisted_effects.HISTORY, at_output=rubber_mount)
    monkeypatch.setitem(unlisted_effects.UNLISTED, "mount", mount)
    runs = recorded(short_box(5, {"mount": {"share": 0.15, "tau_s": 600.0}}))
    found = diagnose_commanded(given_model(5), runs)
    assert (found.verdict.word, found.verdict.depends_on) == ("unknown", "history")
