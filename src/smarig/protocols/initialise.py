"""Initialisation of the actuator (§5.2.2): a decaying sinusoid leads to the anhysteretic state."""

import math
from typing import Literal

from smarig.core import Elapsed, Hold, Mark, Protocol, Settled, Waveform, Zero
from smarig.protocols._building_blocks import checked_count
from smarig.protocols._setup import Setup

_SATURATION_TAUS = 8.0  # a swing of 8 τ comes within 0.03 % of the limit
_CYCLES = 18  # as in the thesis: 18 maxima and 18 minima
_PERIOD_TAUS = 5 * math.pi  # ω τ = 0.4: compensating the lag needs at most 8 % more than the amplitude


def initialise(
    setup: Setup,
    *,
    method: Literal["planned", "thesis"] = "planned",
    cycles: int = _CYCLES,
    settle: Settled | None = None,
) -> Protocol:
    """Bring the wire to its initial state and zero the encoder (§5.2.2).

    Differential rig, ``planned``: both limits are reached first, which wipes out all memory. Then the *wire's*
    temperature follows a sinusoid that decays over ``cycles``. The source temperature that produces it is
    s = u + τ du/dt; the period follows from τ. Differential rig, ``thesis``: the steady relation gives the current of
    185 K · (180−t)/180 · sin(0.2πt), for 180 s. With τ ≈ 5 s the wire does not follow it (theory.md §8.6).
    One-wire rig: the wire is cooled, because a cold wire has no remnant hysteresis.
    """
    checked_count("cycles", cycles, 1, 1000)
    settle = settle or Settled()
    yield Mark("initialise", {"method": method if setup.two_wire else "cool"})
    if setup.two_wire:
        yield from _planned_sinusoid(setup, cycles) if method == "planned" else _thesis_sinusoid(setup)
    yield Hold(0.0, Elapsed(_SATURATION_TAUS * setup.tau_s), branch="cool")
    yield Hold(0.0, settle, branch="cool")
    yield Zero()


def _planned_sinusoid(setup: Setup, cycles: int) -> Protocol:
    saturation = Elapsed(_SATURATION_TAUS * setup.tau_s)
    yield Hold(setup.current_for(setup.upper_K), saturation, branch="swing up")
    yield Hold(setup.current_for(setup.lower_K), saturation, branch="swing down")
    amplitude = min(setup.upper_K, -setup.lower_K)
    omega = 2 * math.pi / (_PERIOD_TAUS * setup.tau_s)
    end_s = cycles * 2 * math.pi / omega
    currents = []
    for k in range(round(end_s / setup.period_s)):
        t = (k + 1) * setup.period_s
        size, slope = amplitude * (1 - t / end_s), -amplitude / end_s
        wire = -size * math.cos(omega * t)
        rate = -slope * math.cos(omega * t) + size * omega * math.sin(omega * t)
        source = min(max(wire + setup.tau_s * rate, setup.lower_K), setup.upper_K)
        currents.append(setup.current_for(source))
    yield Waveform(tuple(currents), setup.period_s, branch="decay")


def _thesis_sinusoid(setup: Setup) -> Protocol:
    amplitude, end_s = min(setup.upper_K, -setup.lower_K), 180.0
    times = [(k + 1) * setup.period_s for k in range(round(end_s / setup.period_s))]
    inputs = [(end_s - t) / end_s * amplitude * math.sin(0.2 * math.pi * t) for t in times]
    yield Waveform(tuple(setup.current_for(u) for u in inputs), setup.period_s, branch="decay")
