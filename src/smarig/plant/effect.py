"""The seam where physical mechanisms enter a plant: one number changed at one stage, the identity when absent.

A stage names what passes by. Effects of one stage are composed in the order of their names, stages in the
order of ``Stage``; a plant without effects runs the very same instructions as one that never heard of them.
Knows no mechanism: each is a file of its own in ``model/effects``.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol

from smarig.core import UsageError, suggestion
from smarig.plant.actuator import Actuator
from smarig.preisach import Everett


class Stage(IntEnum):
    """Where an effect acts, in the order in which a tick passes through the plant."""

    AMBIENT = 0  # K: the room, above where it was when the run began
    CURRENT = 1  # A: amplifier and wiring, before heating
    RESISTANCE = 2  # 1: the wire's resistance over the constant one, for heating and for the voltage
    SOURCE = 3  # K: steady temperature the current would give, signed (convection)
    LAG = 4  # 1: the wire's time constant over the constant one (latent heat, convection)
    INPUT = 5  # K: temperature the hysteresis feels (settling, accommodation)
    FEEDBACK = (
        6  # K: the same, by the output it leads to (stress): asked more than once a tick, so without memory
    )
    OUTPUT = 7  # unit: map of the operator's output (backlash, slack, non-congruency)
    ADDITIVE = 8  # unit: what adds to position (walking, slip, creep)
    SENSOR = 9  # counts, before quantisation


@dataclass(slots=True)
class ThermalState:
    """The part of a moment that asks nothing of the hysteresis.

    ``source_K`` is the steady temperature of the present current, ``input_K`` the wire's.
    """

    t_s: float = 0.0
    dt_s: float = 0.1
    command_A: float = 0.0
    current_A: float = 0.0
    resistance: float = 1.0
    ambient_K: float = 0.0
    source_K: float = 0.0
    input_K: float = 0.0
    hysteresis_input_K: float = 0.0


@dataclass(slots=True)
class PlantState(ThermalState):
    """What an effect may look at: the plant's present, before the stage it acts on.

    ``output`` is the operator's, ``austenite`` its share of the stroke in [0, 1] and ``travel`` the strokes it has made
    in all, there and back counting two.
    """

    tick: int = 0
    output: float = 0.0
    austenite: float = 0.0
    travel: float = 0.0

    @property
    def cycles(self) -> float:
        """Full strokes there and back, N."""
        return self.travel / 2


Hook = Callable[[float, PlantState], float]
Values = Mapping[str, float]


@dataclass(frozen=True)
class EffectContext:
    """What an effect may know before it begins: the wire, its hysteresis, and the state that starts in."""

    actuator: Actuator
    hysteresis: Everett
    initial: Any

    @property
    def y_lower(self) -> float:
        """Output of negative saturation."""
        return self.hysteresis.y_lower

    @property
    def stroke(self) -> float:
        """Output between both saturations, y₊ − y₋."""
        return self.hysteresis.everett(self.hysteresis.upper, self.hysteresis.lower)

    @property
    def largest_A(self) -> float:
        """The current that saturates the hysteresis."""
        h = self.hysteresis
        return abs(self.actuator.current_for(max(h.upper, -h.lower)))


class SupportsHooks(Protocol):
    """A physical mechanism: its changes by stage. Every call begins anew; state lives in the hooks."""

    def hooks(self, context: EffectContext) -> Mapping[Stage, Hook]:
        """The changes, by stage; empty at zero strength."""
        ...


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: unit, bounds, what is typical (used to plant it), where that comes from.

    ``tries`` are values worth trying where data must tell; ``of_record``: as shares of a record's length.
    """

    name: str
    unit: str
    lower: float
    upper: float
    typical: float
    source: str
    tries: tuple[float, ...] = ()
    of_record: bool = False

    def checked(self, value: float, effect: str) -> float:
        """The value as a number within its bounds; UsageError otherwise."""
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not self.lower <= number <= self.upper:
            raise UsageError(
                f"{effect}.{self.name} = {value} is not between {self.lower:g} and {self.upper:g} {self.unit}."
            )
        return number


TWO_WIRE = "two_wire"


@dataclass(frozen=True)
class EffectType:
    """A mechanism, described; called with values it becomes an ``SupportsHooks``.

    ``parameters``: the first is the primary one, its strength, at whose 0 the plant is untouched bit for bit.
    ``act`` gives the hooks. The texts are for people: how it enters, looks, hides, and what tells it apart.
    ``memoryless``: what it does to the position follows from the moment alone, so a replay need ask only where
    something was read; an effect with a memory is asked at every step.
    ``output_independent``: what it does ahead of the hysteresis follows from the ``ThermalState`` and from the
    input range
    of the hysteresis alone, so the input along a record is computed once for all densities; an effect that does not
    declare it is simulated tick by tick, which gives the same numbers.

    >>> from smarig.plant.effects.walking import walking
    >>> walking(0.2)
    walking(percent_per_cycle=0.2)
    """

    name: str
    summary: str
    number: str
    enters: str
    looks_like: str
    confused_with: tuple[str, ...]
    separated_by: str
    parameters: tuple[Parameter, ...]
    act: Callable[[Values, EffectContext], Mapping[Stage, Hook]] = field(repr=False)
    arrangement: str = ""  # TWO_WIRE where it needs two wires
    memoryless: bool = False
    output_independent: bool = False

    @property
    def primary(self) -> Parameter:
        """The strength."""
        return self.parameters[0]

    def __call__(self, strength: float | None = None, /, **values: float) -> "Effect":
        """The mechanism with values; those left out are typical, and so is the strength when None."""
        parameter_names = [p.name for p in self.parameters]
        for name in values:
            if name not in parameter_names:
                raise UsageError(f"{self.name} has no parameter '{name}'{suggestion(name, parameter_names)}.")
        primary_value = {self.primary.name: strength} if strength is not None else {}
        all_values = {p.name: p.typical for p in self.parameters} | primary_value | values
        return Effect(self, {p.name: p.checked(all_values[p.name], self.name) for p in self.parameters})


@dataclass(frozen=True, repr=False)
class Effect:
    """An effect with its values by parameter."""

    kind: EffectType
    values: dict[str, float]

    @property
    def strength(self) -> float:
        """The primary parameter."""
        return self.values[self.kind.primary.name]

    def at(self, strength: float) -> "Effect":
        """The same mechanism, as strong as given."""
        return self.kind(**self.values | {self.kind.primary.name: strength})

    def hooks(self, context: EffectContext) -> Mapping[Stage, Hook]:
        """The changes, by stage; none at all at zero strength. UsageError on one wire where two are needed."""
        if not self.strength:
            return {}
        if self.kind.arrangement == TWO_WIRE and not context.actuator.two_wire:
            raise UsageError(f"{self.kind.name} needs two wires, and this rig has one.")
        return self.kind.act(self.values, context)

    def to_json(self) -> dict[str, Any]:
        """{"name", "parameters"}, as in model files."""
        return {"name": self.kind.name, "parameters": dict(self.values)}

    def __repr__(self) -> str:
        return f"{self.kind.name}({', '.join(f'{k}={v:g}' for k, v in self.values.items())})"


def in_order(effects: Iterable[SupportsHooks]) -> tuple[SupportsHooks, ...]:
    """Effects in the one order of composition: by name, those without a name as given, first."""
    return tuple(sorted(effects, key=lambda e: e.kind.name if isinstance(e, Effect) else ""))


def hook_chains(effects: Iterable[SupportsHooks], context: EffectContext) -> dict[Stage, tuple[Hook, ...]]:
    """The hooks of every stage in the order of composition."""
    all_values = [effect.hooks(context) for effect in in_order(effects)]
    return {stage: tuple(hooks[stage] for hooks in all_values if stage in hooks) for stage in Stage}
