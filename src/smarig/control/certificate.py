"""What can be certified of a hysteresis before a loop is closed around it: chapter 8 asked of one model.

Classes (Def. 4.1), dissipativity, the storage and its bias from u(0) = 0 (Thm 8.1), Thm 8.2 for every velocity
controller asked for, what is left of it for gains on a schedule, and the position controllers of §9.2. It speaks of
the hysteresis alone: heating, delay, quantum and effects are not in it (docs/explanation/control_findings.md).
Refuses to know where a model came from.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from smarig.catalogue import find, names
from smarig.control.hypothesis import Hypothesis, failing
from smarig.control.passivity import Breaking, breaking
from smarig.control.settings import VELOCITY, given
from smarig.control.storage import Storage, storage
from smarig.control.velocity.stability import Stability, ground, stability_on
from smarig.errors import UsageError
from smarig.preisach.energy import certify
from smarig.preisach.energy.certificate import Certificate as Dissipativity
from smarig.preisach.everett import Everett
from smarig.preisach.operator import Initial, Preisach
from smarig.preisach.properties.classes import Classes, classes

POSITION = (
    "Position controllers of §9.2: a Preisach model is dissipative to ⟨u, ẏ⟩ − b²⟨y, y⟩ for b = 0 only, so the strict "
    "class (a, c ≠ 0) is empty; the marginal one (a = b = c = 0) holds the controllers whose K(s)/s is positive real "
    "(proportional, with derivative, lead), and bounds the energy without saying that y arrives at r."
)


_ROUNDING = 1e-9  # of the largest, as in the classes


@dataclass(frozen=True)
class Judged:
    """One velocity controller: its numbers, and what Thm 8.2 says of the loop with it."""

    name: str
    numbers: dict[str, float]
    stability: Stability


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
        bias = f"{s.energy:.4g} {s.unit}".rstrip()
        if s.ground == "none":
            return "Not passive: some input takes more energy out of this model than was ever put in."
        if s.ground == "undecided":
            return "Not decided: no bound of the supplied energy is known for this model."
        ground = {
            "positive": "ν ≥ 0, Thm 8.1",
            "recoverable": "Q_r is proved a storage function, although ν is negative somewhere",
            "dissipative": "no loop gives energy back, although ν is negative somewhere",
        }[s.ground]
        if not s.proved:
            return f"Dissipative ({ground}), but its bias is known from below only: at least {bias}."
        if s.energy == 0.0:
            return f"Passive without bias: from u(0) = 0 the supplied energy is never negative ({ground})."
        return f"Passive with a bias of {bias} from u(0) = 0 ({ground})."

    @property
    def scheduling(self) -> str:
        """What is certified of gains on a schedule."""
        velocity = "Gain scheduling as velocity feedback: δ is the least gain and γ the largest, whatever it looks at"
        if self.passive is not True or self.reasons:
            return (
                f"{velocity}; but Thm 8.2 asks more of the model than it has, so there is no bound with it."
            )
        return (
            f"{velocity}, so Thm 8.2 covers it. As position feedback, V = Q_r(B) + Φ(e) never rises for gains that are "
            "switched by the error alone, without a tick of delay and for a constant reference: the energy is bounded, "
            "and no more."
        )

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
            f"Classes: M_PC {_word(c.M_PC)}, M_P {_word(c.M_P)}, g ≥ 0 {_word(self.g_not_negative)}.",
            self.dissipativity.text
            if self.dissipativity
            else f"Dissipativity is not decided. {self.undecided}",
            *(h.text for h in self.hypotheses if h.name == "ν ≥ 0" and not h.holds),
            *([self.counter_example] if self.breaking else []),
            self.loops,
            *(f"  {_of(judged)}" for judged in self.controllers),
            self.scheduling,
            POSITION,
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
        return "Velocity feedback: Thm 8.2 does not cover it. " + " ".join(h.text for h in self.reasons)

    @property
    def counter_example(self) -> str:
        """The input that breaks passivity."""
        if self.breaking is None:
            return ""
        v = self.breaking.violation
        _, low, high = v.way.tolist()
        unit = f" {self.storage.unit}".rstrip()
        return (
            f"Drive it from {v.way[0]:.4g} K to {low:.4g} K, then between {high:.4g} and {low:.4g} K: every cycle "
            f"gives back {-v.per_cycle:.4g}{unit}, and after {self.breaking.cycles_below(0.0)} cycles more came out "
            "than went in."
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
            "storage": {"ground": s.ground, "proved": s.proved, "bias": s.energy, "unit": s.unit},
            "hypotheses": _plain(self.hypotheses),
            "initial": self.initial,
            "controllers": [
                {"name": j.name, "numbers": j.numbers, "holds": j.stability.holds}
                | {key: getattr(j.stability, key) for key in ("delta", "gamma", "k_e", "stored")}
                | {"hypotheses": _plain(j.stability.hypotheses)}
                for j in self.controllers
            ],
            "breaking": self.breaking
            and {
                "way": self.breaking.violation.way.tolist(),
                "per_cycle": self.breaking.violation.per_cycle,
                "cycles_until_negative": self.breaking.cycles_below(0.0),
            },
            "gain_scheduling": self.scheduling,
            "position_controllers": POSITION,
        }


def certificate(
    hysteresis: Everett, controllers: Mapping[str, Mapping[str, Any]] | None = None
) -> Certificate:
    """Certify a hysteresis, with velocity controllers by name and the numbers that are not their defaults.

    ``controllers``: the whole catalogue where it is None.

    >>> from smarig.preisach.gorbet_1997 import surface
    >>> found = certificate(surface("one_e"), {"constant_gain": {"gain": 4.0}})
    >>> found.passive, found.classes.M_P, found.controllers[0].stability.k_e
    (True, False, 2.0)
    """
    wanted = {name: {} for name in names(VELOCITY)} if controllers is None else controllers
    chosen = {name: given(VELOCITY, name, pairs) for name, pairs in wanted.items()}
    made = {name: find(VELOCITY, name)(**numbers) for name, numbers in chosen.items()}
    initial = initial_of(hysteresis)
    dissipativity, undecided = _dissipativity(hysteresis)
    stored = storage(hysteresis, Preisach(hysteresis, initial).state)
    of_model = ground(hysteresis, initial, stored)
    return Certificate(
        initial,
        classes(hysteresis),
        dissipativity,
        undecided,
        stored,
        _breaking(hysteresis, initial) if dissipativity and dissipativity.dissipative is False else None,
        tuple(Judged(name, chosen[name], stability_on(of_model, made[name])) for name in made),
    )


def initial_of(hysteresis: Everett) -> Initial:
    """The state at u(0) = 0: cold for a wire on one side of zero, B* for two."""
    return "negative" if hysteresis.lower >= 0 else "anhysteretic"


def _dissipativity(hysteresis: Everett) -> tuple[Dissipativity | None, str]:
    try:
        return certify(hysteresis), ""
    except UsageError as error:
        return None, str(error)


def _breaking(hysteresis: Everett, initial: Initial) -> Breaking | None:
    try:
        return breaking(hysteresis, initial)
    except UsageError:  # its loop is too small to repay the approach in as many cycles as are tried
        return None


def _of(judged: Judged) -> str:
    s = judged.stability
    reasons = "".join(f" {h.text}" for h in failing(s.hypotheses) if h.name.startswith("H₁"))
    return f"{judged.name}: δ = {s.delta:.4g}, γ = {s.gamma:.4g}, k_e = {s.k_e:.4g}.{reasons}"


def _plain(hypotheses: tuple[Hypothesis, ...]) -> list[dict[str, Any]]:
    return [asdict(h) for h in hypotheses]


def _word(holds: bool) -> str:
    return "yes" if holds else "no"
