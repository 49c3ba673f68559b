"""How the transformation of a wire differs between two runs that have no steps in common, such as two days.

The outputs of such runs may not be subtracted, but the figures of their full branches may: transformation temperatures,
hysteresis width and stroke. A difference contains the noise of both; the choice of the tangents' readings is common to
both and cancels.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarig.core import UsageError, spaced
from smarig.record import Run
from smarig.report.components.numbers import number, signed
from smarig.report.components.run_description import display_unit
from smarig.transformation import RunFigures, run_figures

_SIMULTANEOUS = 2.64  # standard errors: 95 % for six figures together (Bonferroni)
_COMPARED = {
    "A_s": "A_s",
    "A_f": "A_f",
    "M_s": "M_s",
    "M_f": "M_f",
    "width": "the width",
    "stroke": "the stroke",
}


@dataclass(frozen=True)
class FigureChange:
    """One figure in both runs: ``before``, ``after``, and the interval of their difference.

    The intervals of all figures hold together in 95 % of cases, so two equal wires rarely differ in any.
    """

    name: str
    unit: str
    before: float
    after: float
    ci95: tuple[float, float]

    @property
    def significant(self) -> bool:
        """Whether zero is outside the interval."""
        return self.ci95[0] > 0 or self.ci95[1] < 0

    @property
    def text(self) -> str:
        """The figure as in "M_s 41.2 → 43.5 °C (+2.3, 95 % interval +1.9 to +2.7)"."""
        difference = self.after - self.before
        return (
            f"{_COMPARED[self.name]} {number(self.before, 4)} → {number(self.after, 4)}{spaced(self.unit)} "
            f"({signed(difference, 2)}, 95 % interval {signed(self.ci95[0], 2)} to {signed(self.ci95[1], 2)})"
        )


def temperature_change(first: Run, other: Run) -> list[FigureChange]:
    """The figures that both runs have; none unless both contain full loops over a temperature."""
    try:
        before, after = run_figures(first), run_figures(other)
    except UsageError:
        return []
    return [
        _change(name, before, after) for name in _COMPARED if name in before.means and name in after.means
    ]


def _change(name: str, before: RunFigures, after: RunFigures) -> FigureChange:
    difference = after.means[name].minus(before.means[name])
    error = float(np.std(difference.draws))
    # The noise of a stroke is small beside the common choice, and was found to be underestimated without it.
    if name == "stroke":
        error = float(np.hypot(np.std(before.means[name].draws), np.std(after.means[name].draws)))
    half = _SIMULTANEOUS * error
    return FigureChange(
        name,
        display_unit(before.unit_of(name)),
        before.means[name].value,
        after.means[name].value,
        (difference.value - half, difference.value + half),
    )


def change_sentences(changes: Sequence[FigureChange]) -> str:
    """Which figures have changed, and which have not."""
    moved = [change for change in changes if change.significant]
    if not moved:
        names = ", ".join(_COMPARED[change.name] for change in changes)
        return f"Their full branches agree within the 95 % intervals: {names}."
    kept = [_COMPARED[change.name] for change in changes if not change.significant]
    rest = f"; unchanged within the intervals: {', '.join(kept)}" if kept else ""
    return f"Their full branches differ: {'; '.join(change.text for change in moved)}{rest}."
