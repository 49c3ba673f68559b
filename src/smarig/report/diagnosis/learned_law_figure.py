"""The figure of a learned term: its value against its variable, in physical units."""

import numpy as np

from smarig.diagnosis import CommandedLaw, LearnedLaw
from smarig.measurement import LearnedTerm, variable_unit
from smarig.report.components.figure import Figure, Panel, axis, dots, line, log_axis
from smarig.report.components.run_description import display_unit, with_unit
from smarig.report.components.style import INK, MODEL

_KNOTS = [
    "Dots: the knots, between which the law is straight; beyond them it keeps its last value.",
    "The law is relative to its first knot, because the hysteresis contains the rest.",
]
_QUANTITIES = {
    "rate": "Mean rate of the branch",
    "time": "Time since the start of the run",
    "time_since_reversal": "Time since the last reversal",
    "cycle": "Cycles since the start of the run",
    "history": "Input at the last reversal",
    "input": "Input",
    "level": "Output of the hysteresis",
}
_COMMANDED = {  # variables of commanded runs
    "time": "Time since the start of the session",
    "cycle": "Cycles: motion in units of two strokes",
    "level": "Output of the hysteresis",
    "step": "Last step of the steady-state temperature",
    "hold": "Time since the last step",
    "rate": "exp(−time since the last step/10 s), negative in cooling steps",
    "history": "Steady-state temperature before the last step",
    "reversals": "Reversals since the start of the session",
    "power_over_2_min": "Steady-state temperature, mean of the last 2 min",
    "power_over_15_min": "Steady-state temperature, mean of the last 15 min",
    "level_over_2_min": "Output of the hysteresis, mean of the last 2 min",
    "level_over_15_min": "Output of the hysteresis, mean of the last 15 min",
}
_VALUES = {
    "output": "Added to the output",
    "output_gain": "Relative change of the output's gain",
    "input": "Added to the input",
    "input_gain": "Relative change of the input's gain",
    "heat_loss": "Relative change of the heating per heat loss",
    "play": "Half-width of the input's play",
}


def learned_law_figure(law: LearnedLaw, label: str) -> Figure:
    """A panel for each term; ``label`` marks simulated data."""
    caption = [
        *_KNOTS,
        "A negative half-width is a lead." if any(t.form == "play" for t in law.terms) else "",
    ]
    return Figure([_panel(law, term) for term in law.terms], "The learned term.", caption, label)


def commanded_law_figure(found: CommandedLaw, output_unit: str, label: str) -> Figure:
    """The law of commanded runs; ``label`` marks simulated data."""
    shape, (z, values) = found.shape, np.array(found.points).T
    title = with_unit(_COMMANDED[shape.variable], shape.variable_unit or output_unit)
    data = [line(z, values, "learned", MODEL), dots(z, values, "knots", INK)]
    x = log_axis(title, 0.9 * float(z[0]), 1.1 * float(z[-1])) if shape.variable == "hold" else axis(title)
    panel = Panel(data, {"xaxis": x, "yaxis": axis(with_unit(_VALUES[shape.enters], shape.unit))})
    return Figure([panel], "The learned term.", _KNOTS, label)


def _panel(law: LearnedLaw, term: LearnedTerm) -> Panel:
    z, values = np.array(term.knots), np.array(term.values)
    x = 10**z if term.variable == "rate" else z
    data = [line(x, values, "learned", MODEL), dots(x, values, "knots", INK)]
    return Panel(
        data,
        {
            "xaxis": _variable_axis(law, term, x),
            "yaxis": axis(with_unit(_VALUES[term.form], law.value_unit(term))),
        },
    )


def _variable_axis(law: LearnedLaw, term: LearnedTerm, x: np.ndarray) -> dict:
    unit = variable_unit(term.variable, display_unit(law.input_unit))
    unit = display_unit(law.output_unit) if term.variable == "level" else unit
    quantity = _QUANTITIES.get(term.variable, term.variable.capitalize())
    title = with_unit(quantity, unit)
    return log_axis(title, 0.9 * float(x[0]), 1.1 * float(x[-1])) if term.variable == "rate" else axis(title)
