"""Wires of single relays with each extension: the independent truths of these tests.

No code is shared with smarig: no staircase, no Everett function, no root finder. Relays (n,) are spread
evenly over a smooth density (a Sobol sequence through inverse distributions), each with the same share of
the stroke.
"""

import numpy as np

STROKE = 10.0
LOWER, UPPER = 0.0, 150.0


class Wire:
    """Relays up at ``alpha``, down at ``beta``; ``on`` or not."""

    def __init__(self, m=14, seed=1):
        from scipy.stats import gamma, norm, qmc

        spread = qmc.Sobol(2, seed=seed).random_base2(m)
        centre = 75 + 20 * norm.ppf(spread[:, 0])
        half = 4 * gamma.ppf(spread[:, 1], 4)
        inside = (centre + half < UPPER) & (centre - half > LOWER)
        self.alpha, self.beta = (centre + half)[inside], (centre - half)[inside]
        self.share = STROKE / self.alpha.size
        self.on = np.zeros(self.alpha.size, dtype=bool)

    def moved(self, w, rising):
        """What would be on if the field went monotonically to w."""
        return self.on | (self.alpha <= w) if rising else self.on & (self.beta < w)

    def y(self):
        return self.share * self.on.sum()


def classical(inputs, **kw):
    """Plain relays."""
    wire, out, before = Wire(**kw), [], -np.inf
    for u in inputs:
        wire.on = wire.moved(u, u > before) if u != before else wire.on
        before = u
        out.append(wire.y())
    return np.array(out)


def moving(inputs, k, **kw):
    """Each relay feels u + k y: the field creeps on until it has caught up with what it switches."""
    wire, out, w = Wire(**kw), [], -1e3
    for u in inputs:
        rising = u > w - k * wire.y()
        low, high = (w, 1e3) if rising else (-1e3, w)
        for _ in range(45):
            middle = (low + high) / 2
            caught_up = middle - k * wire.share * wire.moved(middle, rising).sum() > u
            low, high = (low, middle) if caught_up else (middle, high)
        w = low if rising else high
        wire.on = wire.moved(w, rising)
        out.append(wire.y())
    return np.array(out)


def nonlinear(inputs, strength, **kw):
    """Each relay counts 1 + strength · c · u/150, c between ½ and 1 by where the relay sits."""
    wire, out, before = Wire(**kw), [], -np.inf
    side = 0.75 + 0.25 * np.tanh((wire.alpha + wire.beta - 150) / 20)
    for u in inputs:
        wire.on = wire.moved(u, u > before) if u != before else wire.on
        before = u
        weight = 1 + strength * side * u / UPPER
        out.append(wire.share * (weight * wire.on).sum())
    return np.array(out)


def accommodating(inputs, amount, path, steps=60, **kw):
    """Relays drift towards the mean in small steps of output, except those the present branch has swept."""
    wire, out, before, q = Wire(**kw), [], LOWER, -1.0
    for u in inputs:
        for v in np.linspace(before, u, steps)[1:] if u != before else []:
            was, rising = wire.y(), u > before
            wire.on = wire.moved(v, rising)
            mean, left = (was + wire.y()) / STROKE - 1, np.exp(-abs(wire.y() - was) / STROKE / path)
            swept = (wire.alpha <= v) if rising else (wire.beta >= v)
            q = np.where(swept, 1.0 if rising else -1.0, mean + (q - mean) * left)
        before = u
        frozen = (wire.alpha > u) & (wire.beta < u)
        drift = (q - np.where(wire.on, 1.0, -1.0)) * frozen
        out.append(wire.y() + 0.5 * wire.share * amount * drift.sum())
    return np.array(out)


def past_extrema(inputs):
    """After each input, the turning points it has not passed again since negative saturation, oldest first."""
    turns, before, rising = [], LOWER, True
    for v in inputs:
        if v != before and (v > before) != rising:
            turns, rising = [*turns, before], v > before
        while len(turns) > 1 and (v >= turns[-2] if rising else v <= turns[-2]):
            turns = turns[:-2]
        if v <= LOWER:
            turns, rising = [], True
        before = v
        yield tuple(turns)


def weights(wire, extrema, strength):
    """Each extremum weights the relays of its triangle again by their position; the triangle keeps its sum."""
    w, corner = np.full(wire.alpha.size, wire.share), LOWER
    for j, e in enumerate(extrema):
        inside = (wire.alpha <= max(e, corner)) & (wire.beta >= min(e, corner))
        place = wire.alpha - wire.beta - 32 if j % 2 == 0 else wire.alpha + wire.beta - 150
        tilt = np.tanh(place / 15) * (e - 75) / 75
        new = w * (1 + strength * tilt)
        if inside.any():
            w = np.where(inside, new * w[inside].sum() / new[inside].sum(), w)
        corner = e
    return w


def restricted(inputs, order, strength=0.5, **kw):
    """Relays counted one by one, with weights that depend on the first ``order`` of the past extrema."""
    wire, out, before = Wire(**kw), [], -np.inf
    for u, extrema in zip(inputs, past_extrema(inputs)):
        wire.on = wire.moved(u, u > before) if u != before else wire.on
        before = u
        out.append((weights(wire, extrema[:order], strength) * wire.on).sum())
    return np.array(out)
