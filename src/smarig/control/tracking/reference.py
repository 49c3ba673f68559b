"""References of the position: steps, ramps, a multisine, or a file; positions count from the encoder's zero."""

import csv
import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from numbers import Integral, Real
from pathlib import Path

import numpy as np

from smarig.control.argument_checks import finite
from smarig.core import TABLE, UsageError, check_file, number_from_text, shown, suggestion, swapped_file

LONGEST_S = 24 * 3600.0
LARGEST_BYTES = 20_000_000
MOST_POINTS = 400_000
MOST_ROWS = 1_000_000  # of a file
REFERENCE_SHAPES = ("steps", "ramps", "multisine")
PERIODS_S = (120.0, 75.0, 47.0)  # of the multisine's components at speed 1: no common multiple within an hour


@dataclass(frozen=True)
class Reference:
    """Positions (n,) at times (n,) from 0, in the rig's unit; linear in between, or constant (``held``).

    The last time of a held reference is its end; its last position belongs to no step.
    """

    name: str
    t_s: tuple[float, ...]
    position: tuple[float, ...]
    held: bool = False

    def __post_init__(self) -> None:
        if not (_all_numbers(self.t_s) and _all_numbers(self.position)) or len(self.t_s) != len(
            self.position
        ):
            raise UsageError(
                f"Reference {self.name} needs the same number of times and positions, all of them numbers."
            )
        numbers = np.array([self.t_s, self.position], dtype=float)
        if numbers.shape[1] < 2 or not np.isfinite(numbers).all():
            raise UsageError(f"Reference {self.name} needs at least two times with finite positions.")
        if self.t_s[0] != 0 or np.any(np.diff(self.t_s) <= 0):
            raise UsageError(f"Reference {self.name}: times must start at 0 and increase.")
        if self.t_s[-1] > LONGEST_S:
            raise UsageError(
                f"Reference {self.name} takes more than {LONGEST_S / 3600:g} h. Divide it into parts."
            )

    @property
    def duration_s(self) -> float:
        """Time of the last point."""
        return self.t_s[-1]

    def at(self, t_s: float) -> float:
        """Reference position; before the start and after the end, that of the first and last point."""
        last = len(self.t_s) - (2 if self.held else 1)
        k = min(max(bisect_right(self.t_s, t_s) - 1, 0), last)
        if self.held or k == len(self.t_s) - 1 or t_s <= 0:
            return self.position[k]
        t0, t1 = self.t_s[k], self.t_s[k + 1]
        share = (t_s - t0) / (t1 - t0)
        return self.position[k] + share * (self.position[k + 1] - self.position[k])

    def as_data(self) -> dict[str, object]:
        """Plain values for a record, sufficient to rebuild the reference."""
        return {"name": self.name, "t_s": list(self.t_s), "position": list(self.position), "held": self.held}

    @classmethod
    def of(cls, data: Mapping) -> "Reference":
        """Rebuild a reference from ``as_data``."""
        return cls(
            str(data["name"]), tuple(data["t_s"]), tuple(data["position"]), bool(data.get("held", False))
        )


def _all_numbers(values: object) -> bool:
    return isinstance(values, Sequence) and all(isinstance(value, Real) for value in values)


def reference(
    shape: str,
    low: float,
    high: float,
    *,
    seconds: float = 240.0,
    every_s: float = 30.0,
    speed: float = 1.0,
    seed: int = 0,
) -> Reference:
    """``steps`` and ``ramps`` to random positions in [low, high] every ``every_s``/``speed``; a ``multisine``.

    >>> reference("ramps", 2.0, 8.0, seconds=60.0).duration_s
    60.0
    """
    if shape not in REFERENCE_SHAPES:
        raise UsageError(
            f"No reference '{shape}'{suggestion(shape, list(REFERENCE_SHAPES))}. Give a shape or a CSV file."
        )
    for name, value in zip(
        ("low", "high", "seconds", "every_s", "speed"), (low, high, seconds, every_s, speed)
    ):
        finite(f"The reference's {name}", value)
    if not (isinstance(seed, Integral) and seed >= 0):
        raise UsageError(f"The reference's seed must be an integer ≥ 0 (given: {seed}).")
    if not math.isfinite(high - low):
        raise UsageError(
            f"The reference's low and high differ too much: {low:g}, {high:g}. Give smaller values."
        )
    if not (low < high and 0 < seconds <= LONGEST_S and every_s > 0 and speed > 0):
        raise UsageError(
            f"A reference needs low < high, 0 < seconds ≤ {LONGEST_S:g}, every_s > 0 and speed > 0; got "
            f"{low:g}, {high:g}, {seconds:g}, {every_s:g}, {speed:g}."
        )
    if seconds * speed * max(4.0, 1 / every_s) > MOST_POINTS:
        raise UsageError(
            f"The reference has more than {MOST_POINTS} points. Give fewer seconds, a lower speed, or a longer every_s."
        )
    dice = np.random.default_rng([seed, 0x7247])
    if shape == "multisine":
        return _multisine(low, high, seconds, speed, dice)
    count = max(2, math.floor(seconds * speed / every_s) + 1)
    times = np.linspace(0.0, seconds, count)
    return Reference(
        shape, tuple(times.tolist()), tuple(dice.uniform(low, high, count).tolist()), shape == "steps"
    )


def _multisine(low: float, high: float, seconds: float, speed: float, dice: np.random.Generator) -> Reference:
    t = np.linspace(0.0, seconds, max(2, round(seconds * speed * 4)))
    parts = [np.sin(2 * math.pi * (t * speed / period + dice.random())) for period in PERIODS_S]
    wave = np.sum(parts, axis=0)
    scaled = (low + high) / 2 + (high - low) / 2 * wave / np.abs(wave).max()
    return Reference("multisine", tuple(t.tolist()), tuple(scaled.tolist()))


def reference_from_csv(path: Path, unit: str) -> Reference:
    """A reference from a file with columns ``time_s`` and ``position_mm`` or ``position_deg``, linear between rows."""
    check_file(path, "reference file", f"Give {', '.join(REFERENCE_SHAPES)}, or a CSV file.")
    if path.stat().st_size > LARGEST_BYTES:
        raise UsageError(f"{path} is larger than {LARGEST_BYTES // 10**6} MB, too large for a reference.")
    if swapped := swapped_file(path, TABLE):
        raise UsageError(swapped)
    wanted = ("time_s", f"position_{unit}")
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file)
            _check_columns(path, reader.fieldnames or (), wanted)
            rows = [_row(row, wanted, reader.line_num) for row in islice(reader, MOST_ROWS + 1)]
        if len(rows) > MOST_ROWS:
            raise ValueError(f"it has more than {MOST_ROWS} rows, too many to be recorded")
        _check_rows(rows)
    except (ValueError, csv.Error) as error:
        raise UsageError(f"{path} is not a reference: {error}.") from None
    return Reference(path.name, tuple(t for _, t, _ in rows), tuple(y for _, _, y in rows))


def _check_columns(path: Path, names: Sequence[str], wanted: tuple[str, str]) -> None:
    for name in wanted:
        if name not in names:
            raise UsageError(f"{path} has no column '{name}'. A reference needs {' and '.join(wanted)}.")
        if names.count(name) > 1:
            raise UsageError(f"{path} has {names.count(name)} columns '{name}'. Keep only one of them.")


def _row(row: Mapping[str, str | None], wanted: tuple[str, str], line: int) -> tuple[int, float, float]:
    return line, _cell(row, wanted[0], line), _cell(row, wanted[1], line)


def _cell(row: Mapping[str, str | None], column: str, line: int) -> float:
    """A cell as a number. Raises ValueError with line and column."""
    text = row[column]
    if text is None:
        raise ValueError(f"line {line} has no {column}")
    try:
        found = number_from_text(text.strip())
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise ValueError(f"line {line}: {column} is {shown(text)}, which is not a finite number")
    return found


def _check_rows(rows: Sequence[tuple[int, float, float]]) -> None:
    """Raise ValueError if there are no rows or time does not increase."""
    if not rows:
        raise ValueError("it has no rows below its header")
    for (_, before_s, _), (line, t_s, _) in pairwise(rows):
        if t_s <= before_s:
            raise ValueError(f"line {line}: time_s must increase, but {t_s:g} follows {before_s:g}")
