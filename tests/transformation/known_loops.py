"""Heating-cooling loops whose tangents are known exactly, and runs made of them.

Three curves between two straight plateaus: a straight ramp, a logistic curve and a normal distribution function. The
steep tangent is that of the curve in its middle, in closed form.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from smarig.record import Run, Step
from smarig.record.schema import SAMPLE_COLUMNS

KINDS = ("ramp", "logistic", "normal")


@dataclass(frozen=True)
class Curve:
    """A branch: the middle and the span of its transformation, and its plateaus as level and slope at the middle."""

    kind: str
    middle: float
    span: float
    cold: tuple[float, float]
    hot: tuple[float, float]

    def share(self, t):
        x = (np.asarray(t) - self.middle) / self.span  # steepest slope 1 at 0
        if self.kind == "ramp":
            return np.clip(0.5 + x, 0, 1)
        if self.kind == "logistic":
            return 1 / (1 + np.exp(-4 * np.clip(x, -50, 50)))
        return np.array([0.5 * (1 + math.erf(math.sqrt(math.pi) * v)) for v in np.atleast_1d(x)])

    def plateau(self, ends, t):
        return ends[0] + ends[1] * (np.asarray(t) - self.middle)

    def output(self, t):
        s = self.share(t)
        return self.plateau(self.cold, t) * (1 - s) + self.plateau(self.hot, t) * s

    def corners(self):
        """(lower, upper) input where the tangents meet; the slopes of the plateaus add half each to the steep one."""
        level = (self.cold[0] + self.hot[0]) / 2
        slope = (self.hot[0] - self.cold[0]) / self.span + (self.cold[1] + self.hot[1]) / 2
        return tuple(self.middle + (ends[0] - level) / (slope - ends[1]) for ends in (self.cold, self.hot))


@dataclass(frozen=True, eq=False)
class KnownLoop:
    """Readings in measured order, and the true temperatures."""

    u: np.ndarray
    y: np.ndarray
    truth: dict[str, float]
    span: float


def known_loop(seed, *, kind=None, noise=None, cycles=1, drift=None, input_noise=0.0):
    """A random loop. A drift that is linear along a branch tilts all of its tangents, so their corners stay."""
    dice = np.random.default_rng(seed)
    kind = kind or KINDS[seed % 3]
    top, stroke = dice.uniform(120, 220), dice.choice([-1, 1]) * dice.uniform(0.01, 0.05)
    width = dice.uniform(0.05, 0.15) * top
    spans = dice.uniform(0.07, 0.18, 2) * top
    middles = top / 2 + np.array([width / 2, -width / 2])
    heating, cooling = (
        Curve(
            kind,
            m,
            s,
            (0.0, dice.uniform(-0.08, 0.08) * stroke / top),
            (stroke, dice.uniform(-0.08, 0.08) * stroke / top),
        )
        for m, s in zip(middles, spans)
    )
    sd = abs(stroke) * (dice.choice([0.002, 0.005, 0.01, 0.02]) if noise is None else noise)
    ratchet = stroke * (dice.uniform(-0.02, 0.02) if drift is None else drift)
    us, ys, level = [], [], 0.0
    for _ in range(cycles):
        for curve, down in ((heating, False), (cooling, True)):
            t = _sampled(dice, top)
            t = t[::-1] if down else t
            along = np.abs(t - t[0]) / top  # slow drift in time, here along the branch
            us.append(t + input_noise * dice.standard_normal(t.size))
            ys.append(_output(curve, t) + level + ratchet / 2 * along + sd * dice.standard_normal(t.size))
            level += ratchet / 2
    (a_s, a_f), (m_f, m_s) = _true(heating), _true(cooling)
    truth = {"A_s": a_s, "A_f": a_f, "M_s": m_s, "M_f": m_f}
    return KnownLoop(np.concatenate(us), np.concatenate(ys), truth, float(spans.mean()))


def _output(curve, t):
    if curve.kind != "ramp":
        return curve.output(t)
    low, high = curve.middle - curve.span / 2, curve.middle + curve.span / 2
    ends = curve.plateau(curve.cold, low), curve.plateau(curve.hot, high)
    steep = ends[0] + (ends[1] - ends[0]) * (t - low) / curve.span
    return np.where(
        t < low, curve.plateau(curve.cold, t), np.where(t > high, curve.plateau(curve.hot, t), steep)
    )


def _true(curve):
    if curve.kind == "ramp":
        return curve.middle - curve.span / 2, curve.middle + curve.span / 2
    return curve.corners()


def _sampled(dice, top):
    """Readings at even, jittered or random temperatures, or at a rate that changes, ends included."""
    n, kind = int(dice.integers(90, 300)), dice.integers(4)
    t = np.linspace(0, 1, n)
    if kind == 1:
        t = t + dice.normal(0, 0.2 / n, n)
    elif kind == 2:
        t = dice.uniform(0, 1, n)
    elif kind == 3:
        t = t + 0.1 * np.sin(2 * np.pi * t) / (2 * np.pi)
    t = np.sort(t)
    t[0], t[-1] = 0.0, 1.0
    return top * t


def run_of(u, y, *, unit="degC", quantity="temperature", output="mm/mm", name="made", settled=False, **meta):
    """A run in memory with these readings; ``settled``: one settled step for each."""
    n = len(u)
    columns = {c: np.full(n, np.nan) for c in SAMPLE_COLUMNS}
    columns |= {
        "tick": np.arange(n, dtype=float),
        "input": np.asarray(u, float),
        "position": np.asarray(y, float),
    }
    if "ambient" in meta:
        columns["ambient_degC"] = np.full(n, float(meta.pop("ambient")))
    known = {"input": {"quantity": quantity, "unit": unit}, "output": {"quantity": "strain", "unit": output}}
    steps = tuple(
        Step(k, 1, False, "made", float(u[k]), float(k), k + 1.0, "settled", float(y[k]), 10)
        for k in range(n if settled else 0)
    )
    return Run(
        Path(f"{name}.run.sqlite"),
        {**known, "source": "import", "end": {"cause": "done"}, **meta},
        columns,
        steps,
        (),
    )
