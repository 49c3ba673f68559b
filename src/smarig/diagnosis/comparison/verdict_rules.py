"""The rules that turn probabilities into a verdict.

Beside them only the priors and the temperature of ``weights.py`` decide a word.

Each rule is a row of ``RULES``: its name, its value, why it is there. ``decide`` asks them in this order:

    nothing can be tested                          not identifiable
    nothing is likely, or an adequate model is not
    wrong for sure, or what is likely is too small
    to tell or less than what it leaves            silent if the model is adequate, else unknown
    a cause is likely, and what competes is not    named, if blocks, design and held-out runs allow a name
    likely causes are several effects              ambiguous: the set
    else                                           unknown, with the variable that the errors go with
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Literal

from smarig.diagnosis.comparison.compared_hypothesis import Part

VerdictWord = Literal["silent", "named", "ambiguous", "unknown", "not_identifiable"]


@dataclass(frozen=True)
class Rule:
    """A number that decides, and why it has this value."""

    value: float
    why: str


RULES = {
    "nothing": Rule(0.5, "the plain model is the likelier half"),
    "name": Rule(
        0.9, "one name of ten may be wrong at this probability, and the curve of reliability says which"
    ),
    "set": Rule(0.9, "the causes of a set hold the truth nine times of ten"),
    "least_size": Rule(
        0.005, "share of the range below which an effect changes nothing that a user would measure"
    ),
    "beside_noise": Rule(
        1.0, "times what a settled reading scatters, where it is known: less is not seen in one reading"
    ),
    "beside_rest": Rule(
        1.0, "times the error that remains where a cause acts: what removes less is one of several causes"
    ),
    "least_blocks": Rule(10, "with fewer excursions, how often they are resampled says little"),
    "replaces_blocks": Rule(
        0.5,
        "of the plain model's error on runs that no fit has seen: such a run tells more than many excursions",
    ),
    "not_determined": Rule(
        0.9, "of the held-out error vanishes with one density for all readings: missing knowledge, no change"
    ),
    "adequate": Rule(3.0, "times the noise, or the limit of prediction: larger errors are seen in a plot"),
    "worse": Rule(
        1.05, "times the error of the plain model on held-out runs: a name must not predict them worse"
    ),
}
SENTENCES = {
    "not_testable": "These data cannot show any effect.",
    "nothing": "No other model predicts blocks that it has not seen so much better that this could not be chance.",
    "too_small": "What is likely changes too little to matter.",
    "inadequate": "No effect and no variable predicts the errors well enough.",
    "fluctuates": "They fluctuate with time as errors of a room temperature do, by more than is noise.",
    "unseen": "The plain model predicts the training runs, but not the held-out runs.",
    "few_blocks": "There are too few excursions for a name.",
    "confounded": "In these data the cause varies together with others.",
    "worse": "With the likeliest cause, the held-out runs are predicted worse.",
    "not_borne_out": "Of the held-out runs' errors, the likeliest cause removes less than it leaves.",
    "left_over": "Beside the likeliest cause, errors go with a variable.",
    "with_others": "The likeliest cause predicts the blocks only together with effects that remove too little.",
    "incomplete": "With the likeliest cause, the errors still go with the variable that it acts through.",
    "beside": "What is likely removes less of the error than it leaves.",
    "likely": "No other cause predicts the blocks as well.",
    "shared": "Several causes predict the blocks about equally well.",
    "variable": "The errors go with this variable, and no effect of the catalogue predicts them as well.",
}


@dataclass(frozen=True)
class VerdictEvidence:
    """What the verdict is decided from.

    ``causes``: probability by part, and ``nothing`` of the plain model. ``size``: what each part removes of the
    left-out error, in the output's unit; ``span``: range of the output. ``error``: of the plain model;
    ``noise``: of one reading; ``remains``: the error that is left where a part acts. ``blocks``: real excursions.
    ``confounded``: parts that these data cannot part from a part. ``held_out``: error on held-out runs with a part over
    that without, where there are such runs. ``repeatability``: what a settled reading scatters, if known.
    ``beyond_limit``: error of the plain model on held-out runs over the limit of prediction, or over the noise if that
    is less; 0 if it is missing knowledge.
    ``together``: probability of each combination of parts; without it, parts are taken to exclude each other.
    ``effects_alone``: probability that effects are enough, without a dependence on a variable beside them; a name needs
    ``least_alone``.
    ``not_borne_out``: parts that explain the training runs, and of held-out runs' large errors less than they leave.
    ``acts_through``: the variables of an effect. ``testable``: whether the data can show any effect.
    """

    causes: Mapping[Part, float]
    nothing: float
    size: Mapping[Part, float]
    span: float
    error: float
    noise: float
    blocks: int
    remains: Mapping[Part, float] = field(default_factory=dict)
    confounded: Mapping[Part, tuple[Part, ...]] = field(default_factory=dict)
    held_out: Mapping[Part, float] = field(default_factory=dict)
    acts_through: Mapping[Part, tuple[Part, ...]] = field(default_factory=dict)
    not_borne_out: frozenset[Part] = frozenset()
    testable: bool = True
    repeatability: float = inf
    beyond_limit: float = 0.0
    together: Mapping[frozenset[Part], float] = field(default_factory=dict)
    effects_alone: float = 1.0
    least_alone: float = 1.0 - RULES["name"].value

    @property
    def least_size(self) -> float:
        """The least size of a cause that is told."""
        return min(RULES["least_size"].value * self.span, RULES["beside_noise"].value * self.repeatability)

    def removes_enough(self, part: Part) -> bool:
        """Whether a cause removes more than remains; a variable need not, if some variable is as likely as a name."""
        variables = sum(p for cause, p in self.causes.items() if cause.kind == "variable")
        describes = part.kind == "variable" and variables >= RULES["name"].value
        return describes or self.size[part] >= self.rest(part)

    def any_of(self, parts: Collection[Part]) -> float:
        """The probability that at least one of some parts acts."""
        if not self.together:
            return min(sum(self.causes.get(p, 0.0) for p in parts), 1.0 - self.nothing)
        return sum(w for held, w in self.together.items() if not held.isdisjoint(parts))

    def with_others(self, sure: Collection[Part], likely: Collection[Part]) -> float:
        """The share of combinations with ``sure`` parts that hold an effect that is not ``likely`` to be told."""
        held = {parts: w for parts, w in self.together.items() if not parts.isdisjoint(sure)}
        effects = {p for p in self.causes if p.kind == "effect" and self.size[p] >= self.least_size}
        with_others = sum(w for parts, w in held.items() if not parts.isdisjoint(effects.difference(likely)))
        return with_others / sum(held.values()) if with_others else 0.0

    def refuted(self, part: Part) -> str:
        """How held-out runs speak against a cause, a key of ``SENTENCES``; "" if they do not."""
        if self.held_out.get(part, 0.0) > RULES["worse"].value:
            return "worse"
        return "not_borne_out" if part in self.not_borne_out else ""

    def rest(self, part: Part) -> float:
        """The size below which a cause removes less than it leaves."""
        return RULES["beside_rest"].value * self.remains.get(part, 0.0)

    @property
    def adequate(self) -> bool:
        """Whether the plain model misses the readings by hardly more than noise, or by what is not told."""
        return self.error <= max(RULES["adequate"].value * self.noise, self.least_size)


@dataclass(frozen=True)
class Verdict:
    """``word``; the ``names`` of the effects (the set, if ambiguous); the variable; and the key of ``SENTENCES``."""

    word: VerdictWord
    reason: str
    names: tuple[str, ...] = ()
    depends_on: str | None = None

    @property
    def stands_out(self) -> bool:
        """Whether the errors are more than noise."""
        return self.word not in ("silent", "not_identifiable")


def decide(e: VerdictEvidence) -> Verdict:
    """The verdict on a comparison of hypotheses."""
    if not e.testable:
        return Verdict("not_identifiable", "not_testable")
    large = [p for p in e.causes if e.size[p] >= e.least_size]
    if e.nothing >= (1 - RULES["name"].value if e.adequate else RULES["nothing"].value):
        return _nothing(e, "nothing")  # an adequate model is called wrong with the certainty of a name only
    if e.any_of(large) < 1 - RULES["nothing"].value:
        return _nothing(e, "too_small")
    enough = [p for p in large if e.removes_enough(p)]
    if not enough:
        return _nothing(e, "beside")
    likely = [p for p in enough if e.causes[p] >= RULES["name"].value]
    effects = [p for p in likely if p.kind == "effect"]
    doubts = {p: _doubt(e, p) for p in effects}
    sure = [p for p in effects if not doubts[p]]
    if sure and e.with_others(sure, effects) > RULES["name"].value:  # they are needed
        return _set(e, enough, "with_others")
    if sure:
        return Verdict("named", "likely", tuple(p.name for p in sure))
    return _set(e, enough, next((d for d in doubts.values() if d), e.refuted(enough[0])))


def _nothing(e: VerdictEvidence, reason: str) -> Verdict:
    if not e.adequate:
        why = reason if reason == "beside" else "inadequate"
        nothing = e.nothing >= RULES["nothing"].value
        return Verdict("unknown", why, depends_on=None if nothing else _likeliest_variable(e))
    if e.beyond_limit > RULES["adequate"].value:
        return Verdict("unknown", "unseen")
    return Verdict("silent", reason)


def _likeliest_variable(e: VerdictEvidence) -> str | None:
    return next((p.name for p in e.causes if p.kind == "variable"), None)


def _doubt(e: VerdictEvidence, part: Part) -> str:
    """Why a likely effect is no name, or nothing."""
    seen = e.held_out.get(part, 1.0) <= RULES["replaces_blocks"].value
    if e.blocks < RULES["least_blocks"].value and not seen:
        return "few_blocks"
    if e.confounded.get(part):
        return "confounded"
    if e.effects_alone < e.least_alone and not seen:
        return "left_over"
    if e.refuted(part):
        return e.refuted(part)
    through = [v for v in e.acts_through.get(part, ()) if e.size.get(v, 0.0) >= e.least_size]
    if any(e.causes[v] >= RULES["name"].value for v in through):
        return "incomplete"
    return ""


def _set(e: VerdictEvidence, enough: list[Part], doubt: str) -> Verdict:
    """The smallest set of causes that holds the truth with the probability of the rule; none does: unknown."""
    kept: list[Part] = []
    least = RULES["set"].value * (1.0 - e.nothing)
    for part in enough:  # likeliest first
        if e.any_of(kept) >= least:
            break
        kept += [q for q in (part, *e.confounded.get(part, ())) if q not in kept]
    names = tuple(p.name for p in kept if p.kind == "effect")
    variables = [p.name for p in kept if p.kind == "variable"]
    if (
        doubt in ("worse", "not_borne_out", "left_over", "with_others")
        or not names
        or variables
        or e.any_of(kept) < least
    ):
        depends_on = variables[0] if variables else _likeliest_variable(e)
        return Verdict("unknown", doubt or ("shared" if names else "variable"), names, depends_on)
    if len(names) == 1:  # no set: what it acts through is all that these data say
        through = max(e.acts_through.get(kept[0], ()), key=lambda v: e.causes.get(v, 0.0), default=None)
        return Verdict("unknown", doubt or "shared", names, through.name if through else None)
    return Verdict("ambiguous", doubt or "shared", names)
