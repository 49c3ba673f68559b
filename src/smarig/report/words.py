"""Numbers and names as a page prints them: few digits, units, conditions of a run. Knows no HTML."""

import math

import numpy as np
from numpy.typing import NDArray

from smarig.record import Run


def number(value: float | None, digits: int = 3) -> str:
    """A number with few significant digits and a true minus; '–' where there is none.

    >>> number(0.012345), number(-1.93e-4), number(None), number(12.5404)
    ('0.0123', '−1.93 × 10⁻⁴', '–', '12.5')
    """
    if value is None or not math.isfinite(value):
        return "–"
    if value != 0 and not 1e-3 <= abs(value) < 1e5:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return f"{mantissa} × 10{raised}".replace("-", "−")
    return f"{value:.{digits}g}".replace("-", "−")


def interval(ends: tuple[float, float] | None, digits: int = 4) -> str:
    """A 95 % interval."""
    return f"{number(ends[0], digits)} … {number(ends[1], digits)}" if ends else "–"


def duration(seconds: float) -> str:
    """Hours and minutes, or seconds when short.

    >>> duration(4100), duration(30)
    ('1 h 08 min', '30 s')
    """
    if seconds < 120:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes // 60} h {minutes % 60:02d} min" if minutes >= 60 else f"{minutes} min"


def input_axis(run: Run) -> str:
    """Name and unit of the hysteresis input."""
    given = run.meta.get("input", {})
    return f"{given.get('quantity', 'input')} ({given.get('unit') or '1'})"


def output_axis(run: Run) -> str:
    """Name and unit of position."""
    given = run.meta.get("output", {})
    return f"{given.get('quantity', 'output')} ({given.get('unit') or '1'})"


def conditions(run: Run) -> str:
    """One sentence for a caption: what was measured where, how often."""
    meta = run.meta
    where = f"{meta.get('protocol', 'run')} on {meta.get('rig') or meta.get('source', 'unknown rig')}"
    wire = f", wire {meta['wire']}" if meta.get("wire") else ""
    steps = f", {len(run.settled)} settled steps" if run.settled else ""
    return f"{where}{wire}: n = {len(run)} samples{steps}."


def thinned(x: NDArray[np.float64], y: NDArray[np.float64], most: int = 2600) -> tuple[NDArray, NDArray]:
    """At most about ``most`` points that keep every bin's first, lowest, highest and last: no peak is lost.

    >>> x, y = thinned(np.arange(100000.0), np.sin(np.arange(100000.0)))
    >>> x.size < 2700 and float(y.max()) > 0.9999
    True
    """
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if x.size <= most:
        return x, y
    kept = []
    for part in np.array_split(np.arange(x.size), most // 4):
        kept.append(np.unique([part[0], part[np.argmin(y[part])], part[np.argmax(y[part])], part[-1]]))
    index = np.concatenate(kept)
    return x[index], y[index]
