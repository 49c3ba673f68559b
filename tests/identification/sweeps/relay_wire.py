"""A wire of many random relays behind a heating in closed form: data that share no code with the estimator."""

from pathlib import Path

import numpy as np

from smarig.core import Hold, Waveform
from smarig.protocols import Setup, build_protocol
from smarig.record import Run, Step
from smarig.record.schema import SAMPLE_COLUMNS

RIG, PER_COUNT, TAU_S, GAIN = "one_wire_twin", 2 * np.pi * 15 / 2000, 5.3341, 174.1  # theory.md, section 3
RELAYS, DT_S = 12_000, 0.1


def relays(seed=0):
    """(α, β, mass) of relays with random centres and widths, and reversible ones; 270 counts in all."""
    rng = np.random.default_rng([seed, 7])
    centre = rng.normal(75.0, 16.0, RELAYS)
    half = np.where(rng.random(RELAYS) < 0.1, 0.0, np.exp(rng.normal(2.2, 0.4, RELAYS)))
    return centre + half, centre - half, np.full(RELAYS, 270 * PER_COUNT / RELAYS)


def heated(current_A, tau_s, gain=GAIN):
    """Temperature (n,) after each tick of a current: a first-order low-pass of (R/hA) i²."""
    from scipy.signal import lfilter

    decay = np.exp(-DT_S / tau_s)
    return lfilter([1 - decay], [1, -decay], gain * np.asarray(current_A) ** 2)


def switched(inputs, alpha, beta, mass):
    """Output (n,) of relays, all down at first."""
    up, y = np.zeros(alpha.size, dtype=bool), []
    for u in inputs:
        up = (up | (u >= alpha)) & (u > beta)
        y.append(mass @ up)
    return np.array(y)


def currents_of(settings, rig=RIG):
    """(current, step) (n,) of the protocol of sweeps, tick by tick."""
    current, step, number = [], [], -1
    for command in build_protocol("continuous_reversal_curves", Setup.of(rig), settings):
        if isinstance(command, Hold):
            part = [command.current_A] * round(command.until.seconds / DT_S)
        elif isinstance(command, Waveform):
            part = list(command.currents_A)
        else:
            continue
        number += 1
        current += part
        step += [number] * len(part)
    return np.array(current), np.array(step)


def heated_by_power(current_A, tau_s, alpha, beta, mass):
    """The same of a wire whose resistance falls from 5 to 4.5 ohm with its relays: i² R heats it."""
    up, T, found, part = np.zeros(alpha.size, dtype=bool), 0.0, [], 4  # of a tick
    for i in current_A:
        for _ in range(part):
            level = GAIN * i**2 * (5.0 - 0.5 * (mass @ up) / mass.sum()) / 4.75
            T = level + (T - level) * np.exp(-DT_S / part / tau_s)
            up = (up | (alpha <= T)) & (beta < T)
        found.append(T)
    return np.array(found)


def swept_run(
    settings=None,
    *,
    tau=1.0,
    gain=1.0,
    scale=1.0,
    noise=0.4,
    seed=0,
    wire=None,
    drift=0.0,
    by_power=False,
):
    """A run of sweeps of a wire whose τ and R/hA are hidden factors of the actuator's; no file behind it.

    ``wire``: relays (default: ``relays(seed)``). ``scale`` multiplies the output. ``drift`` counts are added as a slow
    oscillation that no Preisach model follows. ``by_power``: its resistance changes what heats it.
    """
    current, step = currents_of(settings or {"curves": 8})
    T = heated(current, tau * TAU_S, gain * GAIN)
    if by_power:
        T = heated_by_power(current, tau * TAU_S, *(wire or relays(seed)))
    rng, t = np.random.default_rng([seed, 11]), DT_S * (1 + np.arange(current.size))
    counts = scale * switched(T, *(wire or relays(seed))) / PER_COUNT + drift * np.sin(t / 23.0)
    counts = np.floor(counts + noise * rng.standard_normal(t.size) + 0.5)
    xi = np.clip(counts / counts.max(), 0, 1)
    columns = {name: np.full(t.size, np.nan) for name in SAMPLE_COLUMNS}
    columns |= {
        "tick": np.arange(t.size) + 1.0,
        "t_s": t,
        "step": step.astype(float),
        "quality": np.zeros(t.size),
    }
    columns |= {"current_A": current, "current_command_A": current, "input": heated(current, TAU_S)}
    columns |= {"counts": counts, "position": counts * PER_COUNT, "voltage_V": current * (5.0 - 0.5 * xi)}
    edges = [*np.flatnonzero(np.diff(step, prepend=-1)), t.size]
    steps = tuple(
        Step(k, 0, False, "", None, float(t[a] - DT_S), float(t[b - 1]), "elapsed", None, 0)
        for k, (a, b) in enumerate(zip(edges, edges[1:]))
    )
    meta = {
        "protocol": "continuous_reversal_curves",
        "actuator": "gorbet_one_wire",
        "source": "twin",
        "initial": "negative",
        "period_s": DT_S,
        "input": {"quantity": "temperature", "unit": "K"},
        "output": {"quantity": "position", "unit": "mm", "per_count": PER_COUNT},
        "end": {"cause": "done"},
    }
    return Run(Path("sweeps.run.sqlite"), meta, columns, steps, ())


def with_temperature(run, tau, gain, *, room=22.0, seed=3):
    """The run with the wire's temperature, ± 0.5 °C."""
    T = room + heated(run["current_A"], tau * TAU_S, gain * GAIN)
    T = T + 0.5 * np.random.default_rng(seed).standard_normal(T.size)
    return Run(
        run.path, run.meta, run.columns | {"temperature_degC": T, "ambient_degC": 0 * T + room}, run.steps, ()
    )
