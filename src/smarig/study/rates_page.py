"""The part of the page of many studies on temperatures that go with the rate: points, lines to rate zero, a table."""

from collections.abc import Iterator

import numpy as np

from smarig.report import (
    Figure,
    Html,
    Panel,
    axis,
    dots,
    error_bars,
    figure_name,
    interval_text,
    line,
    number,
    paragraph,
    style,
    tag,
    to_uncertainty,
    with_subscripts,
)
from smarig.report import table as html_table
from smarig.study.temperatures_over_rates import RateLine, RateTrend

_SYMBOLS = {"s": "circle", "p": "diamond", "f": "square"}  # start, peak, finish
_ROOM = 1.08  # of the largest rate: the width of the figure
_COLOURS = {"A": style.HEATING, "M": style.COOLING}


def rate_parts(trend: RateTrend) -> Iterator[Html | Figure]:
    """What the temperatures of files at several rates tell: a sentence, the figure and the table."""
    yield paragraph(tag("b", f"{', '.join(trend.files)}: "), with_subscripts(trend.cause()))
    yield rate_figure(trend)
    yield rate_table(trend)


def rate_figure(trend: RateTrend) -> Figure:
    """Each temperature against the rate, with its line to rate zero."""
    last = _ROOM * max(trend.rates)
    traces = []
    for name, fitted in trend.lines.items():
        own = [r for r in trend.readings if r.name == name]
        rate, value, half = (np.array([getattr(r, key) for r in own]) for key in ("rate", "value", "half"))
        colour = _COLOURS[name[0]]
        ends = np.array([0.0, last])
        traces.append(
            line(ends, fitted.at_zero + fitted.slope * ends, name, colour, width=1.1) | {"showlegend": False}
        )
        bars = error_bars(value, value - half, value + half, color=colour, thickness=1.2, width=4)
        drawn = dots(rate, value, with_subscripts(name), colour, symbol=_SYMBOLS[name[-1]], size=7)
        traces.append(drawn | {"error_y": bars})
    layout = {
        "xaxis": axis("Rate (K/min)", range=[0.0, last]),
        "yaxis": axis("Temperature (°C)"),
    }
    caption = [
        "Bars: 95 % intervals. Lines: the temperatures less what a lag adds, which is nothing at rate zero."
    ]
    return Figure([Panel(traces, layout, 420)], "Transformation temperatures against the rate.", caption, "")


def rate_table(trend: RateTrend) -> Html:
    """A row for each rate, the last with the temperatures at rate zero and their intervals."""
    heads = ("Rate (K/min)", *(tag("span", figure_name(name), " (°C)") for name in trend.lines))
    rows = [(number(rate), *(_mean_at(trend, name, rate) for name in trend.lines)) for rate in trend.rates]
    rows.append(
        (
            "0 (by the lines)",
            *(_at_zero(line, interval=trend.has_intervals) for line in trend.lines.values()),
        )
    )
    words = "with 95 % intervals" if trend.has_intervals else "a third rate would give their intervals"
    return html_table(
        heads, rows, f"Temperatures at each rate, and those of the specimen at rate zero, {words}."
    )


def _mean_at(trend: RateTrend, name: str, rate: float) -> str:
    """The mean of the readings nearest to a rate."""
    own = [
        r
        for r in trend.readings
        if r.name == name and min(trend.rates, key=lambda other: abs(other - r.rate)) == rate
    ]
    if not own:
        return "–"
    return to_uncertainty(float(np.mean([r.value for r in own])), float(np.mean([r.half for r in own])))


def _at_zero(fitted: RateLine, *, interval: bool) -> Html:
    value = tag("b", to_uncertainty(fitted.at_zero, fitted.half))
    ends = interval_text(fitted.at_zero - fitted.half, fitted.at_zero + fitted.half)
    return tag("span", value, tag("br"), ends) if interval else value
