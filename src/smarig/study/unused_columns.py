"""Why a column is not used, in words."""

from smarig.core import shown
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.held_quantities import is_noise


def reason_unused(c: ColumnGuess, out: ColumnGuess | None) -> str:
    """Why a column beside the output is not used."""
    if c.quantity in q.NO_SIGNALS[1:]:
        return f"{c.quantity}: {c.quantity_reason}"
    if c.quantity == q.TIME and c.facts.levels > 1:
        return "another time" if c.facts.rising else "a time that runs backwards, so it is no clock"
    known = "" if c.by_numbers else c.quantity
    if out is not None and known == out.quantity != "" and not is_noise(c):
        return f"another {c.quantity} than the output {shown(out.name)}"
    if c.commanded and c.quantity == q.TEMPERATURE:
        return "a set-point: it was not measured"
    if c.facts.constant:
        return _small_range(c)
    if is_noise(c):
        return "it differs from row to row, as noise does"
    return f"{known}, not needed" if known else "its meaning is not clear, and it is not needed"


def _small_range(c: ColumnGuess) -> str:
    """That a column varies by little of its value, with its range if four digits show one."""
    low, high = f"{c.facts.low:.4g}", f"{c.facts.high:.4g}"
    return f"constant at {low}" if low == high else f"varies by little of its value, from {low} to {high}"
