"""What a reader should know of the columns of a study: how their roles were decided, and what is not used."""

from collections.abc import Iterator

from smarig.core import capitalised, shown
from smarig.study.physical_roles import leads
from smarig.study.pulled_wires import is_pulled, load_as_input
from smarig.study.table_guess import TableGuess
from smarig.study.understanding import Understanding

_EXCHANGED = "If input and output are exchanged, name them with --input and --output."
NO_TIME = (
    "No time is recorded: a lag is given in rows, creep and rates cannot be tested. If the rows are equally spaced, "
    "give their period: period_s under [time] in mapping.toml, with --map."
)


def column_hints(understood: Understanding, *, of_mapping: bool) -> Iterator[str]:
    """A sentence each; ``of_mapping``: a mapping of the user says what the columns mean."""
    lead = understood.guesses[0]
    if lead.by_loop:
        yield f"{capitalised(lead.by_loop)}. {_EXCHANGED}"
    if understood.joined:
        yield understood.joined
    if not of_mapping:
        yield from _pulled(lead)
    yield from list(_elsewhere(lead))[:1]  # the others are in the table of the columns


def _pulled(lead: TableGuess) -> Iterator[str]:
    """Why the load of a pulled wire is the input, though the elongation may have been set."""
    drive, out = (lead.first(role) for role in ("input", "output"))
    if drive is None or out is None or not is_pulled(drive, out):
        return
    if leads(drive.facts.values, out.facts.values):
        yield f"{capitalised(load_as_input(drive, out))}."


def _elsewhere(lead: TableGuess) -> Iterator[str]:
    """How thermometers differ that are no witnesses of the input."""
    for c in lead.of_role("elsewhere"):
        if c.name not in lead.branches.values():
            yield f"{shown(c.name)} is not used: {lead.roles[c.name].reason}."
