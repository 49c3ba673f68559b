"""The load on a single wire: a constant force, or a force over time, and the stress σ = F/A that it causes.

The time t is that of the run file: 0 at power-up of the devices.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from smarig.config import RigFile
from smarig.core import (
    Array,
    ConfigError,
    DataError,
    Formula,
    UsageError,
    passed,
    profile_numbers,
    profile_rows,
)
from smarig.plant.actuator import Actuator

COLUMNS = ["time_s", "force_N"]
MOST_ROWS = 4000  # of a load history: a record holds it
LARGEST_STRESS_MPA = 1000.0  # NiTi yields below
BREAKING_STRESS_MPA = 2000.0  # cold-drawn NiTi breaks below


@dataclass(frozen=True)
class Load:
    """The force on a wire with a section in mm²: ``force_N``, a ``formula`` of t, or knots (``time_s``, ``forces_N``).

    Before the first knot and after the last one the force stays.
    """

    section_mm2: float
    force_N: float | None = None
    formula: str = ""
    time_s: tuple[float, ...] = ()
    forces_N: tuple[float, ...] = ()

    @property
    def changes(self) -> bool:
        """Whether the force depends on the time."""
        return self.force_N is None

    def force(self) -> Callable[[float], float]:
        """The force in N at a time in s. It raises UsageError at times at which the force is not plausible."""
        if self.force_N is not None:
            constant = self.force_N
            return lambda _: constant
        history = (
            Formula(self.formula)
            if self.formula
            else lambda t: float(np.interp(t, self.time_s, self.forces_N))
        )
        return lambda t: self._checked(history(t), f" at t = {t:g} s")

    def stress_MPa(self, t_s: ArrayLike) -> Array:
        """Stress (n,) at times (n,)."""
        force = self.force()
        return np.array([force(t) for t in np.asarray(t_s, dtype=float).tolist()]) / self.section_mm2

    def _checked(self, force_N: float, where: str) -> float:
        stress_MPa = force_N / self.section_mm2
        if not 0 <= stress_MPa <= LARGEST_STRESS_MPA:
            raise UsageError(
                f"The load is {force_N:.4g} N{where}, which is {stress_MPa:.4g} MPa in this wire. Give a load between "
                f"0 and {LARGEST_STRESS_MPA:g} MPa ({LARGEST_STRESS_MPA * self.section_mm2:.3g} N): a wire only "
                "pulls, and it yields above."
            )
        return force_N

    def checked(self) -> "Load":
        """The load, if its constant force or all its knots are plausible; a formula is checked at t = 0."""
        for t in self.time_s or (0.0,):
            force_N = self.force()(t)
            self._checked(force_N, f" at t = {t:g} s" if self.changes else "")
        return self

    def to_json(self) -> dict[str, Any]:
        """Plain values, as recorded with a run."""
        law = (
            {"force_N": self.force_N}
            if self.force_N is not None
            else {"formula": self.formula}
            if self.formula
            else {"time_s": list(self.time_s), "forces_N": list(self.forces_N)}
        )
        return {**law, "section_mm2": self.section_mm2}

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "Load":
        """The load of a run. Raises DataError if it is damaged."""
        try:
            constant = stored.get("force_N")
            load = cls(
                float(stored["section_mm2"]),
                None if constant is None else float(constant),
                str(stored.get("formula", "")),
                tuple(map(float, stored.get("time_s", ()))),
                tuple(map(float, stored.get("forces_N", ()))),
            )
            load.checked()
        except (KeyError, TypeError, ValueError, UsageError) as error:
            raise DataError(f"The load that the run states is damaged: {error}") from None
        return load


def load_of(rig: RigFile, actuator: Actuator) -> Load | None:
    """The load that a rig states, else the weight of its thermomechanical wire; None if neither is given.

    Raises ConfigError for two wires and for twins whose wire does not depend on a load.
    """
    wire, stated = actuator.file.thermomechanical, rig.load
    section_mm2 = float(np.pi / 4 * actuator.file.wire.diameter.value**2)
    if stated is None:
        weight = wire.force if wire else None
        return Load(section_mm2, weight.value) if weight else None
    if actuator.two_wire:
        raise ConfigError(f"Rig {rig.name} has two wires, which load each other. Remove the load.")
    if wire is None and (rig.kind == "twin" or rig.simulator is not None):
        raise ConfigError(
            f"The wire of {rig.name} is a Preisach operator, which does not depend on a load. Remove the load, or use "
            "a rig whose actuator has a table [thermomechanical]."
        )
    if stated.file:
        return Load(section_mm2, None, "", *_knots(Path(passed(stated.file)))).checked()
    return Load(section_mm2, stated.force_N, passed(stated.formula)).checked()


def _knots(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times and forces of a CSV file."""
    rows = profile_rows(path)
    if not rows or [name.strip() for name in rows[0]] != COLUMNS:
        raise DataError(f"Load {path} must begin with the header {','.join(COLUMNS)}.")
    table = profile_numbers(path, rows, len(COLUMNS))
    if len(table) > MOST_ROWS:
        raise DataError(
            f"Load {path} has more than {MOST_ROWS} rows. Give fewer; the load is linear in between."
        )
    if len(table) < 2 or not np.isfinite(table).all() or np.any(np.diff(table[:, 0]) <= 0):
        raise DataError(f"Load {path} needs at least two rows with finite values and increasing times.")
    return tuple(table[:, 0].tolist()), tuple(table[:, 1].tolist())
