"""Powers that are heat flows: those of a file that states an exothermic direction."""

from collections.abc import Sequence
from dataclasses import replace

from smarig.exchange import FoundTable
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.heat_flow_header import heat_flow_header


def with_heat_flows(table: FoundTable, columns: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The columns; a power beside a temperature is a heat flow where the file says which way is exothermic."""
    powers = [c for c in columns if c.quantity == q.POWER and not c.by_numbers]
    warm = any(c.quantity == q.TEMPERATURE for c in columns)
    known = any(c.quantity == q.HEAT_FLOW for c in columns)
    if not powers or not warm or known or not heat_flow_header(table).exothermic:
        return list(columns)
    reason = f"{powers[0].quantity_reason}, and the file states an exothermic direction"
    flow = replace(powers[0], quantity=q.HEAT_FLOW, quantity_reason=reason)
    return [flow if c is powers[0] else c for c in columns]
