"""What a diagnosis compared: the causes with their probabilities, and the heaviest hypotheses."""

from collections.abc import Iterator

import numpy as np

from smarig.diagnosis import ComparedHypothesis, Part, Probabilities, Weights, variable_words
from smarig.report.components.figure import Figure, Panel, Trace, axis, packed
from smarig.report.components.html import Html, paragraph, table
from smarig.report.components.numbers import number
from smarig.report.components.style import FIRST, GREY, SECOND

_MOST_HYPOTHESES = 12  # that are listed
_SMALLEST = 0.01  # probability that is written as a number, and drawn
_COLOURS = {"nothing": GREY, "outside": GREY, "effect": FIRST, "variable": SECOND}


def compared_causes(weights: Weights, stated: Probabilities, label: str) -> Iterator[Html | Figure]:
    """The figure of the causes, their table, and that of the hypotheses; ``label`` marks simulated data."""
    causes = _causes(stated)
    likely = [c for c in causes if c[2] >= _SMALLEST]
    yield _figure(likely, label)
    yield table(
        ("Cause", "Probability"),
        [(name, _probability(p)) for _, name, p in likely],
        "The probability of each cause, summed over the hypotheses that hold it. Where the verdict withholds a name, a "
        "part of it is that of causes outside the catalogue.",
    )
    if unlikely := [name for _, name, p in causes if p < _SMALLEST]:
        yield paragraph(f"Causes below {_SMALLEST}: {', '.join(unlikely)}.")
    yield _hypotheses_table(weights)


def _causes(stated: Probabilities) -> list[tuple[str, str, float]]:
    """(kind, name, probability) of nothing, of what is outside, and of every cause, likeliest first."""
    causes = [("nothing", "nothing", stated.nothing), ("outside", "outside the catalogue", stated.outside)]
    causes += [(p.kind, _name(p), w) for p, w in stated.causes.items()]
    return sorted(causes, key=lambda cause: -cause[2])


def _name(part: Part) -> str:
    return part.name if part.kind == "effect" else f"depends on {variable_words(part.name)}"


def _figure(causes: list[tuple[str, str, float]], label: str) -> Figure:
    rows = np.arange(float(len(causes)))[::-1]
    bars: Trace = {
        "type": "bar",
        "orientation": "h",
        "x": packed(np.array([p for _, _, p in causes])),
        "y": packed(rows),
        "text": [f"{p:.2f}" for _, _, p in causes],
        "textposition": "outside",
        "cliponaxis": False,
        "marker": {"color": [_COLOURS[kind] for kind, _, _ in causes]},
        "width": 0.6,
        "hoverinfo": "text",
        "showlegend": False,
    }
    names = [name for _, name, _ in causes]
    layout = {
        "xaxis": axis("Probability", range=[0.0, 1.12]),
        "yaxis": axis("", tickvals=rows.tolist(), ticktext=names, range=[-0.7, len(names) - 0.3], ticks=""),
        "showlegend": False,
    }
    caption = [
        "Blue: an effect of the catalogue; vermilion: a smooth dependence on a variable, which names no cause; grey: "
        "the plain model, or a cause outside the catalogue. Causes of one hypothesis count for both, so the sum "
        "may exceed 1.",
    ]
    panel = Panel([bars], layout, 130 + 34 * len(names), wide=True)
    return Figure([panel], "What the model may lack.", caption, label)


def _hypotheses_table(weights: Weights) -> Html:
    plain = next(h for h in weights.hypotheses if not h.parts).score
    ranked = sorted(zip(weights.weight.tolist(), weights.hypotheses), key=lambda pair: -pair[0])
    rows = [
        (h.name, _probability(w), f"{h.score - plain:+.1f}".replace("-", "−"), _values(h))
        for w, h in ranked[:_MOST_HYPOTHESES]
    ]
    return table(
        ("Hypothesis", "Weight", "Log score (nats)", "Best values"),
        rows,
        f"The {len(rows)} heaviest of {len(ranked)} hypotheses. The log score is that of predicting blocks left out, "
        "above that of nothing.",
    )


def _probability(weight: float) -> str:
    return f"{weight:.2f}" if weight >= _SMALLEST else f"< {_SMALLEST}"


def _values(hypothesis: ComparedHypothesis) -> str:
    return ", ".join(f"{name} {number(v)}" for name, v in hypothesis.best.parameters.items())
