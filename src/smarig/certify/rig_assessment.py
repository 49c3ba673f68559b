"""Thm 8.2 asked of a loop on a rig: its hypotheses for model and controller, and those that a rig keeps or breaks."""

from dataclasses import asdict, dataclass
from typing import Any

from smarig.certify.certificate_scope import k_e_units
from smarig.certify.certificate_units import with_unit
from smarig.certify.hypothesis import Hypothesis
from smarig.certify.model_certificate import ControllerResult
from smarig.protocols import Setup


@dataclass(frozen=True)
class RigAssessment:
    """What is proved of one velocity controller with one model, and what a rig with a velocity filter makes of it."""

    result: ControllerResult
    setup: Setup
    filter_s: float

    def hypotheses(self, clipped_share: float | None) -> tuple[Hypothesis, ...]:
        """Of Thm 8.2, then what the rig adds; ``clipped_share``: of the samples, None before it is measured."""
        return (*self.result.stability.hypotheses, *self._rig_hypotheses(clipped_share))

    def to_json(self, clipped_share: float | None = None) -> dict[str, Any]:
        """For a mark in the record, plain values; k_e is None where Thm 8.2 does not cover model and controller."""
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
                f"a tick of {setup.period_s:g} s passes between velocity and current: at the highest frequency it "
                f"turns H₁ into −H₁, so its δ is at most −{delta}",
            ),
            Hypothesis(
                "velocity as it is",
                False,
                f"it comes from differences of counts ({setup.actuator.unit} per tick) through a filter of "
                f"{self.filter_s:g} s, with noise that no reference drives: the ratio grows when ṙ and u_o are small",
            ),
        )

    def _supply_rate(self) -> Hypothesis:
        """Passivity from the temperature that the current asks for: it needs Assumption 2.1 of the model."""
        follows = next(h for h in self.result.stability.hypotheses if h.name == "output follows input")
        lag = f"a current sets where the wire would settle, not where it is (τ = {self.setup.tau_s:.3g} s)"
        if follows.holds:
            why = "but the wire moves towards it and the output with the wire, which only adds to the supplied energy"
        else:
            why = "and the output of this model need not move with the wire"
        return Hypothesis("supply rate at the current", follows.holds, f"{lag}, {why}")


def _input_as_commanded(setup: Setup, clipped_share: float | None) -> Hypothesis:
    low, high = setup.lower_K, setup.upper_K
    one_sided = ", cooling no faster than the wire cools by itself" if low >= 0 else ""
    limits = f"the limits ({low:.4g} … {high:.4g} K{one_sided})"
    if clipped_share is None:
        return Hypothesis("input as asked for", None, f"{limits} may give another, which is not measured yet")
    if clipped_share == 0:
        return Hypothesis("input as asked for", True, f"{limits} gave no other in any sample")
    return Hypothesis(
        "input as asked for",
        False,
        f"{limits} gave another in {clipped_share:.1%} of the samples; passivity survives that, the reference may be "
        "out of reach",
    )
