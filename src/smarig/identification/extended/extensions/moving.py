"""The moving model y = Γ[u + k y]: feedback of the output on the input, from minor loops after several histories."""

from smarig.identification.extended.fitted_extension import ExtensionData, FittedExtension
from smarig.identification.extended.moving_fit import identify_moving
from smarig.preisach import dump_hysteresis


def moving(data: ExtensionData) -> FittedExtension:
    """The feedback k of the output on the input."""
    fit = identify_moving(data.runs)
    kept = {
        "kind": "moving",
        "feedback": fit.feedback.value,
        "hysteresis": dump_hysteresis(fit.hysteresis),
    }
    return FittedExtension("feedback k of the output on the input", {"k": fit.feedback}, fit.p_value, kept)
