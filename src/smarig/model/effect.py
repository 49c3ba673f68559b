"""The seam where physical effects enter a plant: one scalar changed at one stage, the identity when absent.

A stage names what passes by; effects of one stage are composed in the order given, stages in the order
of ``Stage``. A plant without effects runs the very same instructions as one that never heard of them.
Knows no effect: each is a file of its own.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Protocol

from smarig.preisach.everett import Everett


class Stage(IntEnum):
    """Where an effect acts, in the order in which a tick passes through the plant."""

    CURRENT = 0  # A: amplifier and wiring, before heating
    SOURCE = 1  # K: steady temperature the current would give, signed (heat, convection, resistance)
    INPUT = 2  # K: temperature the hysteresis feels (ambient drift, stress and other feedback)
    OUTPUT = 3  # unit: map of the operator's output (backlash, saturation, accommodation)
    ADDITIVE = 4  # unit: what adds to position (walking, slip, creep)
    SENSOR = 5  # counts, before quantisation


@dataclass(slots=True)
class Moment:
    """What an effect may look at: the plant's present, before the stage it acts on."""

    tick: int = 0
    t_s: float = 0.0
    dt_s: float = 0.1
    current_A: float = 0.0
    input_K: float = 0.0
    output: float = 0.0
    austenite: float = 0.0


Hook = Callable[[float, Moment], float]


class Effect(Protocol):
    """A physical mechanism. ``hooks`` by stage; ``hysteresis`` may replace the memory (density effects)."""

    def hooks(self) -> Mapping[Stage, Hook]:
        """The changes, by stage; empty at zero strength."""
        ...

    def hysteresis(self, base: Everett) -> Everett:
        """The memory with the effect; ``base`` itself at zero strength."""
        ...


def chain(effects: Iterable[Effect], stage: Stage) -> tuple[Hook, ...]:
    """The hooks of one stage in the order of the effects."""
    return tuple(hooks[stage] for hooks in (e.hooks() for e in effects) if stage in hooks)
