"""Powers that are heat flows: those that turn negative, and those of a file that states an exothermic direction."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from smarig.exchange import FoundTable
from smarig.study import quantity_words as q
from smarig.study.column_guess import ColumnGuess
from smarig.study.heat_flow_header import heat_flow_header

_OUTERMOST = 0.02  # of the readings, which noise may turn negative


def with_heat_flows(table: FoundTable, columns: Sequence[ColumnGuess]) -> list[ColumnGuess]:
    """The columns; a power beside a temperature is a heat flow where it turns negative, as no power that heats does, or
    where the file says which way is exothermic.
    """
    powers = [c for c in columns if c.quantity == q.POWER and not c.by_numbers and c.facts.known.size]
    warm = any(c.quantity == q.TEMPERATURE for c in columns)
    if not powers or not warm or any(c.quantity == q.HEAT_FLOW for c in columns):
        return list(columns)
    if heat_flow_header(table).exothermic:
        flow, why = powers[0], "the file states an exothermic direction"
    else:
        negative = [c for c in powers if np.quantile(c.facts.known, _OUTERMOST) < 0]
        flow, why = next(iter(negative), None), "it turns negative, as no power that heats does"
    return [
        replace(c, quantity=q.HEAT_FLOW, quantity_reason=f"{c.quantity_reason}, and {why}")
        if c is flow
        else c
        for c in columns
    ]
