"""What the page of first-order curves shows: data, drift correction, diagram and ridge, and how far to trust them."""

from dataclasses import dataclass, replace

import numpy as np

from smarig.core import DataError, spaced
from smarig.exchange import DriftDecision, drift_corrected
from smarig.identification import (
    SIGNIFICANT,
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
from smarig.report.components.numbers import number, thousands
from smarig.report.components.page_summary import Assessment
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


_CLEAR, _WEAK = 10.0, 5.0  # standard errors of the peak
_BY_CHANCE = 0.05


def forc_assessment(e: ForcEvidence) -> Assessment:
    """The assessment, built from the figures."""
    level = _level(e.diagram)
    return Assessment(level, Html(_measured(e)), escaped(_quality(e)), Html(_advice(e, level)))


def _level(d: ForcDiagram) -> str:
    if d.peak is None or d.significant_share <= _BY_CHANCE or d.peak.mu < _WEAK * d.peak.se:
        return "bad"
    return "good" if d.peak.mu >= _CLEAR * d.peak.se else "warning"


def _measured(e: ForcEvidence) -> str:
    kind = "first-order reversal curves" if e.magnetic else "first-order curves"
    words = f"Measured: {e.diagram.curves} {kind} with {thousands(e.diagram.points)} points. "
    peak, scale = e.diagram.peak, e.scale
    if peak is None:
        return words + "The density has no peak above the noise."
    place = (
        f"{scale.half_width} = {scale.text(peak.half_width)} and {scale.centre} = {scale.text(peak.centre)}"
    )
    widths = [
        f"{scale.text(width)} along {name}"
        for width, name in ((peak.fwhm_half_width, scale.half_width), (peak.fwhm_centre, scale.centre))
        if np.isfinite(width)
    ]
    shape = f", {' and '.join(widths)} wide at half maximum" if widths else ""
    return f"{words}The density peaks at {place}{shape}."


def _quality(e: ForcEvidence) -> str:
    d = e.diagram
    noise = f"The readings scatter by {number(d.estimate.noise, 2)}{spaced(display_unit(e.run.unit))}"
    span = float(np.ptp(e.data.y))
    if span > 0:
        noise += f" ({number(100 * d.estimate.noise / span, 2)} % of the range)"
    noise += " about the local polynomials"
    share = f"{100 * d.significant_share:.0f} % of the diagram differs from zero at 95 % (chance alone: 5 %)"
    if d.peak is None:
        return f"{noise}; {share}."
    return f"The peak stands {number(d.peak.mu / d.peak.se, 2)} standard errors above zero; {share}. {noise}."


def _advice(e: ForcEvidence, level: str) -> str:
    wider = number(1.6 * e.diagram.smoothing_factor, 2)
    if level == "bad":
        return (
            "Do not read this diagram: average longer, measure more curves, or compare a wider smoothing "
            f"(--smoothing {wider})."
        )
    smoothing = (
        f"The smoothing factor {number(e.diagram.smoothing_factor, 2)} predicts whole curves best; "
        if e.diagram.tried
        else f"The smoothing factor {number(e.diagram.smoothing_factor, 2)} was given; "
    )
    check = "read peak and widths as they are, and details only inside the thick line."
    if level == "warning":
        check = "read the peak only, and confirm it with more averaging."
    return f"{_ridge_words(e)}{smoothing}{check}"


def _ridge_words(e: ForcEvidence) -> str:
    ridge, scale = e.ridge, e.scale
    if ridge is None:
        return ""
    width, resolution = scale.text(ridge.fwhm), scale.text(ridge.resolution)
    if ridge.present:
        items = "particles" if e.magnetic else "relays"
        return (
            f"A central ridge lies at {scale.centre} = {scale.text(ridge.centre)}, {width} wide at a resolution of "
            f"{resolution}: {items} that do not interact. "
        )
    if ridge.fwhm > ridge.resolution and ridge.height > SIGNIFICANT * ridge.height_se:
        return (
            f"There is no central ridge: along {scale.centre} the density is {width} wide at a resolution of "
            f"{resolution}. "
        )
    return "There is no central ridge. "
