"""The certificate of a hysteresis before a loop is closed around it: its results, as text and as JSON.

It contains the classes (Def. 4.1), dissipativity, the storage and its bias from u(0) = 0 (Thm 8.1), Thm 8.2 for every
requested velocity controller, and its ``scope``. A number that no theorem gives is None.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

from smarig.certificate.certificate_scope import (
    CONTROL_FINDINGS,
    CertificateLimit,
    CertificateScope,
    k_e_units,
    limits,
    position_controllers,
    scheduling,
)
from smarig.certificate.certificate_units import Units, with_unit
from smarig.certificate.hypothesis import Hypothesis, coverage, failing
from smarig.certificate.integral_convergence import IntegralConvergence
from smarig.certificate.passivity import PassivityCounterexample
from smarig.certificate.position_assumptions import IndistinguishableStates
from smarig.certificate.storage_bound import StorageBound
from smarig.certificate.velocity.stability import Stability
from smarig.preisach import Initial
from smarig.theory import DissipativityCertificate as Dissipativity
from smarig.theory import MeasureClasses

_ROUNDING = 1e-9  # relative to the largest, as in the classes


@dataclass(frozen=True)
class ControllerResult:
    """One velocity controller: its numbers, and the result of Thm 8.2 for its loop."""

    name: str
    numbers: dict[str, float]
    stability: Stability

    @property
    def k_e(self) -> float | None:
        """The bound of Thm 8.2; None if it does not hold or is not decided."""
        return self.stability.k_e if self.stability.holds else None

    @property
    def coverage(self) -> str:
        """Whether Thm 8.2 covers the loop, and the hypotheses that prevent it."""
        return coverage(self.stability.hypotheses)

    @property
    def text(self) -> str:
        """One line: δ and γ with their unit, and k_e if it is proved."""
        s, unit = self.stability, self.stability.units.gain
        bound = f"k_e {self.coverage}" if self.k_e is None else f"k_e = {self.k_e:.4g}"
        return f"{self.name}: δ = {with_unit(s.delta, unit)}, γ = {with_unit(s.gamma, unit)}, {bound}."


@dataclass(frozen=True)
class ModelCertificate:
    """Certificate of one hysteresis from the state ``initial`` at u(0) = 0.

    ``dissipativity`` is None if it cannot be decided, with the reason in ``undecided``. ``counterexample`` is an input
    that extracts energy in every cycle, if there is one. ``indistinguishable``: two states that zero input never
    distinguishes, if u = 0 leaves more than one.
    """

    initial: Initial
    classes: MeasureClasses
    dissipativity: Dissipativity | None
    undecided: str
    storage_bound: StorageBound
    counterexample: PassivityCounterexample | None
    controllers: tuple[ControllerResult, ...]
    scope: CertificateScope
    integral: IntegralConvergence
    indistinguishable: IndistinguishableStates | None = None

    @property
    def units(self) -> Units:
        """Units of the hysteresis."""
        return self.scope.units

    @property
    def limits(self) -> tuple[CertificateLimit, ...]:
        """The limits of the certificate, shared by text, page and JSON."""
        return limits(self.scope)

    @property
    def has_hysteresis(self) -> bool:
        """Whether the measure has any mass off the diagonal; without, the output is a function of the input."""
        share = self.classes.reversible_share
        return not (self.classes.positive and (math.isnan(share) or abs(share - 1.0) <= _ROUNDING))

    @property
    def passive(self) -> bool | None:
        """Whether a theorem bounds the supplied energy from below; None if not decided."""
        if not self.has_hysteresis:
            return None
        if self.storage_bound.basis == "none":
            return False
        return True if self.storage_bound.proven else None

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """The hypotheses of Thm 8.1."""
        return self.storage_bound.hypotheses

    @property
    def verdict(self) -> str:
        """Whether the model is passive, and with which bias, in a sentence."""
        s = self.storage_bound
        bias = with_unit(s.energy, s.unit)
        if not self.has_hysteresis:
            return (
                "Not decided: this model has no hysteresis (μ = 0 everywhere), so nothing follows for a system that "
                "has some. Identify a model that follows its loops."
            )
        if s.basis == "none":
            return "Not passive: some input extracts more energy from this model than was supplied."
        if s.basis == "undecided":
            return "Not decided: no bound of the supplied energy is known for this model."
        basis = {
            "positive": "neither μ nor g is negative, Thm 8.1",
            "recoverable": "Q_r is proved a storage function, although μ or g is negative somewhere",
            "dissipative": "no loop gives energy back, although μ or g is negative somewhere",
        }[s.basis]
        if not s.proven:
            return f"Dissipative ({basis}); its bias is known only from below: at least {bias}."
        if s.energy == 0.0:
            return f"Passive without bias: from u(0) = 0 the supplied energy is never negative ({basis})."
        return f"Passive with a bias of {bias} from u(0) = 0 ({basis})."

    @property
    def scheduling(self) -> str:
        """What is certified of gain scheduling."""
        return scheduling(self.scope)

    @property
    def position_controllers(self) -> str:
        """What is certified of the position controllers of §9.2."""
        return position_controllers(self.scope)

    @property
    def failing_model_hypotheses(self) -> tuple[Hypothesis, ...]:
        """The hypotheses of Thm 8.2 about the model that fail, for every controller."""
        first = self.controllers[0].stability.hypotheses if self.controllers else ()
        return tuple(h for h in failing(first) if not h.name.startswith("H₁"))

    @property
    def text(self) -> str:
        """The certificate as text."""
        c = self.classes
        lines = [
            self.verdict,
            f"Classes of the density μ: M_PC {_yes_no(c.M_PC)}, M_P {_yes_no(c.M_P)}; reversible part g ≥ 0: "
            f"{_yes_no(self.g_not_negative)}.",
            *(
                f"For μ and g together, {h.text}"
                for h in self.hypotheses
                if h.name == "ν ≥ 0" and not h.holds
            ),
            self.dissipativity.text
            if self.dissipativity
            else f"Dissipativity is not decided. {self.undecided}",
            *([self.counterexample_text] if self.counterexample else []),
            self.velocity_text,
            *(f"  {result.text}" for result in self.controllers),
            self.scheduling,
            self.position_controllers,
            self.integral.text,
            *([self.indistinguishable.text] if self.indistinguishable else []),
            "Limits:",
            *(f"  {limit.text}" for limit in self.limits),
            f"  (see {CONTROL_FINDINGS})",
        ]
        return "\n".join(lines)

    @property
    def g_not_negative(self) -> bool:
        """g ≥ 0, which the theorems require and no class contains."""
        least, largest = self.classes.g_min.value, self.classes.g_max.value
        return not least < -_ROUNDING * max(abs(least), abs(largest))

    @property
    def velocity_text(self) -> str:
        """The result of Thm 8.2 for velocity feedback with this model, in a sentence or two."""
        if not self.failing_model_hypotheses:
            return "Velocity feedback without delay: ‖ė‖ ≤ k_e (‖ṙ‖ + ‖u_o‖) up to every T (Thm 8.2)."
        lacking = "does not cover it" if self.scope.covered is False else "is not known to cover it"
        return f"Velocity feedback: Thm 8.2 {lacking}. " + " ".join(
            h.text for h in self.failing_model_hypotheses
        )

    @property
    def counterexample_text(self) -> str:
        """The input that violates passivity, in a sentence."""
        if self.counterexample is None:
            return ""
        v = self.counterexample.violation
        _, low, high = v.turning_points.tolist()
        unit = self.units.input
        return (
            f"Drive the model from {with_unit(v.turning_points[0], unit)} to {with_unit(low, unit)}, then between "
            f"{high:.4g} and "
            f"{with_unit(low, unit)}: every cycle returns {with_unit(-v.per_cycle, self.storage_bound.unit)}. "
            "More energy is extracted than supplied after "
            f"{self.counterexample.cycles_below(0.0)} cycles."
        )

    def to_json(self) -> dict[str, Any]:
        """Plain values; infinite and undecided energies are None."""
        c, s = self.classes, self.storage_bound
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
            "storage": {"ground": s.basis, "proved": s.proven, "bias": s.energy, "unit": s.unit},
            "hypotheses": _as_dicts(self.hypotheses),
            "initial": self.initial,
            "controllers": [
                {"name": j.name, "numbers": j.numbers, "holds": j.stability.holds, "coverage": j.coverage}
                | {"delta": j.stability.delta, "gamma": j.stability.gamma, "k_e": j.k_e}
                | {"stored": j.stability.stored, "hypotheses": _as_dicts(j.stability.hypotheses)}
                for j in self.controllers
            ],
            "breaking": self.counterexample
            and {
                "way": self.counterexample.violation.turning_points.tolist(),
                "per_cycle": self.counterexample.violation.per_cycle,
                "cycles_until_negative": self.counterexample.cycles_below(0.0),
            },
            "gain_scheduling": self.scheduling,
            "position_controllers": self.position_controllers,
            "integral_action": self.integral.to_json(),
            "indistinguishable_states": self.indistinguishable and self.indistinguishable.to_json(),
            "limits": [asdict(limit) for limit in self.limits],
        }


def _as_dicts(hypotheses: tuple[Hypothesis, ...]) -> list[dict[str, Any]]:
    return [asdict(h) for h in hypotheses]


def _yes_no(holds: bool) -> str:
    return "yes" if holds else "no"
