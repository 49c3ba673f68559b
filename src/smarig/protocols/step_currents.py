"""The data collection of §5.2.1: any profile, sampled at N points, each held until the wire has settled."""

import math
from pathlib import Path
from typing import Literal

from smarig.core import Formula, Mark, Protocol, Settled, UsageError
from smarig.protocols._building_blocks import checked_count, checked_inputs, evenly_spaced, settle_at
from smarig.protocols._profile_file import profile_from_csv
from smarig.protocols._settings import InputFile
from smarig.protocols._setup import Setup


def step_currents(
    setup: Setup,
    *,
    profile: Literal["major_loop", "staircase", "sine", "decaying"] = "major_loop",
    points: int = 40,
    temperatures_K: tuple[float, ...] = (),
    currents_A: tuple[float, ...] = (),
    file: InputFile = "",
    temperature: str = "",
    duration_s: float = 0.0,
    settle: Settled | None = None,
) -> Protocol:
    """Settled steps along a temperature or current profile (§5.2.1, steps 1 to 6).

    ``profile`` names a shape over the rig's range, sampled at ``points``. ``temperatures_K`` or ``currents_A`` list the
    values instead. ``temperature`` is the profile T(t) as a formula, in K above ambient, such as
    ``87+60*sin(2*pi*t/600)``, sampled at ``points`` evenly spaced times t from 0 to ``duration_s``. ``file`` is a CSV
    file with one column, headed temperature_K or current_A, or with the columns time_s and temperature_K, whose profile
    is linear in between and sampled at ``points`` times. t is the time of the profile; each step is held until the
    wire has settled.
    """
    settle = settle or Settled()
    if sum(map(bool, (temperatures_K, currents_A, file, temperature))) > 1:
        raise UsageError("step_currents takes only one of temperatures_K, currents_A, file and temperature.")
    if bool(temperature) != bool(duration_s):
        raise UsageError("step_currents takes temperature and duration_s together.")
    if file:
        temperatures_K, currents_A = profile_from_csv(Path(file), points)
    if temperature:
        temperatures_K = _along_formula(Formula(temperature), duration_s, points)
    low, high = setup.limits.current_min_A, setup.limits.current_max_A
    for current_A in currents_A:
        if not low - 1e-9 <= current_A <= high + 1e-9:
            raise UsageError(
                f"step_currents: {current_A:g} A is outside the rig's limits {low:g}…{high:g} A."
            )
    if currents_A:
        temperatures_K = tuple(setup.actuator.input_for(i) for i in currents_A)
    inputs = checked_inputs(setup, temperatures_K or _profile_inputs(setup, profile, points), "step_currents")
    yield Mark("step currents", {"points": len(inputs)})
    yield from settle_at(setup, inputs, profile if not temperatures_K else "listed", settle)


def _profile_inputs(setup: Setup, profile: str, points: int) -> list[float]:
    checked_count("points", points, 2, 100_000)
    low, high = setup.lower_K, setup.upper_K
    if profile == "major_loop":
        half = (points + 1) // 2
        return [low, *evenly_spaced(low, high, half), *evenly_spaced(high, low, half)]
    if profile == "staircase":
        return [low, *evenly_spaced(low, high, points)]
    middle, size = (low + high) / 2, (high - low) / 2
    turns = [2 * math.pi * 3 * (k + 1) / points for k in range(points)]
    fade = [1.0 if profile == "sine" else 1 - (k + 1) / points for k in range(points)]
    return [middle - size * f * math.cos(t) for f, t in zip(fade, turns, strict=True)]


def _along_formula(formula: Formula, duration_s: float, points: int) -> tuple[float, ...]:
    """T(t) at ``points`` evenly spaced times from 0 to the end."""
    checked_count("points", points, 2, 100_000)
    if not 0 < duration_s < math.inf:
        raise UsageError(f"step_currents: duration_s must be positive, got {duration_s:g}.")
    return tuple(formula(duration_s * k / (points - 1)) for k in range(points))
