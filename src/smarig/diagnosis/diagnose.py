"""The whole diagnosis: show what the simulation gets wrong, name it, extend the model, measure the gain.

Puts the parts of this folder in order. Refuses to know rigs and pages.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from smarig.diagnosis.comparable import comparable
from smarig.diagnosis.critique import ALPHA, NULLS, Critique, critique
from smarig.diagnosis.density_beside import density_said, settled_rms
from smarig.diagnosis.either_density import found
from smarig.diagnosis.gain import Gain, measured_gain
from smarig.diagnosis.refine import Refined
from smarig.diagnosis.search import Level
from smarig.diagnosis.sentences import sentences
from smarig.diagnosis.verdict import Verdict, decided
from smarig.diagnosis.visibility import Visibility, visibility
from smarig.errors import UsageError
from smarig.identification.lived import subject_of, wire_of
from smarig.identification.model_file import Model, load_model
from smarig.identification.origin import file_hash, provenance
from smarig.model.effect import Kind
from smarig.model.given import GivenInput, judgeable
from smarig.model.planted import kinds, kinds_of
from smarig.record import Run, load_run
from smarig.shown import Shown
from smarig.story.retelling import numerics
from smarig.story.subject import Subject
from smarig.story.told import Story, told

NORMAL_95 = 1.96
LEAST_ALPHA = 1e-6


@dataclass(frozen=True, eq=False)
class Error:
    """Rms of settled points of the training runs: noise, the model as given, refitted, and extended."""

    unit: str
    noise_floor: float
    given: float
    base: float
    extended: float


@dataclass(frozen=True, eq=False)
class Diagnosis(Shown):
    """What was found, with the evidence it rests on.

    ``base`` is the wire without them, its density identified anew: what the gain is counted against. ``model`` is the
    extended model where effects were found, else the given one; ``gain`` is None without held-out runs. ``numerics``
    is the error of the critic's own time steps at settled points; ``separating_run`` what ``smarig.proposal`` proposes,
    if it was asked.
    """

    verdict: Verdict
    story: Story
    first: Critique
    levels: tuple[Level, ...]
    base: Subject
    visibility: Visibility
    error: Error
    gain: Gain | None
    model: Model
    numerics: float
    alpha: float
    nulls: int
    seconds: float
    separating_run: dict[str, Any] | None = None

    @property
    def best(self) -> Refined | None:
        """The best explanation, where one is needed."""
        said = self.verdict.word in ("named", "ambiguous") or self.verdict.explanations
        return self.levels[-1].best if self.levels and said else None

    @property
    def left(self) -> str | None:
        """What the readings still depend on beside the effects that were found, None where nothing stands out."""
        last = self.levels[-1].critique if self.levels and self.extended else None
        if last is None or last.silent:
            return None
        plain = last.best(1, generic=True)
        return plain[0].candidate.depends_on if plain else last.largest.candidate.name

    @property
    def extended(self) -> bool:
        """Whether ``model`` is an extended one."""
        return self.verdict.word in ("named", "ambiguous")

    def text(self) -> str:
        """What was found, in plain sentences."""
        return "\n".join(sentences(self))

    def effects(self) -> list[dict[str, Any]]:
        """The effects of the best explanation: name, probability, parameters with 95 % intervals."""
        best = self.best
        return [] if best is None else [_effect(p, best, self.verdict) for p in best.effects]

    def to_json(self) -> dict[str, Any]:
        """The CLI's JSON object."""
        e, gain = self.error, self.gain
        held_out = gain and {
            "given": gain.given,
            "base": gain.base,
            "extended": gain.extended,
            "noise_floor": gain.floor,
            "removable_share": gain.removable_share,
            "ci95": gain.interval(),
            "blocks": gain.blocks,
        }
        return {
            "verdict": self.verdict.word,
            "effects": self.effects(),
            "set": list(self.verdict.names),
            "depends_on": self.verdict.depends_on,
            "not_identifiable": list(self.visibility.invisible),
            "error": {
                "unit": e.unit,
                "noise_floor": e.noise_floor,
                "base": e.base,
                "extended": e.extended,
                "given": e.given,
            },
            "held_out": held_out,
            "separating_run": self.separating_run,
            "alpha": self.alpha,
            "p_value": self.first.p_value,
            "stands_out": not self.first.silent,
            "nulls": self.nulls,
            "model": self.model.name,
            "numerics": self.numerics,
            "seconds": self.seconds,
        }

    def __repr__(self) -> str:
        said = " + ".join(str(p) for p in self.best.effects) if self.best else self.verdict.depends_on or ""
        return f"Diagnosis({self.verdict.word}{': ' if said else ''}{said})"


def _effect(planted: Any, best: Refined, verdict: Verdict) -> dict[str, Any]:
    kind: Kind = planted.kind
    fitted = {q: s for (name, q), s in best.spread.items() if name == kind.name}
    return {
        "name": kind.name,
        "probability": verdict.probability(kind.name),
        "parameters": {
            p.name: {
                "value": planted.values[p.name],
                "ci95": _interval(planted.values[p.name], fitted.get(p.name), (p.lower, p.upper)),
                "unit": p.unit,
            }
            for p in kind.parameters
        },
    }


def _interval(value: float, spread: float | None, bounds: tuple[float, float]) -> list[float] | None:
    if spread is None:
        return None
    half = NORMAL_95 * spread
    return [max(value - half, bounds[0]), min(value + half, bounds[1])]


@threadpool_limits.wrap(limits=1, user_api="blas")  # matrices of hundreds: threads would wait for each other
def diagnose(
    model: Model | str | Path,
    train: Sequence[Run | str | Path] | Run | str | Path,
    held_out: Sequence[Run | str | Path] | Run | str | Path = (),
    *,
    alpha: float = ALPHA,
    nulls: int = NULLS,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """What a model gets wrong on runs of one wire, why, and what it gains to know.

    ``train`` teaches, ``held_out`` only judges the gain; ``without`` takes effects out of the catalogue.
    ``alpha`` is the chance of any false alarm; ``nulls`` how many empty stories it is judged by. Raises DataError
    when the runs hold no settled steps or overlap, UsageError for settings that make no sense.
    """
    started, say = time.monotonic(), progress or (lambda _: None)
    _check(alpha, nulls, seed)
    given = model if isinstance(model, Model) else load_model(model)
    taught, judged = _runs(train), _runs(held_out)
    comparable(given, [*taught, *judged])
    story, subject = _told(given, taught)
    if judged:
        _judges(given, taught, judged)
    catalogue, blind = _judgeable(_catalogue(subject, without), story, subject)
    say(f"{len(story.settled)} settled points, {sum(len(r) for r in story.others)} other readings")
    judge = partial(critique, story, kinds=catalogue, count=nulls, alpha=alpha, seed=seed)
    seen = found(story, subject, judge, say)
    base, first, levels = seen.base, seen.first, seen.levels
    verdict = decided(first, levels)
    base = density_said(story, base, seen.plain)
    extended = base
    if levels and verdict.explanations:
        likeliest = levels[-1].explanations[0]
        extended = density_said(story, likeliest.subject, likeliest.refitted)
    known = (levels[-1].critique if levels else first).refitted
    noise, open_density = known.noise, known.posterior.variances
    gain = measured_gain(taught, judged, base, extended, noise, open_density, subject) if judged else None
    return Diagnosis(
        verdict,
        story,
        first,
        tuple(levels),
        base,
        visibility(first, blind),
        Error(
            story.unit,
            _floor(noise.white[: len(story.settled)]),
            settled_rms(story, subject),
            settled_rms(story, base),
            settled_rms(story, extended),
        ),
        gain,
        _extended(given, extended, taught, verdict) if verdict.word in ("named", "ambiguous") else given,
        numerics(story, base),
        alpha,
        nulls,
        time.monotonic() - started,
    )


def _check(alpha: float, nulls: int, seed: int) -> None:
    if not LEAST_ALPHA <= alpha < 0.5:
        raise UsageError(f"The chance of a false alarm lies between 0 and 0.5, not at {alpha:g}.")
    if seed < 0:
        raise UsageError(f"Seed {seed} is negative; give a whole number from 0 up.")
    if nulls < 1 / alpha:
        raise UsageError(
            f"{nulls} nulls cannot tell a chance of {alpha:g}; at least {int(1 / alpha) + 1} can."
        )


def _runs(given: Any) -> list[Run]:
    several = [given] if isinstance(given, Run | str | Path) else list(given)
    return [run if isinstance(run, Run) else load_run(run) for run in several]


def _judges(model: Model, taught: list[Run], judged: list[Run]) -> None:
    """Raises, before anything is computed, where held-out runs cannot judge."""
    if any(_same(a, b) for a in taught for b in judged):
        raise UsageError("A run cannot teach and judge: a copy of a training run is held out.")
    told([*taught, *judged], wire_of(model, taught[0]).tau_s)


def _same(a: Run, b: Run) -> bool:
    """Whether two runs are the same measurement, not only parts of one file."""
    return file_hash(a) == file_hash(b) != "" and np.array_equal(a["tick"], b["tick"])


def _told(model: Model, runs: list[Run]) -> tuple[Story, Subject]:
    if not runs:
        raise UsageError("A diagnosis needs at least one run to learn from.")
    story = told(runs, wire_of(model, runs[0]).tau_s)
    return story, subject_of(model, story.runs[0])


def _catalogue(subject: Subject, without: Sequence[str]) -> list[Kind]:
    every = kinds("two_wire" if subject.actuator.two_wire else "one_wire")
    every += kinds_of("untrained") if isinstance(subject.actuator, GivenInput) else ()
    names = [k.name for k in kinds()]
    for name in without:
        if name not in names:
            raise UsageError(f"There is no effect '{name}' to leave out.")
    return [k for k in every if k.name not in without]


def _judgeable(every: list[Kind], story: Story, subject: Subject) -> tuple[list[Kind], list[str]]:
    """(effects that these data could show, names of those that act before the input was measured)."""
    clock = story.given == "clock"
    seen = [k for k in every if not story.given or judgeable(k, subject.hysteresis, clock=clock)]
    return seen, [k.name for k in every if k not in seen]


def _floor(noise: np.ndarray) -> float:
    return float(np.sqrt(np.mean(noise**2)))


def _extended(given: Model, subject: Subject, train: list[Run], verdict: Verdict) -> Model:
    """The given model with the density identified beside the effects, and with them."""
    return replace(
        given,
        name=f"{given.name} + {' + '.join(e.kind.name for e in subject.planted)}",
        hysteresis=subject.hysteresis,
        effects=tuple(e.to_json() for e in subject.planted),
        parameters=(),
        covariance=np.empty((0, 0)),
        intervals={},
        provenance=tuple(provenance(run) for run in train),
        warnings=(*given.warnings, f"Effects by diagnosis ({verdict.word}); density identified beside them."),
    )
