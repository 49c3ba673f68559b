"""The thermal diagnosis: what a plain heat balance predicts wrongly on a measured wire temperature, and why.

    base: one exponential;    extensions: latent heat, convection h(T), a second thermal mass, a lagging sensor

Each extension is fitted jointly with the base under first-order autoregressive noise. Its gain is compared with its
gains on null data of the base (parametric bootstrap), by the largest scaled gain.
Residuals that no extension explains are tested against smooth functions of time and temperature.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smarig.diagnosis.run_checks import check_settings
from smarig.diagnosis.thermal.thermal_fit import (
    WHITE,
    HeatBalanceFit,
    RedNoise,
    extensions,
    fit_balance,
    red_noise_of,
)
from smarig.diagnosis.thermal.thermal_record import ThermalRecord, thermal_record_of
from smarig.diagnosis.thermal.thermal_verdict import (
    ALPHA,
    LEAD_SCALE_NATS,
    NULLS,
    ThermalVerdict,
)
from smarig.record import Run, load_run

Array = NDArray[np.float64]
MIN_SPREAD_NATS = 1.5  # nats: about the gain of one free strength by chance
MAX_EXTENSIONS = 2  # extensions in one explanation
BLOCKS = 6  # blocks, held out in turn
MIN_GAIN_NATS = 8.0  # nats: least gain of a named extension
NORMAL_95 = 1.96
UNDETECTABLE = ("wire_lag",)  # τ itself, which the base fits anyway


@dataclass(frozen=True)
class ExtensionScore:
    """An extension's gain (nats) over the present fit, and the median and 95 % point of its gains on null data."""

    name: str
    gain: float
    median: float
    high: float

    @property
    def standard(self) -> float:
        """Gain in units of its spread on null data."""
        return (self.gain - self.median) / max(self.high - self.median, MIN_SPREAD_NATS)


@dataclass(frozen=True, eq=False)
class ExtensionLevel:
    """All further extensions compared with the present fit: fits by name, scores, threshold of the largest, p."""

    fits: dict[str, HeatBalanceFit]
    scores: tuple[ExtensionScore, ...]
    threshold: float
    p_value: float

    @property
    def silent(self) -> bool:
        """Whether nothing stands out."""
        return max(s.standard for s in self.scores) <= self.threshold

    @property
    def best(self) -> ExtensionScore:
        """The extension that gains most."""
        return max(self.scores, key=lambda s: s.gain)


@dataclass(frozen=True, eq=False)
class ThermalDiagnosis:
    """The diagnosis of one thermal record. ``base`` and ``extended`` are the least-squares fits, in kelvin.

    ``held_out`` are the rms errors of base and extended fit on blocks held out in turn, in kelvin.
    """

    verdict: ThermalVerdict
    record: ThermalRecord
    base: HeatBalanceFit
    extended: HeatBalanceFit
    whitened: HeatBalanceFit
    levels: tuple[ExtensionLevel, ...]
    noise: RedNoise
    held_out: tuple[float, float]
    undetectable: tuple[str, ...]
    nulls: int
    alpha: float
    seconds: float

    @property
    def p_value(self) -> float:
        """p-value of the first level."""
        return self.levels[0].p_value

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Fitted values with 95 % intervals under the autoregressive noise; times in the unit of the record."""
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
        """The JSON object of the command line, with the keys of ``Diagnosis``."""
        return {
            "verdict": self.verdict.word,
            "effects": [{"name": n, "probability": self.verdict.probability(n)} for n in self.extended.names],
            "set": list(self.verdict.names),
            "depends_on": self.verdict.depends_on,
            "not_identifiable": list(self.undetectable),
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
        """The findings as text."""
        word, effect_names = self.verdict.word, " and ".join(self.extended.names)
        lines = [
            {
                "named": f"Found: {effect_names}",
                "ambiguous": f"Ambiguous, one of {', '.join(self.verdict.names)}; best: {effect_names}",
                "unknown": f"Something is wrong and depends on {self.verdict.depends_on}, but no known effect "
                "explains it",
            }.get(word, "Nothing stands out")
            + f" (p = {self.p_value:.2g} from {self.nulls} null data sets)."
        ]
        lines.append(
            f"Temperature, rms error: {self.base.rms:.3g} K (one exponential), {self.extended.rms:.3g} K (extended)."
        )
        lines.append(
            f"Held-out data, {BLOCKS} blocks in turn: rms error {self.held_out[0]:.3g} → {self.held_out[1]:.3g} K."
        )
        lines += [
            f"  {q} = {v['value']:.4g} [{v['ci95'][0]:.3g}, {v['ci95'][1]:.3g}] {v['unit']}"
            for q, v in self.parameters().items()
        ]
        return "\n".join([*lines, f"Effects that these data cannot show: {', '.join(self.undetectable)}."])


def diagnose_transient(
    run: Run | str | Path,
    *,
    alpha: float = ALPHA,
    nulls: int = NULLS,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> ThermalDiagnosis:
    """Diagnose the wire temperature of a run: which extension explains the error of one exponential.

    The run needs a wire temperature and the drive that heated it (duty cycle, power, current). Raises DataError
    without them, and UsageError for invalid settings.
    """
    started, report_progress = time.monotonic(), progress or (lambda _: None)
    check_settings(alpha, nulls, seed)
    x = thermal_record_of(run if isinstance(run, Run) else load_run(run))
    available = [n for n in extensions(x) if n not in without]
    noise = _noise(x, available)
    rng = np.random.default_rng([seed, 0x7EA7])
    levels: list[ExtensionLevel] = []
    names: tuple[str, ...] = ()
    current = fit_balance(x, (), noise)
    while len(levels) <= MAX_EXTENSIONS:
        remaining = [n for n in available if n not in names]
        if not remaining:
            break
        report_progress("against " + (" and ".join(names) or "one exponential"))
        level = _extension_level(
            x=x, current=current, remaining=remaining, noise=noise, nulls=nulls, alpha=alpha, rng=rng
        )
        levels.append(level)
        if level.silent or level.best.gain < MIN_GAIN_NATS or len(names) == MAX_EXTENSIONS:
            break
        current = level.fits[level.best.name]
        names = current.names
    base, extended = (
        fit_balance(x, (), WHITE),
        fit_balance(x, names, WHITE, current.balance) if names else None,
    )
    extended = extended or base
    return ThermalDiagnosis(
        verdict=_verdict(
            x=x, names=names, levels=levels, current=current, noise=noise, alpha=alpha, nulls=nulls, rng=rng
        ),
        record=x,
        base=base,
        extended=extended,
        whitened=current,
        levels=tuple(levels),
        noise=noise,
        held_out=_held_out(x, base, extended),
        undetectable=(
            *[n for n in ("latent_heat",) if n not in available and n not in without],
            *UNDETECTABLE,
        ),
        nulls=nulls,
        alpha=alpha,
        seconds=time.monotonic() - started,
    )


def _noise(x: ThermalRecord, available: Sequence[str]) -> RedNoise:
    """The noise from the residual of the fullest balance, so that no hidden effect is taken for noise."""
    fit = fit_balance(x, tuple(available), WHITE) if available else fit_balance(x, (), WHITE)
    single = [fit_balance(x, (n,), WHITE) for n in available]
    return red_noise_of(min([fit, *single], key=lambda f: f.chi2).residual)


def _extension_level(
    x: ThermalRecord,
    current: HeatBalanceFit,
    remaining: Sequence[str],
    noise: RedNoise,
    nulls: int,
    alpha: float,
    rng: np.random.Generator,
) -> ExtensionLevel:
    fits = {n: fit_balance(x, (*current.names, n), noise, current.balance) for n in remaining}
    gains = {n: (current.chi2 - fit.chi2) / 2 for n, fit in fits.items()}
    undisturbed = current.balance.predicted_temperature(x)
    by_chance = np.array(
        [_null(x, undisturbed + noise.sampled(x.t.size, rng), current, fits, noise) for _ in range(nulls)]
    )
    scores = []
    standard = np.empty_like(by_chance)
    for k, n in enumerate(remaining):
        median, high = np.quantile(by_chance[:, k], [0.5, 0.95])
        scores.append(ExtensionScore(n, gains[n], float(median), float(high)))
        standard[:, k] = (by_chance[:, k] - median) / max(high - median, MIN_SPREAD_NATS)
    largest = np.sort(standard.max(axis=1))
    threshold = float(largest[min(int(np.ceil((nulls + 1) * (1 - alpha))), nulls) - 1])
    observed_largest = max(s.standard for s in scores)
    return ExtensionLevel(
        fits, tuple(scores), threshold, (1 + int(np.sum(largest >= observed_largest))) / (nulls + 1)
    )


def _null(
    x: ThermalRecord,
    simulated: Array,
    current: HeatBalanceFit,
    fits: dict[str, HeatBalanceFit],
    noise: RedNoise,
) -> list[float]:
    """Gains (extensions,) of each extension on a record simulated without it."""
    null_record = ThermalRecord(x.t, simulated, x.drive, x.room, x.share, x.unit)
    base = fit_balance(null_record, current.names, noise, current.balance, quick=True)
    return [
        max((base.chi2 - fit_balance(null_record, f.names, noise, base.balance, quick=True).chi2) / 2, 0.0)
        for f in fits.values()
    ]


def _verdict(
    x: ThermalRecord,
    names: tuple[str, ...],
    levels: list[ExtensionLevel],
    current: HeatBalanceFit,
    noise: RedNoise,
    alpha: float,
    nulls: int,
    rng: np.random.Generator,
) -> ThermalVerdict:
    """Names by their lead over rivals with the same number of extensions; a plain variable if no name gains."""
    if not names:
        variable = _variable(x, current, noise, alpha, nulls, rng)
        return ThermalVerdict("unknown", depends_on=variable) if variable else ThermalVerdict("silent")
    last = levels[len(names) - 1]
    rivals = {fit.names: exp(-(fit.chi2 - current.chi2) / 2 / LEAD_SCALE_NATS) for fit in last.fits.values()}
    total = sum(rivals.values())
    ranked = tuple(sorted(((n, w / total) for n, w in rivals.items()), key=lambda item: -item[1]))
    verdict = ThermalVerdict("named", ranked)
    return verdict if set(verdict.names) == set(names) else ThermalVerdict("ambiguous", ranked)


def _variable(
    x: ThermalRecord,
    current: HeatBalanceFit,
    noise: RedNoise,
    alpha: float,
    nulls: int,
    rng: np.random.Generator,
) -> str | None:
    """Time or temperature, if smooth functions of it explain more than they do on null data; else None."""
    data = noise.whitened(current.residual)
    simulated = np.column_stack([noise.whitened(noise.sampled(x.t.size, rng)) for _ in range(nulls)])
    found = {}
    for name, z in (("temperature", current.balance.predicted_temperature(x)), ("time", x.t)):
        place = (np.argsort(np.argsort(z)) + 0.5) / z.size
        waves = np.cos(np.pi * place[:, None] * np.arange(1, 6))
        q = np.linalg.qr(np.column_stack([noise.whitened(w) for w in waves.T]))[0]
        gain, chance = float(np.sum((q.T @ data) ** 2)) / 2, np.sum((q.T @ simulated) ** 2, axis=0) / 2
        if gain > max(float(np.quantile(chance, 1 - alpha / 2)), MIN_GAIN_NATS):
            found[name] = gain
    return max(found, key=lambda n: found[n]) if found else None


def _held_out(x: ThermalRecord, base: HeatBalanceFit, extended: HeatBalanceFit) -> tuple[float, float]:
    """Rms errors of both fits on blocks of the record that were held out in turn, kelvin."""
    block = np.minimum(np.arange(x.t.size) * BLOCKS // x.t.size, BLOCKS - 1)
    rms_values = []
    for fit in (base, extended):
        errors = [
            fit_balance(x, fit.names, WHITE, fit.balance, used=block != b, quick=True).residual[block == b]
            for b in range(BLOCKS)
        ]
        rms_values.append(float(np.sqrt(np.mean(np.concatenate(errors) ** 2))))
    return rms_values[0], rms_values[1]
