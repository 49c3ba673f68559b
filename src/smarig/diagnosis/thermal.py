"""What a plain heat balance gets wrong on a measured wire temperature, and why: the thermal critic.

    base: one exponential;    against it: latent heat, convection h(T), a second thermal mass, a late sensor

Each extension is fitted jointly with the base under first-order autoregressive noise, judged against nulls of the base
(parametric bootstrap) by the largest gain in the spread of its own null, as everywhere in this folder; what no name
explains is put to smooth functions of time and temperature. Knows no hysteresis and no rig.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.critique import ALPHA, LEAST_SPREAD
from smarig.diagnosis.thermal_fit import WHITE, Fit, Red, extensions, fitted, red_of
from smarig.diagnosis.thermal_record import Transient, transient_of
from smarig.diagnosis.verdict import TEMPERATURE, Verdict
from smarig.errors import UsageError
from smarig.record import Run, load_run

Array = NDArray[np.float64]
NULLS = 200
MOST = 2  # extensions at once
BLOCKS = 6  # held out in turn
GATE = 8.0  # nats: an extension that gains less is not worth its name
NORMAL_95 = 1.96
BLIND = ("wire_lag",)  # τ itself, which the base fits anyway


@dataclass(frozen=True)
class Score:
    """An extension's gain (nats) beside what is already in, its null's median and 95 % point."""

    name: str
    gain: float
    median: float
    high: float

    @property
    def standard(self) -> float:
        """In spreads of its own null."""
        return (self.gain - self.median) / max(self.high - self.median, LEAST_SPREAD)


@dataclass(frozen=True, eq=False)
class Level:
    """All further extensions judged beside what is in: fits by name, scores, threshold of the largest, p."""

    fits: dict[str, Fit]
    scores: tuple[Score, ...]
    threshold: float
    p_value: float

    @property
    def silent(self) -> bool:
        """Whether nothing stands out."""
        return max(s.standard for s in self.scores) <= self.threshold

    @property
    def best(self) -> Score:
        """The one that gains most."""
        return max(self.scores, key=lambda s: s.gain)


@dataclass(frozen=True, eq=False)
class ThermalDiagnosis:
    """What was found on one thermal record. ``base`` and ``extended`` are the fits of least squares, in kelvin.

    ``held_out`` are rms of base and extended on blocks left out in turn, in kelvin.
    """

    verdict: Verdict
    record: Transient
    base: Fit
    extended: Fit
    whitened: Fit
    levels: tuple[Level, ...]
    noise: Red
    held_out: tuple[float, float]
    blind: tuple[str, ...]
    nulls: int
    alpha: float
    seconds: float

    @property
    def p_value(self) -> float:
        """Of the first level."""
        return self.levels[0].p_value

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Fitted values with 95 % intervals under the autoregressive noise; times in the record's unit."""
        unit = {"gain": f"K/({self.record.unit} drive)", "tau": self.record.unit, "lag": self.record.unit}
        unit |= {"dead": self.record.unit, "mass_tau": self.record.unit, "exponent": "1", "mass_share": "1"}
        values = {q: getattr(self.whitened.balance, q) for q in self.whitened.spread}
        return {
            q: {
                "value": v,
                "ci95": [v - NORMAL_95 * self.whitened.spread[q], v + NORMAL_95 * self.whitened.spread[q]],
                "unit": unit.get(q, "K"),
            }
            for q, v in values.items()
        }

    def to_json(self) -> dict[str, Any]:
        """The CLI's JSON object, in the vocabulary of ``Diagnosis``."""
        return {
            "verdict": self.verdict.word,
            "effects": [{"name": n, "probability": self.verdict.probability(n)} for n in self.extended.names],
            "set": list(self.verdict.names),
            "depends_on": self.verdict.depends_on,
            "not_identifiable": list(self.blind),
            "parameters": self.parameters(),
            "error": {
                "unit": "K",
                "noise_floor": self.noise.sigma,
                "base": self.base.rms,
                "extended": self.extended.rms,
            },
            "held_out": {"base": self.held_out[0], "extended": self.held_out[1], "blocks": BLOCKS},
            "alpha": self.alpha,
            "p_value": self.p_value,
            "nulls": self.nulls,
            "seconds": self.seconds,
        }

    def text(self) -> str:
        """What was found, in plain sentences."""
        word, said = self.verdict.word, " and ".join(self.extended.names)
        lines = [
            {
                "named": f"Found: {said}",
                "ambiguous": f"One of a set ({', '.join(self.verdict.names)}), best: {said}",
                "unknown": f"Something is wrong that depends on {self.verdict.depends_on}; no effect known explains it",
            }.get(word, "Nothing stands out")
            + f" (p = {self.p_value:.2g} by {self.nulls} nulls)."
        ]
        lines.append(
            f"Temperature, rms: {self.base.rms:.3g} K by one exponential, {self.extended.rms:.3g} K extended."
        )
        lines.append(
            f"Held out, {BLOCKS} blocks in turn: {self.held_out[0]:.3g} → {self.held_out[1]:.3g} K rms."
        )
        lines += [
            f"  {q} = {v['value']:.4g} [{v['ci95'][0]:.3g}, {v['ci95'][1]:.3g}] {v['unit']}"
            for q, v in self.parameters().items()
        ]
        return "\n".join([*lines, f"These data cannot show: {', '.join(self.blind)}."])


def diagnose_transient(
    run: Run | str | Path,
    *,
    alpha: float = ALPHA,
    nulls: int = NULLS,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> ThermalDiagnosis:
    """What one exponential gets wrong on a run's wire temperature, and which extension explains it.

    The run needs a wire temperature and what heated it (duty cycle, power, current). Raises DataError without them,
    UsageError for settings that make no sense.
    """
    started, say = time.monotonic(), progress or (lambda _: None)
    if not 0 < alpha < 0.5 or nulls < 1 / alpha:
        raise UsageError(f"{nulls} nulls cannot tell a chance of {alpha:g} between 0 and 0.5.")
    x = transient_of(run if isinstance(run, Run) else load_run(run))
    known = [n for n in extensions(x) if n not in without]
    noise = _noise(x, known)
    rng = np.random.default_rng([seed, 0x7EA7])
    levels: list[Level] = []
    names: tuple[str, ...] = ()
    now = fitted(x, (), noise)
    while len(levels) <= MOST:
        left = [n for n in known if n not in names]
        if not left:
            break
        say("against " + (" and ".join(names) or "one exponential"))
        level = _judged(x, now, left, noise, nulls, alpha, rng)
        levels.append(level)
        if level.silent or level.best.gain < GATE or len(names) == MOST:
            break
        now = level.fits[level.best.name]
        names = now.names
    base, extended = fitted(x, (), WHITE), fitted(x, names, WHITE, now.balance) if names else None
    extended = extended or base
    return ThermalDiagnosis(
        _verdict(x, names, levels, now, noise, alpha, nulls, rng),
        x,
        base,
        extended,
        now,
        tuple(levels),
        noise,
        _held_out(x, base, extended),
        (*[n for n in ("latent_heat",) if n not in known and n not in without], *BLIND),
        nulls,
        alpha,
        time.monotonic() - started,
    )


def _noise(x: Transient, known: Sequence[str]) -> Red:
    """Of the richest balance: no hidden effect passes for noise."""
    fit = fitted(x, tuple(known), WHITE) if known else fitted(x, (), WHITE)
    single = [fitted(x, (n,), WHITE) for n in known]
    return red_of(min([fit, *single], key=lambda f: f.square).rest)


def _judged(
    x: Transient,
    now: Fit,
    left: Sequence[str],
    noise: Red,
    nulls: int,
    alpha: float,
    rng: np.random.Generator,
) -> Level:
    fits = {n: fitted(x, (*now.names, n), noise, now.balance) for n in left}
    gains = {n: (now.square - fit.square) / 2 for n, fit in fits.items()}
    calm = now.balance.seen(x)
    by_chance = np.array(
        [_null(x, calm + noise.drawn(x.t.size, rng), now, fits, noise) for _ in range(nulls)]
    )
    scores = []
    standard = np.empty_like(by_chance)
    for k, n in enumerate(left):
        median, high = np.quantile(by_chance[:, k], [0.5, 0.95])
        scores.append(Score(n, gains[n], float(median), float(high)))
        standard[:, k] = (by_chance[:, k] - median) / max(high - median, LEAST_SPREAD)
    largest = np.sort(standard.max(axis=1))
    threshold = float(largest[min(int(np.ceil((nulls + 1) * (1 - alpha))), nulls) - 1])
    seen = max(s.standard for s in scores)
    return Level(fits, tuple(scores), threshold, (1 + int(np.sum(largest >= seen))) / (nulls + 1))


def _null(x: Transient, made: Array, now: Fit, fits: dict[str, Fit], noise: Red) -> list[float]:
    """What each extension gains on a record made without it, (extensions,)."""
    empty = Transient(x.t, made, x.drive, x.room, x.share, x.unit)
    base = fitted(empty, now.names, noise, now.balance, quick=True)
    return [
        max((base.square - fitted(empty, f.names, noise, base.balance, quick=True).square) / 2, 0.0)
        for f in fits.values()
    ]


def _verdict(
    x: Transient,
    names: tuple[str, ...],
    levels: list[Level],
    now: Fit,
    noise: Red,
    alpha: float,
    nulls: int,
    rng: np.random.Generator,
) -> Verdict:
    """Names by their lead over rivals of the same size; a plain variable where no name gains."""
    if not names:
        variable = _variable(x, now, noise, alpha, nulls, rng)
        return Verdict("unknown", depends_on=variable) if variable else Verdict("silent")
    last = levels[len(names) - 1]
    rivals = {fit.names: exp(-(fit.square - now.square) / 2 / TEMPERATURE) for fit in last.fits.values()}
    total = sum(rivals.values())
    ranked = tuple(sorted(((n, w / total) for n, w in rivals.items()), key=lambda item: -item[1]))
    verdict = Verdict("named", ranked)
    return verdict if set(verdict.names) == set(names) else Verdict("ambiguous", ranked)


def _variable(
    x: Transient, now: Fit, noise: Red, alpha: float, nulls: int, rng: np.random.Generator
) -> str | None:
    """Time or temperature, where smooth functions of it explain more than they do on nulls; else None."""
    data = noise.whitened(now.rest)
    made = np.column_stack([noise.whitened(noise.drawn(x.t.size, rng)) for _ in range(nulls)])
    found = {}
    for name, z in (("temperature", now.balance.seen(x)), ("time", x.t)):
        place = (np.argsort(np.argsort(z)) + 0.5) / z.size
        waves = np.cos(np.pi * place[:, None] * np.arange(1, 6))
        q = np.linalg.qr(np.column_stack([noise.whitened(w) for w in waves.T]))[0]
        gain, chance = float(np.sum((q.T @ data) ** 2)) / 2, np.sum((q.T @ made) ** 2, axis=0) / 2
        if gain > max(float(np.quantile(chance, 1 - alpha / 2)), GATE):
            found[name] = gain
    return max(found, key=lambda n: found[n]) if found else None


def _held_out(x: Transient, base: Fit, extended: Fit) -> tuple[float, float]:
    """Rms of both on blocks of the record that were left out in turn, kelvin."""
    block = np.minimum(np.arange(x.t.size) * BLOCKS // x.t.size, BLOCKS - 1)
    squares = []
    for fit in (base, extended):
        errors = [
            fitted(x, fit.names, WHITE, fit.balance, used=block != b, quick=True).rest[block == b]
            for b in range(BLOCKS)
        ]
        squares.append(float(np.sqrt(np.mean(np.concatenate(errors) ** 2))))
    return squares[0], squares[1]
