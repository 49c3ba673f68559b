"""The gates that the name of an effect must pass, besides a likelihood beyond noise.

A name needs values inside their bounds with an interval that excludes "no effect", a larger gain than any flexible
discrepancy, nothing left that a discrepancy explains, and held-out runs that bear it out. Otherwise the finding is the
variable on which the errors depend.

Where the model misses held-out runs by many times their noise even with the effects, its operator is wrong, and what an
effect seems to explain may be a part of that. There an effect is a candidate only by evidence of its own
(``own_evidence``), and without evidence of their own for all of them none is named.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from smarig.core import chi2_quantile
from smarig.diagnosis.diagnosis_verdict import DiagnosisVerdict, VerdictWord
from smarig.diagnosis.explain.channel_misfit import ChannelMisfit
from smarig.diagnosis.explain.discrepancy import Discrepancy
from smarig.diagnosis.explain.explanation import SD_INFLATION
from smarig.diagnosis.explain.search import SearchLevel
from smarig.diagnosis.explain.separate_evidence import SeparateEvidence
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.noise_terms import PREDICTION_LIMIT, REMAINING_SCATTER
from smarig.diagnosis.own_evidence import own_evidence_failure
from smarig.diagnosis.variable_words import variable_words
from smarig.plant import Effect

DISCREPANCY_NATS = 25.0  # gain of a discrepancy that noise alone does not reach
LEAD_NATS = 10.0  # by which effects must be likelier than a discrepancy, which fits anything
FITTED_RATIO = (
    0.9  # of the error of settled positions without the effects: less promises a gain on held-out runs
)
FITTED_WORSE = 1.1  # of the same error: without held-out runs, nothing bears such a name out
REMAINING_SHARE = 0.15  # of the effects' gain: a discrepancy that explains more of what is left refutes them
CLEAR_NATS = 100.0  # the same if the room moves: both vanish in saturation, and imitate each other
ROOM_K, ROOM_S = 0.22, 300.0  # larger and slower fluctuations are no draught
SILENT_RATIO = 5.0  # of the error to all noise: up to 2.3 on sealed boxes without a visible effect
CHANNEL_MISFIT = (
    1.3  # rms in units of a channel's noise: more is left than noise, whatever the estimate of it
)
DECISIVE_SHARE = 0.3  # of the effects' gain: a channel that gives more carries the name
AT_BOUND_SHARE = 1e-3  # of the range between a parameter's bounds: at least this far from them
NORMAL_95 = 1.96
WORSE = 1.1  # times the base model's error on held-out runs: worse whatever the choice of blocks
CERTAINLY_WORSE = 1.02  # the same if no choice of blocks is better: less is a density's chance
REMOVABLE = 1.2  # times the floor: a smaller error on held-out runs leaves nothing to remove
LEAST_SHARE, POSSIBLE_SHARE = 0.5, 0.7  # R on held-out runs and its upper limit: both below, R is too small
BORNE_OUT = (
    0.85,
    0.7,
)  # R on held-out runs, and its lower limit: such a name stands although a variable explains more


@dataclass(frozen=True)
class GatedVerdict:
    """A verdict after the gates, with one clause on why an effect is not named."""

    verdict: DiagnosisVerdict
    reason: str = ""


@dataclass(frozen=True, eq=False)
class NameEvidence:
    """What the gates are decided on.

    ``levels`` are those of the search, ``effect_nats`` the gain of the best effects over none. ``before`` and ``after``
    are the likeliest discrepancies without and with them; ``gain`` is that on held-out runs. ``fitted_ratio`` is the
    rms error of the training runs' settled positions with the effects over that without. ``alarm``: whether hardly any
    wire without an effect shows as much. ``times_noise`` is the rms error without effects, in units of all noise.
    ``channels`` are the misfits of the channels besides the position. ``separate`` is the evidence of each effect by
    itself, computed if the operator fails.
    """

    levels: tuple[SearchLevel, ...]
    effect_nats: float
    before: Discrepancy
    after: Discrepancy | None
    gain: HeldOutGain | None
    fitted_ratio: float
    alarm: bool
    times_noise: float = 1.0
    channels: tuple[ChannelMisfit, ...] = ()
    separate: tuple[SeparateEvidence, ...] = ()

    @property
    def misses_by(self) -> float:
        """The error that the effects leave, in units of what noise and an uncertain density leave."""
        if self.gain is None:
            return self.fitted_ratio * self.times_noise
        return self.gain.extended / self.gain.floor

    @property
    def wrong(self) -> bool:
        """Whether the model misses training runs without and held-out runs with the effects by many times the noise.

        Held-out runs alone may need a part of the density that the training runs do not determine.
        """
        return self.misses_by >= SILENT_RATIO and self.times_noise >= SILENT_RATIO

    @property
    def operator_fails(self) -> bool:
        """Whether the model stays wrong, or minor loops do not return without the effects."""
        return self.wrong or (self.before.not_preisach and self.before.gain >= DISCREPANCY_NATS)

    @property
    def decisive_channel(self) -> ChannelMisfit | None:
        """The channel besides the position that carries the name, or None."""
        largest = max(self.channels, key=lambda c: c.nats, default=None)
        return largest if largest and largest.nats > DECISIVE_SHARE * self.effect_nats else None


def gated(verdict: DiagnosisVerdict, evidence: NameEvidence) -> GatedVerdict:
    """The verdict with names that passed all gates only.

    Effects without evidence of their own are no candidates either where the model stays wrong, or where minor loops do
    not return and another gate refused the name.
    """
    found = _by_gates(verdict, evidence)
    if not found.verdict.explanations or not evidence.separate:
        return found
    named = found.verdict.word != "unknown"
    if named and not evidence.wrong:
        return found
    failed = {s.effect.kind.name: why for s in evidence.separate if (why := _without_own(s, evidence))}
    if named and not failed and (_borne_out(evidence.gain) or evidence.decisive_channel):
        return found
    names = tuple(s.effect.kind.name for s in evidence.separate if s.effect.kind.name not in failed)
    variable = _variable(verdict, evidence)
    reason = found.reason or next(iter(failed.values()), "") or _still_wrong(verdict, evidence)
    return GatedVerdict(replace(_unknown(found.verdict, variable), compatible=names), reason)


def _still_wrong(verdict: DiagnosisVerdict, evidence: NameEvidence) -> str:
    names, times = " + ".join(verdict.explanations[0][0]), f"{evidence.misses_by:.0f} ×"
    if evidence.gain is None:
        return f"with {names}, the model still misses the training runs by {times} their {REMAINING_SCATTER}"
    floor = f"the {PREDICTION_LIMIT}"
    return f"with {names}, the model still misses the held-out runs by {times} {floor}"


def _without_own(one: SeparateEvidence, evidence: NameEvidence) -> str:
    """Why an effect is no candidate beside a model that is wrong, or nothing."""
    share = evidence.gain.removable_share if evidence.gain else None
    return next(_failures_of(one.effect, evidence.levels[-1]), "") or own_evidence_failure(one, share)


def _by_gates(verdict: DiagnosisVerdict, evidence: NameEvidence) -> GatedVerdict:
    """The verdict after the gates for all effects together."""
    if verdict.word in ("silent", "not_identifiable"):
        return _if_adequate(verdict, evidence)
    if not verdict.explanations:
        return GatedVerdict(verdict)
    names = " + ".join(verdict.explanations[0][0])
    if not evidence.alarm and not _borne_out(evidence.gain):
        reason = f"{names} explains more than null data do, but not more than wires without an effect show"
        quiet = _if_adequate(DiagnosisVerdict("silent"), evidence).verdict
        unknown = quiet.word == "unknown"
        return GatedVerdict(_unknown(verdict, quiet.depends_on) if unknown else quiet, reason)
    reason = next(_failures(names, evidence), "")
    if reason:
        return GatedVerdict(_unknown(verdict, _variable(verdict, evidence)), reason)
    if verdict.word == "unknown" and _borne_out(evidence.gain):
        return GatedVerdict(replace(verdict, word=_word(verdict), depends_on=None))
    return GatedVerdict(verdict)


def slow_room(found: Discrepancy) -> bool:
    """Whether what is taken for noise is a slow change of temperature, more than a draught."""
    return found.room_K >= ROOM_K and found.correlation_s >= ROOM_S


def _if_adequate(verdict: DiagnosisVerdict, evidence: NameEvidence) -> GatedVerdict:
    """Silence, unless a discrepancy stands out, the room moves too much, or the error is many times the noise."""
    before = evidence.before
    if before.gain >= (CLEAR_NATS if slow_room(before) else DISCREPANCY_NATS):
        return GatedVerdict(_unknown(verdict, before.depends_on))
    if slow_room(before):
        reason = (
            f"what would pass for noise is a fluctuation of the wire's temperature by {before.room_K:.2g} K over "
            f"{before.correlation_s:.0f} s and longer, more than a draught"
        )
        return GatedVerdict(_unknown(verdict, "time"), reason)
    if evidence.times_noise >= SILENT_RATIO:
        reason = f"the model misses these runs by {evidence.times_noise:.0f} × their {REMAINING_SCATTER}"
        return GatedVerdict(_unknown(verdict, before.depends_on or None), reason)
    return GatedVerdict(verdict)


def _failures(names: str, evidence: NameEvidence) -> Iterator[str]:
    """Why a name is not given, one clause per failed gate."""
    yield from _parameter_failures(evidence.levels[-1])
    before, after = evidence.before, evidence.after
    if before.gain > max(evidence.effect_nats - LEAD_NATS, DISCREPANCY_NATS - LEAD_NATS):
        yield f"a dependence on {variable_words(before.depends_on)} explains more than {names}"
    if after is not None and after.gain > max(DISCREPANCY_NATS, REMAINING_SHARE * evidence.effect_nats):
        yield f"with {names}, the errors still depend on {variable_words(after.depends_on)}"
    channel = evidence.decisive_channel
    if channel and channel.after > CHANNEL_MISFIT * channel.expected:
        yield f"with {names}, the {channel.channel} still misses by {channel.after:.1f} × its noise"
    yield from _held_out_failures(names, evidence)


def _held_out_failures(names: str, evidence: NameEvidence) -> Iterator[str]:
    """Held-out runs that the effects predict worse, or hardly better although they fit the training runs better.

    Effects that another channel shows need not change the error of positions: a density makes up for them there.
    """
    gain = evidence.gain
    if gain is None:
        if evidence.fitted_ratio > FITTED_WORSE and not evidence.decisive_channel:
            yield f"with {names}, the training runs are missed by more than without"
        return
    share, interval = gain.removable_share, gain.interval()
    beyond_chance = interval is not None and interval[1] < 0
    if gain.extended > (CERTAINLY_WORSE if beyond_chance else WORSE) * max(gain.base, gain.floor):
        yield f"{names} fits the training runs but predicts the held-out runs worse"
    if share is None or evidence.decisive_channel or gain.base <= REMOVABLE * gain.floor:
        return
    may_be_large = interval is None or interval[1] >= POSSIBLE_SHARE
    too_small = evidence.fitted_ratio < FITTED_RATIO and share < LEAST_SHARE and not may_be_large
    if too_small or share <= 0:
        yield f"the held-out runs do not bear out {names} (R = {share:.2f})"


def _parameter_failures(level: SearchLevel) -> Iterator[str]:
    """Strengths within a standard deviation of a bound, or with an interval that contains no effect."""
    for effect in level.best.effects:
        yield from _failures_of(effect, level)


def _failures_of(effect: Effect, level: SearchLevel) -> Iterator[str]:
    kind, strength = effect.kind, effect.strength
    p = kind.primary
    near = max(AT_BOUND_SHARE * (p.upper - p.lower), level.best.spread.get((kind.name, p.name), 0.0))
    if p.upper - strength < near or (p.lower != 0 and strength - p.lower < near):
        yield f"the {p.name} of {kind.name} lies at the bound of its search"
    if _may_be_absent(effect, level):
        yield f"the interval of {kind.name} contains no effect"


def _may_be_absent(effect: Effect, level: SearchLevel) -> bool:
    """Whether the 95 % region of an effect's parameters contains no effect.

    Of one parameter, its interval decides. Of several, that of the strength may be wide only because another could make
    up for it (a swing with a longer period has the same slope): then the likelihood without any effect decides.
    """
    kind = effect.kind
    spread = level.best.spread.get((kind.name, kind.primary.name))
    if spread is None or abs(effect.strength) > NORMAL_95 * spread:
        return False
    parameters = sum(name == kind.name for name, _ in level.best.spread)
    return parameters < 2 or 2 * level.gain / SD_INFLATION**2 <= chi2_quantile(0.95, parameters)


def _borne_out(gain: HeldOutGain | None) -> bool:
    """Whether held-out runs bear out the effects beyond doubt."""
    if gain is None:
        return False
    share, interval = gain.removable_share, gain.interval()
    return (
        share is not None
        and interval is not None
        and gain.base > REMOVABLE * gain.floor
        and share >= BORNE_OUT[0]
        and interval[0] >= BORNE_OUT[1]
    )


def _variable(verdict: DiagnosisVerdict, evidence: NameEvidence) -> str | None:
    """The variable of an unnamed finding: that of the critique, else that of the discrepancy."""
    own = evidence.before if evidence.before.gain >= DISCREPANCY_NATS else evidence.after
    if own is not None and own.gain >= DISCREPANCY_NATS:
        return own.depends_on
    return verdict.depends_on or (
        "time" if slow_room(evidence.before) else evidence.before.depends_on or None
    )


def _word(verdict: DiagnosisVerdict) -> VerdictWord:
    return "named" if set(verdict.names) == set(verdict.explanations[0][0]) else "ambiguous"


def _unknown(verdict: DiagnosisVerdict, variable: str | None) -> DiagnosisVerdict:
    return DiagnosisVerdict("unknown", verdict.explanations, variable)
