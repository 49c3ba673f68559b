"""What can be certified of a hysteresis before a loop is closed around it: chapter 8 asked of one model.

Classes (Def. 4.1), dissipativity, the storage and its bias from u(0) = 0 (Thm 8.1), Thm 8.2 for every velocity
controller asked for, and how far all that reaches (``scope``). A number that no theorem gives is None. Refuses to
know where a model came from.
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from smarig.catalogue import find, names
from smarig.control.examined import Examined
from smarig.control.hypothesis import Hypothesis, all_hold, coverage, failing
from smarig.control.passivity import Breaking, breaking
from smarig.control.scope import (
    FINDINGS,
    Limit,
    Proved,
    k_e_units,
    limits,
    position_controllers,
    scheduling,
)
from smarig.control.settings import TRACKING, VELOCITY, given
from smarig.control.storage import Storage, storage
from smarig.control.units import Units, said
from smarig.control.velocity.stability import Stability, ground, stability_on
from smarig.errors import UsageError
from smarig.preisach.energy.certificate import Certificate as Dissipativity
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach
from smarig.preisach.properties.classes import Classes

_ROUNDING = 1e-9  # of the largest, as in the classes


@dataclass(frozen=True)
class Judged:
    """One velocity controller: its numbers, and what Thm 8.2 says of the loop with it."""

    name: str
    numbers: dict[str, float]
    stability: Stability

    @property
    def k_e(self) -> float | None:
        """The bound of Thm 8.2; None where it does not hold, or is not known to."""
        return self.stability.k_e if self.stability.holds else None

    @property
    def coverage(self) -> str:
        """Whether Thm 8.2 covers the loop, and which hypotheses are in the way."""
        return coverage(self.stability.hypotheses)

    @property
    def text(self) -> str:
        """One line: δ and γ with their unit, and k_e where it is proved."""
        s, unit = self.stability, self.stability.units.gain
        bound = f"k_e {self.coverage}" if self.k_e is None else f"k_e = {self.k_e:.4g}"
        return f"{self.name}: δ = {said(s.delta, unit)}, γ = {said(s.gamma, unit)}, {bound}."


@dataclass(frozen=True)
class Certificate:
    """Of one hysteresis, from the state ``initial`` at u(0) = 0.

    ``dissipativity`` is None where it cannot be decided for this kind, ``undecided`` says why; ``breaking`` is an input
    that takes energy out in every cycle, where there is one.
    """

    initial: Initial
    classes: Classes
    dissipativity: Dissipativity | None
    undecided: str
    storage: Storage
    breaking: Breaking | None
    controllers: tuple[Judged, ...]
    proved: Proved

    @property
    def units(self) -> Units:
        """Of the hysteresis."""
        return self.proved.units

    @property
    def limits(self) -> tuple[Limit, ...]:
        """How far it reaches: the same list for text, page and JSON."""
        return limits(self.proved)

    @property
    def passive(self) -> bool | None:
        """Whether the supplied energy is bounded below by a theorem; None where nothing could be decided."""
        if self.storage.ground == "none":
            return False
        return True if self.storage.proved else None

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Those of Thm 8.1."""
        return self.storage.hypotheses

    @property
    def verdict(self) -> str:
        """Passive or not, and by what bias, in a sentence."""
        s = self.storage
        bias = said(s.energy, s.unit)
        if s.ground == "none":
            return "Not passive: some input takes more energy out of this model than was ever put in."
        if s.ground == "undecided":
            return "Not decided: no bound of the supplied energy is known for this model."
        ground = {
            "positive": "neither μ nor g is negative, Thm 8.1",
            "recoverable": "Q_r is proved a storage function, although μ or g is negative somewhere",
            "dissipative": "no loop gives energy back, although μ or g is negative somewhere",
        }[s.ground]
        if not s.proved:
            return f"Dissipative ({ground}), but its bias is known from below only: at least {bias}."
        if s.energy == 0.0:
            return f"Passive without bias: from u(0) = 0 the supplied energy is never negative ({ground})."
        return f"Passive with a bias of {bias} from u(0) = 0 ({ground})."

    @property
    def scheduling(self) -> str:
        """What is certified of gains on a schedule."""
        return scheduling(self.proved)

    @property
    def position_controllers(self) -> str:
        """What is certified of the position controllers of §9.2."""
        return position_controllers(self.proved)

    @property
    def reasons(self) -> tuple[Hypothesis, ...]:
        """What Thm 8.2 asks of the model and does not get, whichever the controller."""
        first = self.controllers[0].stability.hypotheses if self.controllers else ()
        return tuple(h for h in failing(first) if not h.name.startswith("H₁"))

    @property
    def text(self) -> str:
        """All of it, for a person."""
        c = self.classes
        lines = [
            self.verdict,
            f"Classes of the density μ: M_PC {_word(c.M_PC)}, M_P {_word(c.M_P)}; reversible part g ≥ 0: "
            f"{_word(self.g_not_negative)}.",
            *(f"Of μ and g together, {h.text}" for h in self.hypotheses if h.name == "ν ≥ 0" and not h.holds),
            self.dissipativity.text
            if self.dissipativity
            else f"Dissipativity is not decided. {self.undecided}",
            *([self.counter_example] if self.breaking else []),
            self.loops,
            *(f"  {judged.text}" for judged in self.controllers),
            self.scheduling,
            self.position_controllers,
            "Limits:",
            *(f"  {limit.text}" for limit in self.limits),
            f"  (see {FINDINGS})",
        ]
        return "\n".join(lines)

    @property
    def g_not_negative(self) -> bool:
        """g ≥ 0, which no class asks for and the theorems need."""
        least, largest = self.classes.g_min.value, self.classes.g_max.value
        return not least < -_ROUNDING * max(abs(least), abs(largest))

    @property
    def loops(self) -> str:
        """What Thm 8.2 says of velocity feedback with this model, in a sentence or two."""
        if not self.reasons:
            return "Velocity feedback without delay: ‖ė‖ ≤ k_e (‖ṙ‖ + ‖u_o‖) up to every T (Thm 8.2)."
        lacking = "does not cover it" if self.proved.covered is False else "is not known to cover it"
        return f"Velocity feedback: Thm 8.2 {lacking}. " + " ".join(h.text for h in self.reasons)

    @property
    def counter_example(self) -> str:
        """The input that breaks passivity."""
        if self.breaking is None:
            return ""
        v = self.breaking.violation
        _, low, high = v.way.tolist()
        unit = self.units.input
        return (
            f"Drive it from {said(v.way[0], unit)} to {said(low, unit)}, then between {high:.4g} and "
            f"{said(low, unit)}: every cycle gives back {said(-v.per_cycle, self.storage.unit)}, and after "
            f"{self.breaking.cycles_below(0.0)} cycles more came out than went in."
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values; infinite and undecided energies are None."""
        c, s = self.classes, self.storage
        return {
            "passive": self.passive,
            "verdict": self.verdict,
            "classes": {
                "M_PC": c.M_PC,
                "M_P": c.M_P,
                "g_not_negative": self.g_not_negative,
                "positive": c.positive,
            },
            "mu_min": {"value": c.mu_min.value, "at": c.mu_min.at},
            "g_min": {"value": c.g_min.value, "at": c.g_min.at},
            "dissipativity": asdict(self.dissipativity) | {"text": self.dissipativity.text}
            if self.dissipativity
            else {"dissipative": None, "text": self.undecided},
            "units": {
                "output": self.units.output,
                "input": self.units.input,
                "gain": self.units.gain,
                "k_e": k_e_units(self.units),
            },
            "storage": {"ground": s.ground, "proved": s.proved, "bias": s.energy, "unit": s.unit},
            "hypotheses": _plain(self.hypotheses),
            "initial": self.initial,
            "controllers": [
                {"name": j.name, "numbers": j.numbers, "holds": j.stability.holds, "coverage": j.coverage}
                | {"delta": j.stability.delta, "gamma": j.stability.gamma, "k_e": j.k_e}
                | {"stored": j.stability.stored, "hypotheses": _plain(j.stability.hypotheses)}
                for j in self.controllers
            ],
            "breaking": self.breaking
            and {
                "way": self.breaking.violation.way.tolist(),
                "per_cycle": self.breaking.violation.per_cycle,
                "cycles_until_negative": self.breaking.cycles_below(0.0),
            },
            "gain_scheduling": self.scheduling,
            "position_controllers": self.position_controllers,
            "limits": [asdict(limit) for limit in self.limits],
        }


def certificate(
    hysteresis: Everett,
    controllers: Mapping[str, Mapping[str, Any]] | None = None,
    units: Units | None = None,
) -> Certificate:
    """Certify a hysteresis, with velocity controllers by name and the numbers that are not their defaults.

    ``controllers``: the whole catalogue where it is None; UsageError for one that feeds back the position.
    ``units``: the hysteresis's own where none are given.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> found = certificate(surface("one_e"), {"constant_gain": {"gain": 4.0}})
    >>> found.passive, found.classes.M_P, found.controllers[0].k_e
    (True, False, 2.0)
    >>> certificate(surface("two_p"), {"constant_gain": {"gain": 4.0}}).controllers[0].k_e is None
    True
    """
    wanted = {name: {} for name in names(VELOCITY)} if controllers is None else controllers
    _check(wanted)
    chosen = {name: given(VELOCITY, name, pairs) for name, pairs in wanted.items()}
    made = {name: find(VELOCITY, name)(**numbers) for name, numbers in chosen.items()}
    examined = Examined.of(hysteresis, units)
    initial = initial_of(examined.hysteresis)
    stored = storage(examined, Preisach(examined.hysteresis, initial).state)
    of_model = ground(examined, initial, stored)
    return Certificate(
        initial,
        examined.classes,
        examined.dissipativity,
        examined.undecided,
        stored,
        _breaking(examined, initial),
        tuple(Judged(name, chosen[name], stability_on(of_model, made[name])) for name in made),
        Proved(stored.ground, examined.monotone.holds, all_hold(of_model.hypotheses), examined.units),
    )


def _check(wanted: Iterable[str]) -> None:
    """A position loop is no mistake of spelling."""
    for name in wanted:
        if name in names(TRACKING):
            raise UsageError(
                f"'{name}' is a position loop (of smarig track and regulate), which Thm 8.2 does not cover: certify "
                f"takes {', '.join(names(VELOCITY))}; what is known of position loops is in {FINDINGS}."
            )


def initial_of(hysteresis: Everett) -> Initial:
    """The state at u(0) = 0: cold for a wire on one side of zero, B* for two."""
    return "negative" if hysteresis.lower >= 0 else "anhysteretic"


def _breaking(examined: Examined, initial: Initial) -> Breaking | None:
    try:
        return breaking(examined, initial)
    except (
        UsageError
    ):  # there is none, or its loop is too small to repay the approach in as many cycles as are tried
        return None


def _plain(hypotheses: tuple[Hypothesis, ...]) -> list[dict[str, Any]]:
    return [asdict(h) for h in hypotheses]


def _word(holds: bool) -> str:
    return "yes" if holds else "no"
