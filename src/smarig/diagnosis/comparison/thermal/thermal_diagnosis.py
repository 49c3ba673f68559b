"""The diagnosis of a thermal record: what a plain heat balance predicts wrongly on a measured temperature, and why.

The comparison of hypotheses finds what is wrong; the extended balance has the effects of the verdict.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from smarig.core import NotebookDisplay, UsageError
from smarig.diagnosis.comparison.compared_hypothesis import Part
from smarig.diagnosis.comparison.finding import Finding
from smarig.diagnosis.comparison.probabilities import Probabilities, probabilities
from smarig.diagnosis.comparison.thermal.balance_fit import PLAIN, FittedBalance
from smarig.diagnosis.comparison.thermal.thermal_comparison import ThermalComparison, compare_thermal
from smarig.diagnosis.comparison.thermal.thermal_effects import (
    EFFECTS,
    parameter_unit,
    testable_effects,
)
from smarig.diagnosis.comparison.thermal.thermal_json import thermal_json
from smarig.diagnosis.comparison.thermal.thermal_record import ThermalRecord, thermal_record_of
from smarig.diagnosis.comparison.thermal.thermal_text import thermal_lines
from smarig.diagnosis.comparison.verdict_rules import Verdict
from smarig.diagnosis.held_out_gain import HeldOutGain
from smarig.diagnosis.run_checks import check_left_out
from smarig.record import Run, load_run

NORMAL_95 = 1.96
TIME_CONSTANT = "wire_lag"  # τ itself, which the plain balance has


@dataclass(frozen=True, eq=False)
class ThermalDiagnosis(NotebookDisplay):
    """The verdict on a thermal record, with its evidence. Errors are in kelvin."""

    evidence: ThermalComparison
    run: Run
    seconds: float

    @property
    def verdict(self) -> Verdict:
        """The verdict of the comparison."""
        return self.evidence.verdict

    @property
    def probabilities(self) -> Probabilities:
        """The probabilities that the verdict states."""
        return probabilities(self.verdict, self.evidence.weights)

    @property
    def causes(self) -> Mapping[Part, float]:
        """The probability of each cause, likeliest first."""
        return self.probabilities.causes

    @property
    def record(self) -> ThermalRecord:
        """The record that was compared."""
        return self.evidence.problem.record

    @property
    def base(self) -> FittedBalance:
        """The plain balance."""
        return self.evidence.base.balance

    @property
    def extended(self) -> FittedBalance:
        """The balance with the effects that are named, else with the likeliest of those that compete; the plain one if
        there are none.
        """
        return self.evidence.extended.balance

    @property
    def noise(self) -> float:
        """What a reading scatters, kelvin."""
        return self.evidence.evidence.noise * self.record.span

    @cached_property
    def gain(self) -> HeldOutGain:
        """The errors of both balances on blocks left out, kelvin, each by the variance of its prediction: what no other
        block determines counts for little.
        """
        fits, span = (self.evidence.base, self.evidence.extended), self.record.span
        weight = 1 / (span**2 * self.evidence.extended.left_out_variance)
        base, extended = (f.fit.error * span for f in fits)
        gain = HeldOutGain(base, extended, self.evidence.problem.block, self.noise, weight)
        return replace(gain, floor=min(self.noise, gain.base, gain.extended))

    @property
    def not_testable(self) -> list[str]:
        """Effects that this record cannot show."""
        tested = [e.name for e in testable_effects(self.record)]
        return [*(e.name for e in EFFECTS if e.name not in tested), TIME_CONSTANT]

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Values with 95 % intervals of the extended balance; times in the unit of the record."""
        return {name: self._parameter(name) for name in (*PLAIN, *self.evidence.extended.candidate.values)}

    def _parameter(self, name: str) -> dict[str, Any]:
        value = getattr(self.extended.balance, name)
        if name in PLAIN:
            half = NORMAL_95 * self.evidence.extended.deviations[name]
            ends = [value - half, value + half]
        else:
            low, high = next(i[name] for i in self.evidence.intervals.values() if name in i)
            ends = [min(low, value), max(high, value)]
        return {"value": value, "ci95": ends, "unit": parameter_unit(name, self.record.unit)}

    @property
    def candidates(self) -> tuple[Finding, ...]:
        """The effects of the extended balance."""
        return tuple(
            Finding(
                name,
                self.causes[Part("effect", name)],
                {parameter: self._parameter(parameter) for parameter in values},
            )
            for name, values in self.evidence.extended.candidate.effects.items()
        )

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The effects of the verdict; none if it is unknown."""
        return self.candidates if self.verdict.word in ("named", "ambiguous") else ()

    def lines(self) -> list[str]:
        """The findings, one or two sentences each; the verdict first."""
        return list(thermal_lines(self))

    def text(self) -> str:
        """The findings as text."""
        return "\n".join(self.lines())

    def to_json(self) -> dict[str, Any]:
        """The JSON object of the command line."""
        return thermal_json(self)

    def __repr__(self) -> str:
        found = " + ".join(self.verdict.names) or self.verdict.depends_on or ""
        return f"ThermalDiagnosis({self.verdict.word}{': ' if found else ''}{found})"


@threadpool_limits.wrap(limits=1, user_api="blas")
def diagnose_transient(
    run: Run | str | Path,
    *,
    alpha: float = 0.03,
    nulls: int = 200,
    seed: int = 0,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> ThermalDiagnosis:
    """Diagnose the wire temperature of a run: which effect of heat or thermometer a plain heat balance lacks.

    The run needs a wire temperature and the drive that heated it (duty cycle, power, current). ``seed`` is that of the
    resampling of blocks. ``alpha`` and ``nulls`` have no effect: no null data are drawn. Raises DataError without
    temperature or drive, and UsageError for invalid settings.
    """
    del alpha, nulls
    started = time.monotonic()
    if seed < 0:
        raise UsageError(f"Seed {seed} is negative. Give a whole number ≥ 0.")
    check_left_out(without, [*(e.name for e in EFFECTS), TIME_CONSTANT])
    loaded = run if isinstance(run, Run) else load_run(run)
    evidence = compare_thermal(thermal_record_of(loaded), without, seed, progress or (lambda _: None))
    return ThermalDiagnosis(evidence, loaded, time.monotonic() - started)
