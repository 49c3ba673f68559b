"""A diagnosis as its figures see it: the story lived by both models, what each misses, noise, slopes.

Also the words that captions share. Knows the diagnosis; refuses to know figures and HTML.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smarig.diagnosis.diagnose import Diagnosis
from smarig.diagnosis.noise import propagated, remembered
from smarig.identification.lived import subject_of
from smarig.preisach.sensitivity import sensitivities
from smarig.report.conditions import label_of, protocol_of
from smarig.report.numbers import number
from smarig.report.style import INK, MODEL
from smarig.story.retelling import COUPLED, Retelling, retold
from smarig.story.told import Readings, Story

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Replay:
    """The story as the base model tells it, and as the extended one does (None without one)."""

    d: Diagnosis
    base: Retelling
    extended: Retelling | None

    @classmethod
    def of(cls, d: Diagnosis) -> "Replay":
        """Lived through once more where there is an extended model."""
        after = retold(d.story, subject_of(d.model, d.story.runs[0])) if d.extended else None
        return cls(d, retold(d.story, d.base), after)

    @property
    def told(self) -> tuple[tuple[Retelling, str, str], ...]:
        """(retelling, name of its residuals, colour)."""
        first = (self.base, "measured − base model", INK)
        return (first, (self.extended, "measured − extended model", MODEL)) if self.extended else (first,)

    def missed(self, told: Retelling, kind: str) -> Array:
        """Measured minus predicted (n,) of one kind of reading; its free zero removed (currents have none)."""
        story = self.d.story
        error = readings(story, kind).value - told.values[kind]
        if kind == "current":
            return error
        zero = story.zero if story.given else np.zeros(error.size)
        return error - np.array([error[zero == z].mean() for z in zero])


def readings(story: Story, kind: str) -> Readings:
    """The readings of one kind."""
    return next(r for r in story.kinds if r.kind == kind)


def noise_of(d: Diagnosis, kind: str) -> tuple[float, float]:
    """Rms noise of one kind of reading: its own, and with the draughts that the hysteresis remembers."""
    critic = d.levels[-1].critique if d.levels else d.first
    fitted, before = critic.refitted, 0
    for r in d.story.kinds[: [r.kind for r in d.story.kinds].index(kind)]:
        before += len(r)
    here = slice(before, before + len(readings(d.story, kind)))
    if kind not in COUPLED:
        own = rms(fitted.scale[here])
        return own, own
    J, times = remembered(critic.subject.hysteresis, critic.told)
    share = np.diag(propagated(J, times, fitted.noise.correlation_s))[here] * critic.told.follows[here] ** 2
    own = rms(fitted.noise.white[here])
    return own, float(np.hypot(own, fitted.noise.temperature_K * np.sqrt(share.mean())))


def slopes(d: Diagnosis) -> Array:
    """∂y/∂u to the input (k,) of the base model at the settled points."""
    states = d.first.told.states[: len(d.story.settled)]
    return np.array([s[-1] for s in sensitivities(d.first.subject.hysteresis, states)])


def models_words(replay: Replay, reaches: Sequence[float]) -> str:
    """Which colour is which model, and how far its axis reaches (base, extended)."""
    if replay.extended is None:
        return ""
    finer = reaches[0] / reaches[-1]
    where = "on the same axes" if finer == 1 else f"on an axis {number(finer, 2)} times finer"
    return f" (black: base model; green: extended model, {where})"


def place_of(d: Diagnosis, *, dotted: bool = False) -> tuple[str, ...]:
    """The caption's last sentence: which runs, on what rig; ``dotted`` where a line shows their beginnings."""
    protocols = ", ".join(dict.fromkeys(map(protocol_of, d.story.runs)))
    parts = [
        f"{len(d.story.runs)} training run{'s' if len(d.story.runs) > 1 else ''} ({protocols}"
        + ("; a dotted line where the next begins)" if dotted and len(d.story.runs) > 1 else ")"),
        *rig_words(d),
    ]
    return ("; ".join(part for part in parts if part) + ".",)


def rig_words(d: Diagnosis) -> tuple[str, ...]:
    """Rig, wire and seed, as far as known."""
    run = d.story.runs[0]
    rig, wire, seed = (run.meta.get(key) for key in ("rig", "wire", "seed"))
    known = (
        f"rig {rig}" if rig else "",
        f"wire {wire}" if wire else "",
        f"seed {seed}" if label_of(run) and seed is not None else "",
    )
    return tuple(part for part in known if part)


def rms(values: ArrayLike, weight: Array | None = None) -> float:
    """Root of the mean square, weighted if asked for."""
    return float(np.sqrt(np.average(np.asarray(values, dtype=float) ** 2, weights=weight)))
