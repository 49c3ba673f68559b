"""What the page of first-order curves shows: data, drift correction, diagram, central ridge and other smoothings."""

from dataclasses import dataclass, replace

import numpy as np

from smarig.core import DataError, spaced
from smarig.exchange import DriftDecision, drift_corrected
from smarig.identification import (
    CentralRidge,
    FodData,
    ForcDiagram,
    central_ridge,
    check_factor,
    fod_data,
    forc_diagram,
)
from smarig.record import FORC_PROTOCOL, Run
from smarig.report.components.html import Html, escaped, joined
from smarig.report.components.numbers import number
from smarig.report.components.run_description import display_unit

_OTHER_FACTORS = (0.6, 1.6)  # of the smoothing used
_FIELD_UNITS = {("T", True): (1e3, "mT"), ("A/m", True): (1e-3, "kA/m")}
_LEAST_FACTOR, _LEAST_POINTS = 1.2, 3.0


@dataclass(frozen=True)
class InputScale:
    """How the input is shown: ``factor`` × value in ``unit``, with the names of half width, centre and density."""

    factor: float
    unit: str
    half_width: Html
    centre: Html
    density: str

    def labelled(self, name: str) -> Html:
        """A quantity with the unit, for an axis."""
        words = name[:1].upper() + name[1:] if name[:1].isascii() else name  # μ, a sign, has no capital
        return joined([Html(words), f" ({self.unit})" if self.unit else ""])

    def text(self, value: float, digits: int = 3) -> Html:
        """A value of the input with its unit."""
        return escaped(f"{number(value * self.factor, digits)}{spaced(self.unit)}")


@dataclass(frozen=True, eq=False)
class ForcEvidence:
    """One run with its first-order ``data`` (drift-corrected if that helps), ``diagram`` and what belongs to it.

    ``others``: diagrams of narrower and wider smoothing. ``drift`` is None without calibration points.
    """

    run: Run
    data: FodData
    diagram: ForcDiagram
    ridge: CentralRidge | None
    others: tuple[ForcDiagram, ...]
    drift: DriftDecision | None

    @property
    def magnetic(self) -> bool:
        """Whether the run holds reversal curves of a magnetometer."""
        return self.run.info.protocol == FORC_PROTOCOL

    @property
    def scale(self) -> InputScale:
        """Unit and names of the input axes."""
        unit = self.run.input_unit
        if not self.magnetic:
            return InputScale(
                1.0, display_unit(unit), Html("half width (α − β)/2"), Html("centre (α + β)/2"), "μ"
            )
        largest = float(np.max(np.abs(self.data.alpha)))
        factor, shown = _FIELD_UNITS.get((unit, largest < 1.0 or unit != "T"), (1.0, display_unit(unit)))
        induction = "μ₀" if unit == "T" else ""
        return InputScale(
            factor, shown, Html(f"{induction}H<sub>c</sub>"), Html(f"{induction}H<sub>u</sub>"), "ρ"
        )


def forc_evidence(run: Run, factor: float | None = None) -> ForcEvidence:
    """Evidence of a run with first-order curves; ``factor`` is the smoothing factor SF, chosen if None.

    Raises DataError for a run without first-order curves, UsageError for an impossible factor.
    """
    check_factor(factor)
    data, drift = _corrected(run, fod_data(run))
    diagram = forc_diagram(data, factor=factor)
    used = max(diagram.smoothing_factor, _LEAST_FACTOR)
    others = []
    for share in _OTHER_FACTORS:
        other = share * used
        if other >= _LEAST_FACTOR and (2 * other + 1) ** 2 * _LEAST_POINTS <= len(data):
            others.append(forc_diagram(data, factor=other))
    return ForcEvidence(run, data, diagram, central_ridge(data, diagram), tuple(others), drift)


def _corrected(run: Run, data: FodData) -> tuple[FodData, DriftDecision | None]:
    """The data with moments corrected for drift, if calibration points show that this helps."""
    if run.info.protocol != FORC_PROTOCOL:
        return data, None
    try:
        moments, decision = drift_corrected(run)
    except DataError:  # too few curves or calibration points: the import says so
        return data, None
    if decision.kind == "none":
        return data, decision
    known = np.isfinite(run["input"]) & np.isfinite(run["position"])
    outputs = moments[known][data.point]
    return replace(data, y=-outputs if data.mirrored else outputs), decision
