"""The data collection of §5.2.1: any profile, sampled at N points, each held until the wire has settled."""

import csv
import math
from pathlib import Path
from typing import Literal

from smarig.core import DataError, Mark, Protocol, Settled, UsageError, number_from_text
from smarig.protocols._building_blocks import checked_count, checked_inputs, evenly_spaced, settle_at
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
    settle: Settled | None = None,
) -> Protocol:
    """Settled steps along a temperature or current profile (§5.2.1, steps 1 to 6).

    ``profile`` names a shape over the rig's range, sampled at ``points``. ``temperatures_K`` or ``currents_A`` list the
    values instead. ``file`` is a CSV file with one column, headed temperature_K or current_A.
    """
    settle = settle or Settled()
    if sum(map(bool, (temperatures_K, currents_A, file))) > 1:
        raise UsageError("step_currents takes only one of temperatures_K, currents_A and file.")
    if file:
        temperatures_K, currents_A = _from_csv(Path(file))
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


def _from_csv(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    if not path.is_file() or path.stat().st_size > 10_000_000:
        raise UsageError(f"Profile {path} cannot be read: the file is missing or larger than 10 MB.")
    try:
        with path.open(newline="", encoding="utf-8-sig") as lines:
            rows = list(csv.reader(lines))
    except OSError as error:
        raise UsageError(f"Profile {path} cannot be read: {error.strerror}.") from None
    except (UnicodeDecodeError, csv.Error):
        raise DataError(f"Profile {path} is not a text table.") from None
    header = rows[0][0].strip() if rows and rows[0] else ""
    if header not in ("temperature_K", "current_A"):
        raise DataError(
            f"Profile {path} must begin with a header temperature_K or current_A, found '{header:.40}'."
        )
    values = []
    for number, row in enumerate(rows[1:], start=2):
        try:
            values.append(number_from_text(row[0].strip()))
        except (ValueError, IndexError):
            cells = ",".join(row)
            raise DataError(f"Profile {path}, line {number}: '{cells:.40}' is not a number.") from None
    if not values:
        raise DataError(f"Profile {path} has a header but no values.")
    return (tuple(values), ()) if header == "temperature_K" else ((), tuple(values))
