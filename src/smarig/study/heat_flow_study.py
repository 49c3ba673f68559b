"""Curves of heat flow (DSC) in a study: they are rates, so no model is fitted; their peaks give temperatures."""

from collections.abc import Sequence

from smarig.core import UsageError
from smarig.exchange import dimension
from smarig.record import Run
from smarig.study import quantity_words as q
from smarig.study.heat_flow_header import heat_flow_header
from smarig.study.imported_runs import ImportedTable
from smarig.study.table_guess import TableGuess
from smarig.transformation import Calorimetry, calorimetry


def calorimetry_of(tables: Sequence[ImportedTable], guesses: Sequence[TableGuess]) -> Calorimetry | None:
    """What the curves of heat flow show; None for any other output.

    Raises UsageError for a heat flow that is not recorded over a temperature.
    """
    runs = [table.run for table in tables]
    if not all(is_heat_flow(run) for run in runs):
        return None
    if any(run.input_unit not in ("degC", "K") for run in runs):
        raise UsageError(
            f"{runs[0].name} records a heat flow, which is a rate, but no temperature: neither a model nor "
            "transformation temperatures follow from it. Name the temperature with --input NAME."
        )
    header = heat_flow_header(guesses[0].table)
    return calorimetry(runs, exothermic=header.exothermic, mass_mg=header.mass_mg)


def is_heat_flow(run: Run) -> bool:
    """Whether the output of a run is a heat flow, by its quantity or by its unit."""
    return run.has("position") and (
        run.info.output.quantity == q.HEAT_FLOW or dimension(run.unit) == "heat flow"
    )
