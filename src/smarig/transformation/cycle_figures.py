"""The figures of one cycle from the tangents of its two branches, each with a 95 % interval or a reason why not.

    stroke                    size of the output's change between both ends of the heating branch (actuation strain)
    heating_transformation    size of its change from A_s to A_f along the tangents (transformation strain)
    cooling_transformation    size of its change from M_s to M_f along the tangents
    residual                  output at the end of the cycle minus that at its start (residual strain, unclosed part)
    span                      A_f − M_f
    width                     (A_s + A_f)/2 − (M_s + M_f)/2: the distance of both steep tangents halfway up

The names in brackets are those of ASTM E3097 for a constant force. The residual has the sign of the output.
"""

from dataclasses import dataclass, field

import numpy as np

from smarig.core import Array
from smarig.transformation.branch_tangents import DRAWS, BranchTangents, Corner
from smarig.transformation.full_branches import HEATING, FullBranch

CORNERS = {  # the branch and the side of its corner
    "A_s": ("heating", "low"),
    "A_f": ("heating", "high"),
    "M_s": ("cooling", "high"),
    "M_f": ("cooling", "low"),
}
TEMPERATURES = tuple(CORNERS)
DIFFERENCES = ("span", "width")
OUTPUTS = ("stroke", "heating_transformation", "cooling_transformation", "residual")
FIGURES = (*TEMPERATURES, *DIFFERENCES, *OUTPUTS)
NAMES = {  # in texts; of others, the key
    "heating_transformation": "transformation, heating",
    "cooling_transformation": "transformation, cooling",
    "residual": "residual of the cycle",
    "span": "span A_f − M_f",
    "width": "hysteresis width",
}
_AT_END = 0.02  # of the temperature's range: readings whose mean is the output at an end


@dataclass(frozen=True, eq=False)
class Drawn:
    """A value with the draws (B,) of its error."""

    value: float
    draws: Array

    def minus(self, other: "Drawn") -> "Drawn":
        """The difference of two."""
        return Drawn(self.value - other.value, self.draws - other.draws)

    def size(self) -> "Drawn":
        """The value and its draws with the sign that makes the value positive."""
        sign = -1.0 if self.value < 0 else 1.0
        return Drawn(sign * self.value, sign * self.draws)

    def half_with(self, other: "Drawn") -> "Drawn":
        """The mean of two."""
        return Drawn((self.value + other.value) / 2, (self.draws + other.draws) / 2)

    @property
    def ci95(self) -> tuple[float, float]:
        """The 95 % interval."""
        low, high = np.quantile(self.draws, [0.025, 0.975])
        return float(low), float(high)


@dataclass(frozen=True, eq=False)
class CycleFigures:
    """One cycle: its branches and their tangents (None if not used), figures by name, and reasons for missing ones.

    ``borrowed`` names the temperatures whose plateau is that of the other branch.
    """

    number: int
    heating: BranchTangents | None
    cooling: BranchTangents | None
    figures: dict[str, Drawn] = field(default_factory=dict)
    why_not: dict[str, str] = field(default_factory=dict)
    borrowed: tuple[str, ...] = ()
    assembled: tuple[str, ...] = ()

    @property
    def whole(self) -> bool:
        """Whether both branches are used."""
        return self.heating is not None and self.cooling is not None


def cycle_figures(
    number: int,
    branches: dict[str, FullBranch],
    tangents: dict[str, BranchTangents],
    seed: int,
) -> CycleFigures:
    """The figures of a cycle whose usable branches have tangents, by direction."""
    heating, cooling = tangents.get("heating"), tangents.get("cooling")
    figures: dict[str, Drawn] = {}
    why_not: dict[str, str] = {}
    borrowed: list[str] = []
    for name, (direction, side) in CORNERS.items():
        branch = tangents.get(direction)
        corner: Corner | None = getattr(branch, side) if branch else None
        if corner is not None:
            figures[name] = Drawn(corner.value, corner.draws)
            borrowed += [name] if corner.borrowed else []
        else:
            why_not[name] = branch.why_not[side] if branch else "its branch is not used"
    figures |= _differences(figures) | _outputs(branches, heating, cooling, seed)
    for name in FIGURES:
        if name not in figures:
            why_not.setdefault(name, "a temperature or branch that it needs is missing")
    pieces = tuple(d for d, b in branches.items() if b.curves > 1)
    ordered = {name: figures[name] for name in FIGURES if name in figures}
    return CycleFigures(number, heating, cooling, ordered, why_not, tuple(borrowed), pieces)


def _differences(found: dict[str, Drawn]) -> dict[str, Drawn]:
    figures: dict[str, Drawn] = {}
    if "A_f" in found and "M_f" in found:
        figures["span"] = found["A_f"].minus(found["M_f"])
    if all(name in found for name in TEMPERATURES):
        heating = found["A_s"].half_with(found["A_f"])
        figures["width"] = heating.minus(found["M_s"].half_with(found["M_f"]))
    return figures


def _outputs(
    branches: dict[str, FullBranch],
    heating: BranchTangents | None,
    cooling: BranchTangents | None,
    seed: int,
) -> dict[str, Drawn]:
    dice = np.random.default_rng(seed)
    figures: dict[str, Drawn] = {}
    if heating:
        cold, hot = (_end(heating.u, heating.y, heating.noise_sd, side, dice) for side in ("low", "high"))
        figures["stroke"] = cold.minus(hot).size()
    for direction, branch in (("heating", heating), ("cooling", cooling)):
        if branch and branch.low and branch.high:
            low, high = branch.low, branch.high
            rise = Drawn(low.output - high.output, low.output_draws - high.output_draws)
            figures[f"{direction}_transformation"] = rise.size()
    if heating and cooling and all(b.curves == 1 for b in branches.values()):
        first, last = list(branches.values())
        side = "low" if first.direction == HEATING else "high"
        ends = {"heating": heating, "cooling": cooling}
        if any(side in t.clipped for t in ends.values()):
            return figures
        begin, end = (
            _end(t.u, t.y, t.noise_sd, side, dice) for t in (ends[first.direction], ends[last.direction])
        )
        figures["residual"] = end.minus(begin)
    return figures


def _end(u: Array, y: Array, noise_sd: float, side: str, dice: np.random.Generator) -> Drawn:
    """The output at an end of a branch: the mean of the readings within 2 % of the temperature's range."""
    away = u - u.min() if side == "low" else u.max() - u
    near = y[away <= _AT_END * float(np.ptp(u))]
    level = float(near.mean())
    return Drawn(level, level + noise_sd / np.sqrt(near.size) * dice.standard_normal(DRAWS))
