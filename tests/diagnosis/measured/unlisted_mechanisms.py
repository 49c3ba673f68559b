"""Mechanisms that no catalogue lists, hidden in runs of the independent wire, each with a random size.

A mechanism takes the wire, the true temperatures, the time and a strength (about 1), and returns what is recorded. Each
run of a world follows the same law from its own start.
"""

import numpy as np

from diagnosis.measured.independent_wire import RelayWire, as_run, triangles

DT = 1.0


def _steps(u):
    """Change of the input in each row; a reversal belongs to the branch that ends there."""
    step = np.diff(u)
    return np.concatenate([step[:1], step])


def _since_reversal(u):
    """Rows since the input last turned, from exact inputs."""
    found, count, before = [], 0, 0.0
    for step in _steps(u):
        sign = np.sign(step)
        count = 0 if sign and sign != before else count + 1
        before = sign or before
        found.append(count)
    return DT * np.array(found, dtype=float)


def _branch_rate(u):
    return np.maximum(np.abs(_steps(u)) / DT, 0.05)


def _strain_apart(wire, u, half_width):
    """Strain of the wire while its thresholds lie apart by twice a half-width (n,), which may change."""
    hot, out = np.zeros(wire.up.size, dtype=bool), []
    for now, w in zip(u, half_width):
        hot = np.where(now > wire.up + w, True, np.where(now < wire.down - w, False, hot))
        out.append(4.0 * (1 - wire.share @ hot))
    return np.array(out)


def gain_drifts(wire, u, t, s):
    """An amplifier behind the strain gauge drifts."""
    return u, wire.strain(u) * (1 + 0.15 * s * t / 600.0)


def zero_saturates(wire, u, t, s):
    """The mount settles within minutes of the start."""
    return u, wire.strain(u) + 0.35 * s * (1 - np.exp(-t / 120.0))


def scale_error_by_rate(wire, u, t, s):
    """The thermometer reads too little of a fast change."""
    return 25 + (u - 25) * (1 - 0.05 * s * np.log10(_branch_rate(u) / 0.3)), wire.strain(u)


def wider_by_rate(wire, u, t, s):
    """Thresholds move apart with the rate."""
    return u, _strain_apart(wire, u, 3.0 * s * np.log10(_branch_rate(u) / 0.3))


def relaxes_after_reversal(wire, u, t, s):
    """The strain overshoots at each reversal and relaxes."""
    return u, wire.strain(u) + 0.25 * s * np.exp(-_since_reversal(u) / 15.0)


def creeps(wire, u, t, s):
    """The strain goes on with the logarithm of the time on the branch."""
    return u, wire.strain(u) + 0.15 * s * np.log10(1 + _since_reversal(u) / 3.0)


def comes_loose(wire, u, t, s):
    """After five minutes the thermocouple comes loose and reads less."""
    return u - 2.5 * s * (t > 300.0), wire.strain(u)


def output_steps(wire, u, t, s):
    """After five minutes the gauge slips."""
    return u, wire.strain(u) + 0.3 * s * (t > 300.0)


def room_warms(wire, u, t, s):
    """The reference junction drifts."""
    return u + 3.0 * s * t / 600.0, wire.strain(u)


def remembers_peak(wire, u, t, s):
    """The output of a branch depends on where it began, beyond any Preisach operator."""
    turned = np.concatenate([[u[0]], u])[:-1]
    start = np.maximum.accumulate(np.where(_since_reversal(u) == 0, np.arange(u.size), 0))
    return u, wire.strain(u) + 0.2 * s * (turned[start] - 60.0) / 30.0 * (_steps(u) < 0)


def friction_after_rest(wire, u, t, s):
    """The hysteresis is wider the slower the branch: friction grows while the wire hardly moves."""
    return u, _strain_apart(wire, u, 3.0 * s * np.log10(1.0 + 1.0 / _branch_rate(u)))


def slow_transformation(wire, u, t, s):
    """The transformation follows its equilibrium with a time constant: no Preisach operator."""
    y = wire.strain(u)
    for k in range(1, y.size):
        y[k] = y[k - 1] + (y[k] - y[k - 1]) * (1 - np.exp(-DT / (6.0 * s)))
    return u, y


MECHANISMS = {
    f.__name__: f
    for f in (
        gain_drifts,
        zero_saturates,
        scale_error_by_rate,
        wider_by_rate,
        relaxes_after_reversal,
        creeps,
        comes_loose,
        output_steps,
        room_warms,
        remembers_peak,
        friction_after_rest,
        slow_transformation,
    )
}


def world(name, seed, runs=3):
    """Runs of one wire with a hidden mechanism: other peaks and other rates in each."""
    rng = np.random.default_rng([seed, sorted(MECHANISMS).index(name)])
    wire, strength = RelayWire(seed), rng.uniform(0.7, 1.5)
    made = []
    for k in range(runs):
        peaks = np.concatenate([[85.0], rng.uniform(52.0, 85.0, 6), [85.0]])
        rows = np.round(10 ** rng.uniform(1.2, 2.2, peaks.size)).astype(int).tolist()
        u = triangles(peaks.tolist(), rows)
        read, y = MECHANISMS[name](wire, u, DT * np.arange(u.size), strength)
        made.append(as_run(f"{name}_{k}", read, y, dt=DT, seed=100 * seed + k))
    return made
