"""What first-order curves show, how far the diagram can be trusted, and what to do: three sentences and a level."""

import numpy as np

from smarig.core import spaced
from smarig.identification import SIGNIFICANT, ForcDiagram
from smarig.report.components.assessment_box import Assessment
from smarig.report.components.html import Html, escaped
from smarig.report.components.numbers import number, thousands
from smarig.report.components.run_description import display_unit
from smarig.report.forc.forc_evidence import ForcEvidence

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
