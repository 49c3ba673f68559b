"""An effect learned from runs: a piecewise linear function of one variable, at the position, temperature or heat loss.

    output:   position = P[u] + f(z)        input:   u = T + f(z)        heat_loss:   h = h₀/(1 + f(z)): T_∞, τ ~ 1/h

z follows from the commands, the clock and the travel (``LEARNED_FROM``), or is a mean of the last minutes:

    dz/dt = (x − z)/τ,    x: steady temperature of the present current ("power"), or output of the hysteresis ("level")

f is 0 at its first knot, and constant beyond its end knots: the hysteresis contains every constant.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log10
from typing import Any

from smarig.core import UsageError, stored_number
from smarig.plant.effect import EffectContext, EffectType, Hook, Parameter, PlantState, Stage, Values

LEARNED = "learned"
PLACES = ("output", "input", "heat_loss")
ANSWER_S = 10.0  # decay of ``rate`` after a step
SHORTEST_HOLD_S = 1.0
OUTPUT_BOUND, INPUT_BOUND = 0.5, 0.3  # of the ranges of output and input (1 of the heat loss): bounds of f
MOST_KNOTS, LONGEST_UNIT = 100, 40  # in model files
NOT_LEARNED = ("level", "input")  # a density has such a law anyway
TYPICAL_SHARE = 0.01  # of the same ranges: expected size of f


class _Drive:
    """The commands so far, as far as a variable depends on them."""

    def __init__(self) -> None:
        self.command_A, self.began_s, self.last_s = 0.0, 0.0, 0.0
        self.target_K, self.before_K, self.direction, self.reversals = 0.0, 0.0, 0.0, 0

    def follow(self, now: PlantState) -> None:
        """Take note of the present command."""
        if now.command_A != self.command_A:
            direction = 1.0 if now.source_K > self.target_K else -1.0
            self.reversals += direction == -self.direction
            self.command_A, self.before_K, self.direction = now.command_A, self.target_K, direction
            self.began_s = self.last_s
        self.target_K, self.last_s = now.source_K, now.t_s

    @property
    def elapsed_s(self) -> float:
        """Seconds since the command changed."""
        return self.last_s - self.began_s


Variable = Callable[[PlantState], float]


def _of_commands(value: Callable[[_Drive], float]) -> Callable[[], Variable]:
    """A variable of the commands so far; every call starts a new record of them."""

    def start() -> Variable:
        drive = _Drive()

        def variable(now: PlantState) -> float:
            drive.follow(now)
            return value(drive)

        return variable

    return start


def _mean(value: Variable, tau_s: float, start_value: float | None) -> Callable[[], Variable]:
    """A mean of the last minutes, from a start or from the first value."""

    def start() -> Variable:
        mean = start_value

        def variable(now: PlantState) -> float:
            nonlocal mean
            x = value(now)
            mean = x if mean is None else x + (mean - x) * exp(-now.dt_s / tau_s)
            return mean

        return variable

    return start


MEANS_S = {"2_min": 120.0, "15_min": 900.0}  # time constants of means of the last minutes
MEAN_POWERS = {f"power_over_{name}": tau_s for name, tau_s in MEANS_S.items()}
MEAN_LEVELS = {f"level_over_{name}": tau_s for name, tau_s in MEANS_S.items()}
LEARNED_FROM: dict[str, Callable[[], Variable]] = {
    "time": lambda: lambda now: now.t_s,
    "cycle": lambda: lambda now: now.cycles,
    "level": lambda: lambda now: now.output,
    "step": _of_commands(lambda drive: drive.target_K - drive.before_K),
    "hold": _of_commands(lambda drive: log10(max(drive.elapsed_s, SHORTEST_HOLD_S))),
    "rate": _of_commands(lambda drive: drive.direction * exp(-drive.elapsed_s / ANSWER_S)),
    "history": _of_commands(lambda drive: drive.before_K),
    "reversals": _of_commands(lambda drive: float(drive.reversals)),
    **{name: _mean(lambda now: now.source_K, tau_s, 0.0) for name, tau_s in MEAN_POWERS.items()},
    **{name: _mean(lambda now: now.output, tau_s, None) for name, tau_s in MEAN_LEVELS.items()},
}
VARIABLE_UNITS = {  # of the others: "1"; "" is the unit of the output
    "time": "s",
    "level": "",
    "step": "K",
    "hold": "s",
    "history": "K",
    **dict.fromkeys(MEAN_POWERS, "K"),
    **dict.fromkeys(MEAN_LEVELS, ""),
}
OF_HEAT_LOSS = ("time", "cycle")  # variables that a heat loss may depend on
_OF_PRESENT = ("time", "cycle", "level")  # the others have a memory
_OF_OUTPUT = ("cycle", "level", *MEAN_LEVELS)


@dataclass(frozen=True)
class LearnedShape:
    """The ``variable`` and knots of a law, whether it ``enters`` at the output or the input, and the unit of f."""

    variable: str
    enters: str
    knots: tuple[float, ...]
    unit: str

    @property
    def variable_unit(self) -> str:
        """Unit of the variable; that of ``hold`` belongs to the number whose logarithm it is."""
        return VARIABLE_UNITS.get(self.variable, "1")

    @property
    def variable_text(self) -> str:
        """The variable in words."""
        quantity, over, minutes = self.variable.partition("_over_")
        if not over:
            return self.variable
        mean_of = "power" if quantity == "power" else "output"
        return f"the mean {mean_of} of the last {minutes.replace('_', ' ')}"

    @property
    def knots_in_unit(self) -> tuple[float, ...]:
        """The knots in ``variable_unit``: holds as such, not their logarithms."""
        return tuple(10.0**z for z in self.knots) if self.variable == "hold" else self.knots

    def to_json(self) -> dict[str, Any]:
        """Plain values, as stored in a model file."""
        return {
            "variable": self.variable,
            "enters": self.enters,
            "knots": list(self.knots),
            "unit": self.unit,
        }

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> "LearnedShape":
        """The shape of a model file. Raises UsageError or DataError for a damaged one."""
        missing = sorted({"variable", "enters", "knots", "unit"} - set(stored))
        if missing:
            raise UsageError(f"the shape of a learned law has no {missing[0]}")
        variable, enters, knots, unit = (stored[key] for key in ("variable", "enters", "knots", "unit"))
        if (
            variable not in tuple(LEARNED_FROM)
            or enters not in PLACES
            or not can_be_learned(variable, enters)
        ):
            raise UsageError(
                f"a learned law cannot depend on {variable!r:.40} at the {enters!r:.40}; variables are "
                f"{', '.join(LEARNED_FROM)}, places {', '.join(PLACES)} (heat_loss: {', '.join(OF_HEAT_LOSS)})"
            )
        if not isinstance(knots, list) or not 2 <= len(knots) <= MOST_KNOTS:
            raise UsageError(f"a learned law has a list of 2 to {MOST_KNOTS} knots")
        if not isinstance(unit, str) or len(unit) > LONGEST_UNIT or not unit.isprintable():
            raise UsageError("the unit of a learned law is not a short text")
        shape = cls(variable, enters, tuple(stored_number(z, "a knot of a learned law") for z in knots), unit)
        if any(a >= b for a, b in zip(shape.knots, shape.knots[1:])):
            raise UsageError("the knots of a learned law must increase")
        return shape


def can_be_learned(variable: str, place: str) -> bool:
    """Whether a law of this variable at this place says something that no density says anyway."""
    return (variable, place) != NOT_LEARNED and (place != "heat_loss" or variable in OF_HEAT_LOSS)


def learned_effect_type(shape: LearnedShape, range_of_place: float) -> EffectType:
    """The effect type of laws with these knots; its parameters are f at all knots but the first.

    ``range_of_place`` is the range of the output or of the input, or 1 of the heat loss; it bounds f.
    """
    at_output = shape.enters == "output"
    bound = (OUTPUT_BOUND if at_output else INPUT_BOUND) * range_of_place
    parameters = tuple(
        Parameter(
            f"value_{k}", shape.unit, -bound, bound, TYPICAL_SHARE * range_of_place, "learned", tries=(0.0, bound)
        )
        for k in range(1, len(shape.knots))
    )  # fmt: skip
    return EffectType(
        name=LEARNED,
        summary=f"A term that depends on {shape.variable_text}, learned from runs.",
        number="",
        enters=shape.enters,
        looks_like="",
        confused_with=(),
        separated_by="",
        parameters=parameters,
        act=_Law(shape),
        memoryless=at_output and shape.variable in _OF_PRESENT,
        output_independent=not at_output and shape.variable not in _OF_OUTPUT,
        shape=shape,
    )


@dataclass(frozen=True)
class _Law:
    """The hooks of a law."""

    shape: LearnedShape

    def __call__(self, p: Values, _context: EffectContext) -> Mapping[Stage, Hook]:
        shape = self.shape
        z_of, law = LEARNED_FROM[shape.variable](), _interpolation(shape.knots, (0.0, *p.values()))

        def added(value: float, now: PlantState) -> float:
            return value + law(z_of(now))

        def divided(value: float, now: PlantState) -> float:
            return value * (1.0 + law(z_of(now)))

        if shape.enters == "heat_loss":
            return {Stage.SOURCE: divided, Stage.LAG: divided}
        return {Stage.ADDITIVE if shape.enters == "output" else Stage.INPUT: added}


def _interpolation(knots: Sequence[float], values: Sequence[float]) -> Callable[[float], float]:
    """f between the knots, and constant beyond them."""

    def law(z: float) -> float:
        k = bisect_right(knots, z)
        if k == 0 or k == len(knots):
            return values[k and -1]
        share = (z - knots[k - 1]) / (knots[k] - knots[k - 1])
        return values[k - 1] + share * (values[k] - values[k - 1])

    return law
