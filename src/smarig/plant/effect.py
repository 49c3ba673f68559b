"""Effects: each changes one number at one stage of the plant, and nothing at zero strength.

Within a stage, effects are composed in the order of their names. Stages follow the order of ``Stage``. A plant without
effects executes exactly the same instructions as one without this mechanism. Each mechanism is a file of its own in
``plant/effects``.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol

from smarig.core import UsageError, spaced, suggestion
from smarig.plant.actuator import Actuator
from smarig.preisach import Everett


class Stage(IntEnum):
    """Where an effect acts, in the order of computation within a tick."""

    AMBIENT = 0  # K: ambient temperature relative to the start of the run
    CURRENT = 1  # A: amplifier and wiring, before heating
    RESISTANCE = 2  # 1: the wire's resistance relative to the constant one, for heating and voltage
    SOURCE = 3  # K: steady temperature of the present current, signed (convection)
    LAG = 4  # 1: the wire's time constant relative to the constant one (latent heat, convection)
    INPUT = 5  # K: hysteresis input (settling, accommodation)
    FEEDBACK = 6  # K: hysteresis input as a function of the output (stress); called repeatedly per tick, so no memory
    OUTPUT = 7  # unit: map of the operator's output (backlash, slack, non-congruency)
    ADDITIVE = 8  # unit: added to the position (walking, slip, creep)
    SENSOR = 9  # counts, before quantisation


@dataclass(slots=True)
class ThermalState:
    """The part of the plant's state that does not depend on the hysteresis.

    ``source_K`` is the steady temperature of the present current; ``input_K`` is that of the wire.
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
    """What an effect can read: the present state of the plant, before the stage at which the effect acts.

    ``output`` is that of the operator, ``share`` its share of the stroke in [0, 1], and ``travel`` the number of
    strokes so far. A full cycle counts two. ``austenite`` is the phase of the wire with index ``wire``: in a single
    wire the share; of two wires, that of the one which carries the current, and in the stage LAG that of the one
    whose lag is computed.
    """

    tick: int = 0
    output: float = 0.0
    share: float = 0.0
    austenite: float = 0.0
    wire: int = 0
    travel: float = 0.0

    @property
    def cycles(self) -> float:
        """Number N of full cycles so far."""
        return self.travel / 2


Hook = Callable[[float, PlantState], float]
Values = Mapping[str, float]


@dataclass(frozen=True)
class EffectContext:
    """What an effect can read before it starts: the wire, its hysteresis and the initial state."""

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
    """A physical mechanism with its changes by stage. Every call starts a new state, which the hooks keep."""

    def hooks(self, context: EffectContext) -> Mapping[Stage, Hook]:
        """The changes by stage. Empty at zero strength."""
        ...


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: unit, bounds, typical value (used to inject it), and source of these values.

    ``tries`` are the values from which a fit starts; with ``of_record`` they are shares of a record's length. A fit of
    a period also starts from that of the readings of kind ``period_of``.
    """

    name: str
    unit: str
    lower: float
    upper: float
    typical: float
    source: str
    tries: tuple[float, ...] = ()
    of_record: bool = False
    period_of: str = ""

    def checked(self, value: float, effect: str) -> float:
        """The value as a number. UsageError if it is outside the bounds."""
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not self.lower <= number <= self.upper:
            raise UsageError(
                f"{effect}.{self.name} = {value} must lie between {self.lower:g} and {self.upper:g} {self.unit}."
            )
        return number


TWO_WIRE = "two_wire"


@dataclass(frozen=True)
class EffectType:
    """A mechanism of the catalogue. Called with values, it returns an ``Effect``.

    ``parameters``: the first is the strength; at 0 the plant is unchanged bit for bit. ``act`` returns the hooks. The
    texts describe for the reader how the effect enters, what it looks like, what it is confused with, what
    distinguishes it, and what a lab can do against it (``remedy``). ``change``, if the strength is a percentage of the
    stroke, says what it does, with "{size}" in the output's unit: for a positive strength, and for a negative one.
    ``needs_wheel``: only an encoder on a pulley can have it, not a sensor that reads a length.
    ``memoryless``: the effect on the position (for a feedback, on the input) follows from the present state alone, so a
    replay needs it only at readings (a feedback also at turning points); an effect with memory is computed at every
    step. ``output_independent``: changes before the hysteresis follow from the ``ThermalState`` and the input range
    alone, so the hysteresis input of a record is computed once for all densities. Other effects are simulated tick by
    tick, with the same numbers.

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
    arrangement: str = ""  # TWO_WIRE if it needs two wires
    memoryless: bool = False
    output_independent: bool = False
    remedy: str = ""
    change: tuple[str, ...] = ()
    needs_wheel: bool = False
    shape: Any = None  # of a learned effect, which no catalogue lists

    @property
    def remedy_text(self) -> str:
        """What a lab can do against it, as a sentence; "" if nothing is known."""
        return f"Against {self.name}: {self.remedy}." if self.remedy else ""

    @property
    def primary(self) -> Parameter:
        """The strength."""
        return self.parameters[0]

    def __call__(self, strength: float | None = None, /, **values: float) -> "Effect":
        """The effect with these values. Missing values are typical; so is the strength if it is None."""
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

    def __hash__(self) -> int:
        return hash((self.kind, frozenset(self.values.items())))

    @property
    def strength(self) -> float:
        """The value of the primary parameter."""
        return self.values[self.kind.primary.name]

    def at(self, strength: float) -> "Effect":
        """The same effect with another strength."""
        return self.kind(**self.values | {self.kind.primary.name: strength})

    @property
    def with_positive_strength(self) -> "Effect":
        """The same effect with a positive strength, if it has a phase: half a turn is the opposite sign.

        >>> from smarig.plant.effects.ambient_drift import ambient_drift
        >>> ambient_drift(-1.5, phase=0.75).with_positive_strength
        ambient_drift(swing_K=1.5, period_h=12, phase=0.25)
        """
        phase = next((p.name for p in self.kind.parameters if p.unit == "turn"), None)
        if phase is None or self.strength >= 0:
            return self
        opposite = {self.kind.primary.name: -self.strength, phase: (self.values[phase] + 0.5) % 1.0}
        return self.kind(**self.values | opposite)

    def hooks(self, context: EffectContext) -> Mapping[Stage, Hook]:
        """The changes by stage; none at zero strength. UsageError if it needs two wires and the rig has one."""
        if not self.strength and self.kind.shape is None:  # a learned law may be 0 at its first value only
            return {}
        if self.kind.arrangement == TWO_WIRE and not context.actuator.two_wire:
            raise UsageError(f"{self.kind.name} needs two wires, but this rig has one.")
        return self.kind.act(self.values, context)

    def change_text(self, stroke: float, unit: str) -> str:
        """What it does, as a sentence with its direction and its size in ``unit``; the summary if its strength is no
        percentage of the stroke.

        >>> from smarig.plant.effects.walking import walking
        >>> walking(-0.5).change_text(12.0, "mm")
        'With every full cycle the position falls by 0.06 mm.'
        """
        if not self.kind.change:
            return self.kind.summary
        text = self.kind.change[0 if self.strength > 0 else -1]
        size = f"{abs(self.strength) / 100 * stroke:.2g}{spaced(unit)}"
        return text.format(size=size)

    def to_json(self) -> dict[str, Any]:
        """{"name", "parameters"}, as stored in model files; a learned effect has a "shape" too."""
        shape = {"shape": self.kind.shape.to_json()} if self.kind.shape else {}
        return {"name": self.kind.name, "parameters": dict(self.values)} | shape

    def __repr__(self) -> str:
        return f"{self.kind.name}({', '.join(f'{k}={v:g}' for k, v in self.values.items())})"


def in_order(effects: Iterable[SupportsHooks]) -> tuple[SupportsHooks, ...]:
    """Effects in their order of composition: first those without a name, as given, then by name."""
    return tuple(sorted(effects, key=lambda e: e.kind.name if isinstance(e, Effect) else ""))


def hook_chains(effects: Iterable[SupportsHooks], context: EffectContext) -> dict[Stage, tuple[Hook, ...]]:
    """The hooks of each stage in their order of composition."""
    all_values = [effect.hooks(context) for effect in in_order(effects)]
    return {stage: tuple(hooks[stage] for hooks in all_values if stage in hooks) for stage in Stage}
