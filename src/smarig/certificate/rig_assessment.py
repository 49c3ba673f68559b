"""Thm 8.2 for a loop on a rig: hypotheses about model and controller, and those that a rig satisfies or violates."""

from dataclasses import asdict, dataclass
from typing import Any

from smarig.certificate.certificate_scope import k_e_units
from smarig.certificate.certificate_units import with_unit
from smarig.certificate.hypothesis import Hypothesis
from smarig.certificate.model_certificate import ControllerResult
from smarig.protocols import Setup


@dataclass(frozen=True)
class RigAssessment:
    """What is proved about one velocity controller with one model, and the effect of a rig with a velocity filter."""

    result: ControllerResult
    setup: Setup
    filter_s: float

    def hypotheses(self, clipped_share: float | None) -> tuple[Hypothesis, ...]:
        """Those of Thm 8.2, then those of the rig. ``clipped_share``: of the samples, None before it is measured."""
        return (*self.result.stability.hypotheses, *self._rig_hypotheses(clipped_share))

    def to_json(self, clipped_share: float | None = None) -> dict[str, Any]:
        """Plain values for a mark in the record; k_e is None if Thm 8.2 does not cover model and controller."""
        units = self.result.stability.units
        return {
            "k_e": self.result.k_e,
            "coverage": self.result.coverage,
            "units": {"gain": units.gain, "k_e": k_e_units(units)},
            "hypotheses": [asdict(h) for h in self.hypotheses(clipped_share)],
        }

    def _rig_hypotheses(self, clipped_share: float | None) -> tuple[Hypothesis, ...]:
        setup, stability = self.setup, self.result.stability
        delta = with_unit(stability.delta, stability.units.gain)
        return (
            self._supply_rate(),
            _input_as_commanded(setup, clipped_share),
            Hypothesis(
                "no delay",
                False,
                f"a tick of {setup.period_s:g} s passes between velocity and current. At the highest frequency it "
                f"turns H₁ into −H₁, so its δ is at most −{delta}",
            ),
            Hypothesis(
                "exact velocity",
                False,
                f"it is computed from differences of counts ({setup.actuator.unit} per tick) through a filter of "
                f"{self.filter_s:g} s. Their noise does not depend on the reference, so the ratio grows when ṙ and u_o "
                "are small",
            ),
        )

    def _supply_rate(self) -> Hypothesis:
        """Passivity from the steady temperature of the commanded current; it needs Assumption 2.1 of the model."""
        follows = next(h for h in self.result.stability.hypotheses if h.name == "output follows input")
        lag = f"a current sets the steady temperature, not the present one (τ = {self.setup.tau_s:.3g} s)"
        if follows.holds:
            why = "but wire and output move towards it, which only adds to the supplied energy"
        else:
            why = "and the output of this model may move against the wire"
        return Hypothesis("supply rate at the current", follows.holds, f"{lag}, {why}")


def _input_as_commanded(setup: Setup, clipped_share: float | None) -> Hypothesis:
    low, high = setup.lower_K, setup.upper_K
    one_sided = ", cooling no faster than the wire cools by itself" if low >= 0 else ""
    limits = f"the limits ({low:.4g} … {high:.4g} K{one_sided})"
    if clipped_share is None:
        return Hypothesis("input as commanded", None, f"{limits} may change it, which is not measured yet")
    if clipped_share == 0:
        return Hypothesis("input as commanded", True, f"{limits} changed it in no sample")
    return Hypothesis(
        "input as commanded",
        False,
        f"{limits} changed it in {100 * clipped_share:.1f} % of the samples. Passivity still "
        "holds, but the reference may be unreachable",
    )
